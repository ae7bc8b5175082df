"""The picture that patches are taken from: which may be used, and how often each was (MJHRW17 eq. 6).

Symbols: |T|, |S|, pixels of tile and source; N, a patch's side; Omega, how many chosen patches cover a source pixel;
omega_best, how many should.
"""

from __future__ import annotations

from typing import Any

import drjit as dr
import numpy as np
from drjit.llvm import UInt32
from numpy.typing import NDArray
from scipy import ndimage

from voldetail.errors import InputError
from voldetail.stationary.patchmatch_arrays import PATCH, packed

UNIFORMITY = 0.05
"""Cost of a patch that is used as often as omega_best, against a patch's cost where it differs from the source's mean
by the source's own variance. Chosen on three photographs of the test data (gravel, a slab, a metal plate): with none a
few patches fill the tile, and three times as much forces the photo's extremes into it."""

NEVER = 1e30
"""Cost of a patch that must not be used."""


class Source:
    """Patches of a picture (H, W, C), C up to 4, which `use` (H, W) lets be used: those that lie wholly in it.

    `spread` is the picture's variance, summed over channels. Raises InputError where no patch fits.
    """

    def __init__(self, picture: NDArray[Any], use: NDArray[np.bool_], tile_pixels: int) -> None:
        height, width = use.shape
        if min(height, width) < PATCH:
            raise InputError(
                f"The photo has {width} x {height} pixels here, less than a patch of {PATCH} x {PATCH}; give a larger one."
            )
        free = ndimage.minimum_filter(use.astype(np.uint8), size=PATCH, origin=-(PATCH // 2), mode="constant").astype(bool)
        free[height - PATCH + 1 :], free[:, width - PATCH + 1 :] = False, False
        if not free.any():
            raise InputError(f"The mask leaves no place for a patch of {PATCH} x {PATCH} pixels; paint larger parts of it white.")
        self.free, self.shape = free, (height, width)
        self.patches = np.flatnonzero(free).astype(np.uint32)
        self.spread = float(picture[use].var(axis=0, dtype=np.float64).sum())
        self.picture, self.width = packed(picture), dr.opaque(UInt32, width)
        self.best_use = max(1.0, tile_pixels / np.count_nonzero(use)) * PATCH**2  # omega_best, eq. 6

    def random(self, rng: np.random.Generator, count: int) -> NDArray[np.uint32]:
        """Return `count` patches, each as likely as any other."""
        return self.patches[rng.integers(0, len(self.patches), count)]

    def inside(self, row: NDArray[Any], column: NDArray[Any]) -> NDArray[np.uint32]:
        """Number the patches whose first pixels are nearest to (row, column); some may be covered by the mask's holes."""
        height, width = self.shape
        return np.asarray(np.clip(row, 0, height - PATCH) * width + np.clip(column, 0, width - PATCH), np.uint32)

    def usage(self, patch: NDArray[np.uint32]) -> NDArray[np.float32]:
        """Omega / omega_best (H, W), the mean over each patch, by its first pixel, when the tile uses the patches `patch`."""
        counts = np.bincount(patch.ravel(), minlength=self.free.size).reshape(self.shape).astype(np.float32)
        # Each chosen patch covers PATCH x PATCH pixels, and a patch's usage is the mean over as many: two boxes,
        # one to either side, so that together they are centred.
        size, last = PATCH, PATCH // 2
        covered = ndimage.uniform_filter(counts, size, mode="constant", origin=last) * PATCH**2
        return np.asarray(ndimage.uniform_filter(covered, size, mode="constant", origin=-last) / self.best_use)

    def penalty(self, patch: NDArray[np.uint32], uniformity: float) -> NDArray[np.float32]:
        """What each patch of the source costs besides its difference: for being used often, or NEVER."""
        cost = uniformity * self.spread * PATCH**2 * self.usage(patch)
        return np.where(self.free, cost, NEVER).astype(np.float32).ravel()
