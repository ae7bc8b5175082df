"""Gaussian neighbourhoods around a grid of points: local means, and their inverse, blending (MJHRW17 eq. 2, 4.3).

A Gaussian window is a product of a row and a column part, so all local means of a picture are two small matrix
products, and so is the blending of overlapping blocks with the same weights.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from voldetail.types import Array

ONE_THREAD = 4 * 65536
"""Multiplications up to which OpenBLAS keeps a product in one thread (its GEMM_MULTITHREAD_THRESHOLD x 65536)."""

COLUMNS = 256
"""Of a part of a product."""

NOTHING = 1e-7
"""Weights below this are 0: a float's rounding against the peak, and numbers near 1e-38 are slow to multiply."""


@dataclass(frozen=True, eq=False)
class Neighbourhoods:
    """Points p on a grid over a picture, and the weights w_d(p, y) of eq. 2 of every pixel y around each.

    `rows` (R, H) and `columns` (C, W) are the two parts of the weights, peak 1; `toroidal`, whether the picture's
    opposite edges meet.
    """

    rows: Array
    columns: Array
    toroidal: bool

    @property
    def grid(self) -> tuple[int, int]:
        """Number of points: rows, columns."""
        return len(self.rows), len(self.columns)

    def total(self, plane: NDArray[np.generic]) -> Array:
        """Weighted sums (R, C) of a picture (H, W) around every point."""
        return product(product(self.rows, np.asarray(plane, np.float32)), self.columns.T)

    def mean(self, plane: NDArray[np.generic], weight: Array | None = None) -> Array:
        """Weighted means (R, C) of a picture (H, W), with pixels counting by `weight` (H, W) too if it is given.

        0 where no weight lies around a point.
        """
        if weight is None:
            return np.asarray(self.total(plane) / np.outer(self.rows.sum(1), self.columns.sum(1)))
        around = self.total(weight)
        found = self.total(np.asarray(plane, np.float32) * weight)
        return np.asarray(np.where(around > 0, found / np.where(around > 0, around, 1), 0))

    def blend(self, fields: Array) -> Array:
        """Values (R, C, n) of the points blended to pixels (H, W, n) with the windows as weights."""
        points_r, points_c, count = fields.shape
        rows = self.rows / self.rows.sum(axis=0)
        columns = self.columns / self.columns.sum(axis=0)
        height, width = rows.shape[1], columns.shape[1]
        down = product(np.ascontiguousarray(rows.T), fields.reshape(points_r, points_c * count))
        turned = np.ascontiguousarray(down.reshape(height, points_c, count).transpose(1, 0, 2)).reshape(points_c, -1)
        across = product(np.ascontiguousarray(columns.T), turned)
        return np.ascontiguousarray(across.reshape(width, height, count).transpose(1, 0, 2))

    def between(self, field: Array) -> Array:
        """Values (R, C) of the points at all pixels (H, W), by linear interpolation."""
        height, width = self.rows.shape[1], self.columns.shape[1]
        where = np.ix_(
            *((np.arange(n) + 0.5) * count / n - 0.5 for n, count in ((height, len(self.rows)), (width, len(self.columns))))
        )
        y, x = np.broadcast_arrays(*where)
        mode = "grid-wrap" if self.toroidal else "nearest"
        return np.asarray(ndimage.map_coordinates(field, [y, x], order=1, mode=mode), np.float32)


def product(a: Array, b: Array) -> Array:
    """a @ b in parts so small that OpenBLAS does each in the calling thread: its other threads would go on spinning
    and take the processor from the search (two to three times the time of the whole on two cores)."""
    out = np.empty((a.shape[0], b.shape[1]), np.float32)
    columns = min(b.shape[1], COLUMNS)
    rows = max(ONE_THREAD // (a.shape[1] * columns), 1)
    for c in range(0, b.shape[1], columns):
        part = np.ascontiguousarray(b[:, c : c + columns])
        for r in range(0, a.shape[0], rows):
            np.matmul(a[r : r + rows], part, out=out[r : r + rows, c : c + columns])
    return out


def neighbourhoods(shape: tuple[int, int], sigma: float, spacing: float, toroidal: bool) -> Neighbourhoods:
    """Points about `spacing` pixels apart over a picture of `shape` with Gaussian windows of standard deviation `sigma`
    pixels."""
    rows, columns = (_windows(n, sigma, spacing, toroidal) for n in shape)
    return Neighbourhoods(rows, columns, toroidal)


def _windows(length: int, sigma: float, spacing: float, toroidal: bool) -> Array:
    count = max(int(np.ceil(length / spacing)), 1)
    centres = (np.arange(count) + 0.5) * length / count - 0.5
    offset = np.arange(length)[None, :] - centres[:, None]
    # On a torus a window wider than the picture meets itself: the nearest copies on both sides count as well.
    copies = (-1, 0, 1) if toroidal else (0,)
    window = np.asarray(sum(np.exp(-((offset + k * length) ** 2) / (2 * sigma**2)) for k in copies))
    return np.where(window < NOTHING, 0, window).astype(np.float32)
