"""What is searched how far, and what families have to pay for themselves.

A parameter's own range stands with its declaration; here are the numbers that are no parameters, or have a range of their own
where stones or plates are searched."""

from __future__ import annotations

SHAPE_RANGE = 1.5
"""Range of the numbers that shape H: exp(2 x 1.5) = 20 between its steepest and flattest part by each, at most."""

FINEST_SPECKS = 2.0
"""How much coarser than the finest octave specks may be: larger ones are seen as scales."""

STONE_HEIGHT = (0.4, 1.2)
"""Range of the amplitude in cells where stones are searched: they are about as high as wide, never a flat mosaic."""

STONE_STRETCH = (0.6, 1.67)
"""Range of the anisotropy where stones are searched: they lie every way, and what the light stretches is not theirs."""

STONE_GAIN = (0.05, 0.4)
"""Range of the octaves' gain where stones are searched; rougher stones lose their outlines and look like cauliflower."""

PLATE_GAIN = (0.05, 0.6)
PLATE_DUST = (-0.1, 0.15)
"""Ranges where plates are searched: finer octaves are their roughness and no second set of cracks, and it is shadow, not
paint, that darkens cracks. Tuned on gravel, which came out as a flat mosaic with painted lines."""

ROUGHNESS = (0.05, 0.7)
SOLID_ROUGHNESS = (0.05, 1.2)
"""Range of the amplitude in cells, of displacement and of solid volumes: what overhangs may rise higher."""

MEDIUM_ROUGHNESS = (0.3, 3.0)
SOFTNESS = (0.5, 2.5)
DEPTH = (1.0, 25.0)
"""Ranges of a medium: its amplitude in cells, its shell's thickness and the optical depth in amplitudes. Harder and
denser ones look like balls of plaster, and were found on a photo of clouds."""

OCTAVES, MEDIUM_OCTAVES = (1, 3), (2, 5)
"""Fewest and most; clouds are ragged at every size."""

FOLD_PENALTY = 1.2
STRIPED_CELLS_PENALTY = 1.15
STONES_PENALTY = 0.95
PIGMENT_PENALTY = 1.05
BORDERED_PENALTY = 1.1
PLATES_PENALTY = 1.1
"""Factors on the distance by how often a family looks like nature where it scores like nature. A folded H, and stripes
within single cells, fit much and look like little; so do cells that fit together like paving (on rock with plants they were
five percent nearer than crusts, and looked like cobbles), plates among them; stones look right where they are only almost
as near; more numbers for pigment or plates fit a few percent by themselves. Tuned by eye on gravel, roughcast, bark, sand
and rock."""

OF_STONES = {
    "roughness": "stone_height",
    "noise.anisotropy": "stone_stretch",
    "noise.gain": "stone_gain",
    "shape.0": "stone_profile",
}
OF_PLATES = {"noise.gain": "plate_gain", "reflectance.height_albedo": "plate_dust"}
"""Numbers that have a range of their own where stones or plates are searched, and the names that this range goes by."""

PLAIN_NAME = {own: name for names in (OF_STONES, OF_PLATES) for name, own in names.items()}

LOGARITHMIC = (
    "softness",
    "depth",
    "medium.exponent",
    "roughness",
    "stone_height",
    "stone_gain",
    "plate_gain",
    "stone_stretch",
    "noise.stripe_frequency",
)
"""Numbers searched on a logarithmic scale though they are no parameter of a detail, or one that is declared linear."""
