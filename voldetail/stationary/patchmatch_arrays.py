"""Pictures as Dr.Jit arrays, and the two kernels of PatchMatch: comparing patches and voting.

Both only gather, and add up in a fixed order, so their results do not depend on the number of threads. What changes
from call to call (widths, pictures) is in arrays and not in the code: each kernel is compiled once and kept on disk.
"""

from __future__ import annotations

from typing import Any

import drjit as dr
import numpy as np
from drjit.llvm import Array4f, Float, UInt32
from numpy.typing import NDArray

PATCH = 11
"""Side of a patch in pixels (MJHRW17 section 4.1)."""

RADIUS = PATCH // 2

SEARCH_SIGMA = float("inf")
"""Standard deviation in pixels of the weights with which a patch's pixels vote between two searches: all alike, so that
overlapping patches come to agree (Gaussians of 1.6 and 4 pixels left seams and stones cut in half)."""

LAST_SIGMA = 2.0
"""The same in the last vote: its centre knows best, and narrow weights do not blur what patches still disagree on. Both
were chosen by eye and texture cost on two photographs of the test data, gravel and weathered rock."""


def packed(picture: NDArray[Any]) -> Float:
    """A picture (H, W, C), C up to 4, as one array of 4 H W numbers, absent channels 0."""
    height, width, channels = picture.shape
    out = np.zeros((height, width, 4), np.float32)
    out[..., :channels] = picture
    return Float(out.ravel())


def wrapped(tile: NDArray[Any]) -> NDArray[Any]:
    """A tile (N, M, ...) continued by RADIUS on all sides with what comes round from the opposite ones."""
    margin = ((RADIUS, RADIUS), (RADIUS, RADIUS)) + ((0, 0),) * (tile.ndim - 2)
    return np.pad(tile, margin, mode="wrap")


def pixel_numbers(height: int, width: int, stride: int) -> NDArray[np.uint32]:
    """Number y * stride + x of every pixel of an H x W picture within rows of `stride` pixels: (H W,)."""
    y, x = np.mgrid[:height, :width]
    return (y * stride + x).ravel().astype(np.uint32)


@dr.syntax
def squared_difference(
    tile: Float, tile_width: UInt32, at: UInt32, source: Float, source_width: UInt32, patch: UInt32, limit: Float
) -> Float:
    """Sum of squared differences between patches of two packed pictures, or a number above `limit` (which is positive)
    where the sum is.

    `at` and `patch` number the patches' first pixels. A comparison ends with the row that passes its `limit`.
    """
    total, row = Float(0), UInt32(0)
    t, s = UInt32(at), UInt32(patch)
    while (row < PATCH) & (total < limit):
        for column in range(PATCH):
            d = dr.gather(Array4f, tile, t + column) - dr.gather(Array4f, source, s + column)
            total += dr.squared_norm(d)
        t += tile_width
        s += source_width
        row += 1
    return total


@dr.syntax
def voted(field: UInt32, field_width: UInt32, at: UInt32, source: Float, source_width: UInt32, weights: Float) -> Array4f:
    """Weighted mean of what all patches over a tile's pixel say about it: pixel `at` of the wrapped `field`.

    `field` holds the first pixel of the source patch that belongs to each pixel of the tile, `weights` (PATCH,) are
    those of rows and columns.
    """
    total, row = Array4f(0), UInt32(0)
    f = UInt32(at)
    last = PATCH - 1
    while row < PATCH:
        # The patch of the field's row r covers this pixel with its own row PATCH - 1 - r.
        weight = dr.gather(Float, weights, row)
        line = (last - row) * source_width
        for column in range(PATCH):
            patch = dr.gather(UInt32, field, f + column)
            colour = dr.gather(Array4f, source, patch + line + (last - column))
            total += weight * dr.gather(Float, weights, UInt32(column)) * colour
        f += field_width
        row += 1
    return total


def vote_weights(sigma: float) -> Float:
    """Weights (PATCH,) of a patch's rows and columns, a Gaussian; they add up to one."""
    offset = np.arange(PATCH) - RADIUS
    window = np.exp(-(offset**2) / (2 * sigma**2))
    return Float((window / window.sum()).astype(np.float32))


def vote(field: NDArray[np.uint32], source: NDArray[Any], sigma: float) -> NDArray[np.float32]:
    """A tile (N, M, C) by vote of the patches of `source` (H, W, C) that `field` (N, M) names by their first pixel.

    `sigma` is the standard deviation of the votes' weights in pixels.
    """
    height, width = field.shape
    padded = UInt32(wrapped(field).ravel())
    stride = dr.opaque(UInt32, width + 2 * RADIUS)
    at = UInt32(pixel_numbers(height, width, width + 2 * RADIUS))
    source_width, weights = dr.opaque(UInt32, source.shape[1]), vote_weights(sigma)
    dr.make_opaque(padded, at, weights)
    groups = []
    for first in range(0, source.shape[2], 4):
        planes = source[..., first : first + 4]
        colour = voted(padded, stride, at, packed(planes), source_width, weights)
        values = np.array(dr.ravel(colour)).reshape(height, width, 4)
        groups.append(values[..., : planes.shape[2]])
    return np.concatenate(groups, axis=2)
