"""The reliefs of the library: relief k is the same whoever asks for it, and whenever.

Half of the reliefs are those that nature repeats (fit.archetypes), moved about at random; the other half covers the families
evenly. All are seen through one window, and numbers that are lengths are given in its own unit, see `seen_through`.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from voldetail.detail import Detail
from voldetail.fit.archetypes import archetypes
from voldetail.fit.candidates import Candidate, sampled
from voldetail.fit.resolvable import FINEST_OCTAVE, LARGEST_CELL, SMALLEST_CELL
from voldetail.fit.session import derived_seed
from voldetail.fit.space import Kind, Space
from voldetail.fit.warmstart.start import Start

SIDE = 96
"""Pixels a side of a relief's picture: what the first stages of a fit compare."""

WINDOW = 2.0
"""Scene units a side of the plane in it: a whole photo's."""

FINE = 192
"""Pixels a side of the fit that a library is for, by which the finest cells and octaves are limited."""

SPACE = Space(
    domain="solid", scale=(1.0 / (LARGEST_CELL * WINDOW), FINE / (SMALLEST_CELL * WINDOW)),
    finest=FINE / (FINEST_OCTAVE * WINDOW),
)  # fmt: skip
"""The space of a fit of a whole photo, see `fit.resolvable.space_of`."""

SPREAD = 0.12
"""Deviation by which numbers are moved, of their ranges: neighbouring scales of one relief just meet."""

STRETCH = 0.15
"""The same for the anisotropy, about round cells."""

MOST = 1 << 16
"""Reliefs that there are at most: the points of the sequence that covers the families."""

LENGTHS = ("noise.scale", "reflectance.speckle_scale")
"""Numbers in cells per scene unit, which a smaller window makes finer."""


@dataclass(frozen=True, eq=False)
class LibraryRelief:
    """One relief: its kind, a vector of `SPACE`, the seed of its noise."""

    kind: Kind
    vector: np.ndarray
    seed: int

    def detail(self) -> Detail:
        """Return the relief as it is drawn for the library."""
        return SPACE.decode(self.kind, self.vector).model_copy(update={"seed": self.seed})


def library_relief(k: int, seed: int = 0) -> LibraryRelief:
    """Return relief ``k``, 0 to MOST - 1. The light comes from the right; the angle is from 0 to pi / 2 from it, since the rest
    are mirror pictures."""
    rng = np.random.Generator(np.random.PCG64([seed, k]))
    first = _first(k, seed)
    names = SPACE.names(first.kind)
    vector = np.array(first.vector)
    if k % 2 == 0:
        vector = np.clip(vector + SPREAD * rng.standard_normal(len(vector)), 0.0, 1.0)
    stretch = names.index("stone_stretch" if first.kind.stones else "noise.anisotropy")
    vector[stretch] = np.clip(0.5 + STRETCH * rng.standard_normal(), 0.0, 1.0)
    vector[names.index("noise.angle")] = 0.5 * rng.random()
    return LibraryRelief(first.kind, vector, derived_seed(seed, f"look/{k}"))


def seen_through(relief: LibraryRelief, window: float, turned: float, mirrored: bool) -> Start:
    """Return ``relief`` as a start for a fit whose zone is ``window`` scene units wide, lit from ``turned`` (radians).

    mirrored: on the other side of the light's direction.
    """
    values = {name: SPACE.at(name, float(unit)) for name, unit in zip(SPACE.names(relief.kind), relief.vector, strict=True)}
    for name in LENGTHS:
        if name in values:
            values[name] *= WINDOW / window
    angle = values["noise.angle"]
    values["noise.angle"] = (turned + (-angle if mirrored else angle)) % np.pi
    return Start(relief.kind, values)


def _first(k: int, seed: int) -> Candidate:
    """The point that relief ``k`` is near to."""
    repeated, covering = _points(seed, 1 << max(k // 2 + 1, 255).bit_length())
    return repeated[k // 2 % len(repeated)] if k % 2 == 0 else covering[k // 2]


@lru_cache(maxsize=4)
def _points(seed: int, count: int) -> tuple[list[Candidate], list[Candidate]]:
    """The reliefs that nature repeats, and the first ``count`` that cover the families (more do not change the first)."""
    round_cells = (1.0, 0.0)
    return archetypes(SPACE, round_cells), sampled(SPACE, count, derived_seed(seed, "cover"), round_cells)
