"""Reliefs that nature repeats, as starting points: cheap to try, and rarely met by samples that only cover the space."""

from __future__ import annotations

import itertools
import math
from dataclasses import replace

import numpy as np

from voldetail.fit.candidates import Candidate
from voldetail.fit.space import Kind, Space

RISING = {"shape.0": 1.2}
"""Steep low and flat high: broad tops between narrow gaps."""

FALLING = {"shape.0": -1.2}
"""Flat low and steep high: lone bumps on flat ground."""

STEEP = {"shape.1": -1.0}
"""Steep in the middle: two levels."""

ARCHETYPES: tuple[tuple[str, Kind, dict[str, float]], ...] = (
    (
        "stones",
        Kind(1, 50, "exponential", 1, False, pigment=True, stones=True),
        {
            "noise.facets": 1.0,
            "noise.elongation": 1.8,
            "noise.size_spread": 0.4,
            "reflectance.cell_albedo": 0.2,
            "reflectance.height_albedo": 0.2,
        },
    ),
    (
        "rough stones",
        Kind(1, 50, "gaussian", 2, False, pigment=True, stones=True),
        RISING
        | {
            "noise.facets": 0.8,
            "noise.elongation": 2.0,
            "noise.size_spread": 0.5,
            "noise.lacunarity": 3.5,
            "stone_gain": 0.2,
            "reflectance.cell_albedo": 0.2,
            "reflectance.height_albedo": 0.2,
        },
    ),
    (
        "lumps",
        Kind(1, 50, "gaussian", 2, False, stones=True),
        {"noise.facets": 0.2, "noise.elongation": 1.5, "noise.size_spread": 0.6, "noise.lacunarity": 3.0, "stone_gain": 0.3},
    ),
    (
        "pebbles",
        Kind(1, 2, "gaussian", 1, False, bordered=True, pigment=True),
        RISING | {"reflectance.cell_albedo": 0.25, "reflectance.height_albedo": 0.3},
    ),
    (
        "gravel",
        Kind(1, 2, "exponential", 2, True, bordered=True, pigment=True),
        RISING
        | {
            "noise.stripe_frequency": 0.3,
            "noise.stripe_spread": math.pi,
            "noise.lacunarity": 3.0,
            "reflectance.cell_albedo": 0.25,
            "reflectance.height_albedo": 0.3,
        },
    ),
    ("bare pebbles", Kind(1, 2, "gaussian", 2, False, bordered=True), RISING | {"noise.lacunarity": 2.5}),
    (
        "mud plates",
        Kind(1, 2, "gaussian", 2, False, bordered=True, pigment=True, plates=True),
        RISING
        | {
            "noise.cell_height": 2.0,
            "noise.cell_tilt": 2.0,
            "noise.bevel": 0.1,
            "noise.lacunarity": 3.0,
            "plate_gain": 0.4,
            "reflectance.cell_albedo": 0.1,
            "plate_dust": 0.1,
        },
    ),
    (
        "slate",
        Kind(1, 2, "gaussian", 2, False, bordered=True, plates=True),
        FALLING
        | {"noise.cell_height": 3.0, "noise.cell_tilt": 2.0, "noise.bevel": 0.06, "noise.lacunarity": 2.5, "plate_gain": 0.4},
    ),
    (
        "bark plates",
        Kind(1, 2, "gaussian", 3, False, bordered=True, pigment=True, plates=True),
        {
            "noise.cell_height": 2.0,
            "noise.cell_tilt": 2.0,
            "noise.bevel": 0.25,
            "noise.lacunarity": 2.0,
            "plate_gain": 0.6,
            "plate_dust": 0.1,
        },
    ),
    (
        "facets",
        Kind(1, 2, "gaussian", 2, False, bordered=True, pigment=True, plates=True),
        {
            "noise.cell_height": 1.0,
            "noise.cell_tilt": 4.0,
            "noise.bevel": 0.3,
            "noise.lacunarity": 2.5,
            "plate_gain": 0.3,
            "reflectance.cell_albedo": 0.25,
        },
    ),
    ("roughcast", Kind(1, 50, "gaussian", 2, False), FALLING | {"noise.lacunarity": 2.2}),
    ("plaster", Kind(1, 50, "gaussian", 3, False), {"noise.lacunarity": 2.0}),
    ("pits", Kind(1, 50, "gaussian", 2, False), RISING | {"noise.lacunarity": 2.5}),
    ("bumps", Kind(1, 2, "exponential", 2, False), FALLING | {"noise.lacunarity": 2.0}),
    ("crust", Kind(2, 2, "exponential", 3, False), STEEP | {"noise.lacunarity": 2.0}),
    ("bark", Kind(2, 3, "gaussian", 3, False, pigment=True), STEEP | {"noise.lacunarity": 2.5, "reflectance.height_albedo": 0.3}),
    ("ripples", Kind(1, 50, "gaussian", 1, True), {"noise.stripe_frequency": 1.0, "noise.stripe_spread": 0.4}),
    (
        "fibres",
        Kind(1, 50, "gaussian", 2, True),
        {"noise.stripe_frequency": 1.0, "noise.stripe_spread": math.pi, "noise.lacunarity": 2.0},
    ),
    ("creases", Kind(1, 50, "gaussian", 3, False, fold="ridge"), {"noise.lacunarity": 2.0}),
)
"""Name, kind and numbers of each archetype; scale, roughness and stretch are varied over them."""

CLOUDS: tuple[tuple[str, Kind, dict[str, float]], ...] = (
    (
        "cumulus",
        Kind(1, 50, "gaussian", 4, False),
        {"noise.lacunarity": 2.2, "softness": 0.8, "depth": 20.0, "medium.exponent": 1.5, "medium.asymmetry": 0.6},
    ),
    (
        "heaps",
        Kind(1, 2, "gaussian", 4, False),
        FALLING | {"noise.lacunarity": 2.2, "softness": 0.8, "depth": 20.0, "medium.exponent": 1.0, "medium.asymmetry": 0.6},
    ),
    (
        "broken heaps",
        Kind(1, 50, "gaussian", 4, False),
        FALLING | {"noise.lacunarity": 2.2, "softness": 1.5, "depth": 20.0, "medium.exponent": 6.0, "medium.asymmetry": 0.6},
    ),
    (
        "tufts",
        Kind(1, 2, "exponential", 2, False),
        {"noise.lacunarity": 2.5, "softness": 1.0, "depth": 10.0, "medium.exponent": 5.0, "medium.asymmetry": 0.5},
    ),
    (
        "veil",
        Kind(1, 50, "gaussian", 4, False),
        {"noise.lacunarity": 2.0, "softness": 3.0, "depth": 2.0, "medium.exponent": 4.0, "medium.asymmetry": 0.7},
    ),
    (
        "fibres",
        Kind(1, 50, "gaussian", 2, True),
        {
            "noise.stripe_frequency": 1.0,
            "noise.stripe_spread": 0.5,
            "noise.lacunarity": 2.0,
            "softness": 2.0,
            "depth": 3.0,
            "medium.exponent": 4.0,
            "medium.asymmetry": 0.7,
        },
    ),
    (
        "smoke",
        Kind(1, 50, "gaussian", 4, False, fold="ridge"),
        {"noise.lacunarity": 2.0, "softness": 2.0, "depth": 4.0, "medium.exponent": 4.0, "medium.asymmetry": 0.3},
    ),
)
"""The same for a medium."""

SCALES = 5
ROUGHNESS = (0.25, 0.6)
MEDIUM_ROUGHNESS = (0.7, 1.7)


def archetypes_of(space: Space) -> tuple[tuple[str, Kind, dict[str, float]], ...]:
    """Return the archetypes that can be searched in ``space``."""
    return CLOUDS if space.medium else ARCHETYPES


def archetypes(space: Space, anisotropy: tuple[float, float]) -> list[Candidate]:
    """Return every archetype at several scales and two roughnesses, stretched as the photo's spectrum is.

    Scales run evenly, on a logarithmic scale, over the middle of what the picture can show.
    """
    low, high = np.log(space.scale[0]), np.log(space.scale[1])
    factor, angle = anisotropy
    out = []
    roughness = MEDIUM_ROUGHNESS if space.medium else ROUGHNESS
    for (_, kind, numbers), step, rough in itertools.product(archetypes_of(space), range(SCALES), roughness):
        if not space.pigmented:
            kind = replace(kind, pigment=False)
        scale = float(np.exp(low + (high - low) * (0.3 + 0.6 * step / (SCALES - 1))))
        # The light alone makes relief look stretched; half of the spectrum's stretch is taken for the relief's own.
        values = {
            "noise.scale": scale,
            "roughness": rough,
            "noise.gain": 1.0,
            "noise.anisotropy": factor**-0.5,
            "noise.angle": angle,
            "stone_height": 0.4 + rough,
            "stone_stretch": 1.0,
            "reflectance.speckle": 0.2,
            "reflectance.speckle_scale": space.finest,
            "shape.0": 0.0,
            "shape.1": 0.0,
            "shape.2": 0.0,
        } | numbers
        out.append(Candidate(kind, space.encode(kind, values)))
    return out
