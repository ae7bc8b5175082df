"""Tiles of wavelet noise: band-limited random coefficients (Cook and DeRose, Wavelet Noise, 2005, sections 3 and 4).

Symbols
    r       white noise of unit variance on a periodic lattice
    U       refinement of a quadratic B-spline's coefficients to half their spacing: 1/4, 3/4, 3/4, 1/4
    G       products of quadratic B-splines, integrated: 11/20, 13/60, 1/120 at distances 0, 1, 2
    P       U (U' G U)^-1 U' G: the part of a line of coefficients that half the resolution can represent
    n       r - (P x P) r in 2D, r - (P x P x P) r in 3D: the coefficients of one band

The filter of 32 numbers that Cook and DeRose print for downsampling is the middle of a row of (U' G U)^-1 U' G, to their
six digits; here it is solved for, without an end, on the periodic lattice.

P treats even and odd places differently, and so n is not stationary. Cook and DeRose add to the band its own copy, moved by
an odd offset. A copy of the same numbers would be met twice in a tile, and a move along the diagonal leaves the products of
directions uneven: here one independent image is added for each of the 2^d ways in which the axes can be even or odd. The
sum has twice the variance of one image, as theirs has.
"""

from __future__ import annotations

from functools import cache

import numpy as np
from numpy.typing import NDArray

REFINEMENT = (0.25, 0.75, 0.75, 0.25)
GRAM = (11 / 20, 13 / 60, 1 / 120)
"""Integrals of products of two quadratic B-splines at distances 0, 1 and 2: the quintic B-spline at the integers."""

CHANNELS = 4
"""Independent noises in a tile, side by side so that one gather fetches all: three for colour, and one to make it four."""

SIDES = {2: 256, 3: 64}
"""Coefficients along a tile: 1 MB and 4 MB with four channels, small enough for the cache; made in 0.3 s and 0.8 s on two busy
cores (128 a side in 3D: 32 MB and 5 s)."""

TILE_SEED = 2005
GAIN = 2.0
"""Variance of the finished band over that of one image r - P r: the copy at an odd offset doubles it (section 4.2)."""


@cache
def projection(side: int) -> NDArray[np.float64]:
    """Return P (side, side) on a periodic line of an even number of coefficients."""
    refine = np.zeros((side, side // 2))
    for k in range(side // 2):
        for tap, value in enumerate(REFINEMENT):
            refine[(2 * k + tap - 1) % side, k] += value
    gram = np.zeros((side, side))
    for distance, value in enumerate(GRAM):
        for sign in {1, -1} if distance else {1}:
            rows = np.arange(side)
            gram[rows, (rows + sign * distance) % side] += value
    analysis = refine.T @ gram
    return refine @ np.linalg.solve(analysis @ refine, analysis)


@cache
def wavelet_tile(dims: int, side: int = 0, seed: int = TILE_SEED) -> NDArray[np.float32]:
    """Return a periodic tile of coefficients (side, ..., side, CHANNELS), the last axis of space x; read-only, cached.

    dims: 2 or 3. side: a power of two from 16; 0 takes SIDES. Raises ValueError for another side.
    """
    side = side or SIDES[dims]
    if side < 16 or side & (side - 1):
        raise ValueError(f"a tile of {side} coefficients a side; a power of two from 16 is needed")
    random = np.random.default_rng([seed, dims, side])
    straight = projection(side).astype(np.float32)
    moved = np.roll(straight, (1, 1), axis=(0, 1))
    total = np.zeros((side,) * dims + (CHANNELS,), np.float32)
    for parity in range(2**dims):
        image = random.standard_normal(total.shape, dtype=np.float32)
        low = image
        for axis in range(dims):
            part = moved if parity >> axis & 1 else straight
            # Brings each axis to the front and back again: after `dims` turns the order is the first one.
            low = np.tensordot(low, part, axes=(0, 1))
            low = np.moveaxis(low, dims - 1, dims)
        total += image - low
    total *= np.float32(np.sqrt(GAIN / 2**dims))
    total.flags.writeable = False
    return total
