"""CIE L*a*b*, the colours in which textures are compared (MJHRW17 section 3)."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray
from skimage.color import lab2rgb, rgb2lab

from voldetail.errors import InputError
from voldetail.image import to_linear, to_srgb
from voldetail.types import Array, Mask

BRIGHTEST = 4.0
"""Linear light above this is cut: four times white is a lamp or a glint, and would stretch every histogram."""


def to_lab(linear: NDArray[Any]) -> Array:
    """Linear RGB (..., 3) as CIE L*a*b* under D65 (..., 3) float32: L* 0 to 100 for light of 0 to 1, a* and b* about
    -128 to 127."""
    encoded = to_srgb(np.clip(np.asarray(linear, np.float32), 0, BRIGHTEST))
    return np.asarray(rgb2lab(encoded), np.float32)


def from_lab(lab: NDArray[Any]) -> Array:
    """CIE L*a*b* (..., 3) as linear RGB (..., 3) float32, never negative and at most 1: the inverse of `to_lab` within
    the gamut."""
    return to_linear(np.asarray(lab2rgb(np.asarray(lab, np.float32)), np.float32))


def usable(photo: NDArray[Any], mask: NDArray[Any] | None) -> tuple[Array, Mask, int]:
    """A photo's pixels, which of them may be used, and how many were left out for being NaN or infinite.

    `photo` is (H, W, 3) linear or (H, W), `mask` (H, W), True = use, or None for all. Unused pixels of the result
    (H, W, 3) hold the mean of the used ones, so that no filter meets a NaN. Raises InputError for another shape, and
    where no pixel is left.
    """
    pixels = np.asarray(photo, np.float32)
    if pixels.ndim == 2:
        pixels = np.repeat(pixels[..., None], 3, axis=2)
    if pixels.ndim != 3 or pixels.shape[2] != 3 or pixels.size == 0:
        raise InputError(f"The photo is an array of shape {np.shape(photo)}; give (height, width, 3), linear.")
    finite = np.isfinite(pixels).all(axis=2)
    use = np.ones(finite.shape, bool) if mask is None else np.asarray(mask, bool)
    if use.shape != finite.shape:
        raise InputError(
            f"The mask is an array of shape {use.shape} and the photo has {finite.shape}; give one of the photo's size."
        )
    if not use.any():
        raise InputError("The mask is empty: no pixel of the photo is to be used; paint what is to be used white.")
    left_out = int(np.count_nonzero(use & ~finite))
    use = use & finite
    if not use.any():
        raise InputError("No pixel of the photo that is to be used is a finite number; repair the photo.")
    filled = np.where(use[..., None], pixels, pixels[use].mean(axis=0, dtype=np.float64).astype(np.float32))
    return np.ascontiguousarray(filled), use, left_out
