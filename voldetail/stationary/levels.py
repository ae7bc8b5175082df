"""The pyramid of tile and photo over which a tile is made (MJHRW17 section 4.2)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from voldetail.errors import InputError
from voldetail.image import resize, resize_mask
from voldetail.stationary.colour import to_lab
from voldetail.stationary.patchmatch_arrays import PATCH
from voldetail.stationary.patchmatch_source import Source
from voldetail.stationary.project import BLOCK_SPACING
from voldetail.types import Array, Mask

TOP = 1 / 4
"""Size of the top level against the last (section 4.2)."""

FACTOR = 1.3
"""From one level to the next (section 4.2); rounded so that the levels end at the size wanted."""

SMALLEST_TOP = 16
"""Pixels: below that a tile hardly holds a patch and its neighbour."""

TOP_ITERATIONS = 30
ITERATIONS = 3
"""At each further level; 2 or 3 in section 4.2."""

LARGEST = 2048
"""Side of a tile in pixels; a search takes some seconds for each 256 x 256."""

QUANTILES = 1025
"""Of the exemplar's histogram; four to each step of an 8-bit picture."""


@dataclass(frozen=True)
class Level:
    """One level: the tile's `side` in pixels, its share of the final one, block spacing k, and iterations."""

    side: int
    scale: float
    spacing: float
    iterations: int


@dataclass(frozen=True, eq=False)
class Exemplar:
    """The photo at one level: CIE L*a*b* (H, W, 3), where it may be used (H, W), its patches, and its quantiles (Q, 3)."""

    lab: Array
    use: Mask
    source: Source
    quantiles: Array


def checked_size(size: int, shape: tuple[int, int]) -> int:
    """`size`, the tile's side in pixels; raises InputError unless it is PATCH to the photo's shorter side."""
    if min(shape) < PATCH:
        raise InputError(
            f"The photo has {shape[1]} x {shape[0]} pixels, less than a patch of {PATCH} x {PATCH}; give a larger one."
        )
    largest = min(min(shape), LARGEST)
    if not SMALLEST_TOP <= size <= largest:
        reason = "the photo's shorter side" if largest < LARGEST else "the largest tile that is made"
        raise InputError(
            f"A tile of {size} pixels cannot be made from a photo of {shape[1]} x {shape[0]}; give {SMALLEST_TOP} to"
            f" {largest}, {reason}."
        )
    return int(size)


def levels(size: int, shape: tuple[int, int]) -> list[Level]:
    """The levels for a tile of `size` pixels from a photo of `shape`, the coarsest first.

    The top is a quarter, or more where the tile or the photo would be too small for patches.
    """
    top = min(max(size * TOP, SMALLEST_TOP, 2 * PATCH * size / min(shape)), size)
    steps = round(np.log(size / top) / np.log(FACTOR))
    sides = sorted({round(top * (size / top) ** (i / steps)) for i in range(steps)} | {size}) if steps else [size]
    finest = max(len(sides) - 1, 1)
    coarse, fine = BLOCK_SPACING
    return [
        Level(side, side / size, coarse + (fine - coarse) * i / finest, ITERATIONS if i else TOP_ITERATIONS)
        for i, side in enumerate(sides)
    ]


def exemplar(photo: Array, use: Mask, level: Level) -> Exemplar:
    """The photo (H, W, 3), linear, and its mask as the level sees them; raises InputError where no patch fits."""
    height, width = use.shape
    shape = (max(round(height * level.scale), PATCH), max(round(width * level.scale), PATCH))
    if shape != use.shape:
        photo, use = resize(photo, shape), resize_mask(use, shape)
    lab = to_lab(photo)
    source = Source(lab, use, level.side**2)
    quantiles = np.quantile(lab[use], np.linspace(0, 1, QUANTILES), axis=0).astype(np.float32)
    return Exemplar(lab, use, source, quantiles)
