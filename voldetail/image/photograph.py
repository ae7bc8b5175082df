"""A photo with what of it is used: its file, its mask and its transparency put together in one place."""

from __future__ import annotations

import hashlib
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from voldetail.errors import InputError
from voldetail.image.load import MIN_SIDE, Encoding, Photo, load_photo
from voldetail.image.mask import load_mask
from voldetail.image.samples import MAX_PIXELS
from voldetail.image.srgb import to_linear

PhotoLike = str | Path | NDArray[np.floating] | NDArray[np.integer] | Photo
"""A file, "skimage:gravel" and the like, an array (H, W) or (H, W, 3), or a photo that was read already."""

MaskLike = str | Path | NDArray[np.bool_] | NDArray[np.integer] | NDArray[np.floating]
"""A file whose white is used, or an array (H, W): True, or over half of what the type holds, is used."""


def as_photo(photo: PhotoLike, *, encoding: Encoding = "auto") -> Photo:
    """Return ``photo`` as linear light.

    Floats are linear and whole numbers of 8 or 16 bits sRGB, unless ``encoding`` says otherwise. Raises InputError for a file
    that is no photo, and for an array of another shape or type, that is too small or large, or holds NaN or infinities.
    """
    if isinstance(photo, Photo):
        return photo
    if isinstance(photo, str | Path):
        return load_photo(photo, encoding=encoding)
    pixels = np.asarray(photo)
    if pixels.ndim not in (2, 3) or (pixels.ndim == 3 and pixels.shape[2] != 3):
        raise InputError(f"The photo is an array of shape {pixels.shape}; give one of (H, W) or (H, W, 3).")
    rows, columns = pixels.shape[:2]
    if min(rows, columns) < MIN_SIDE or rows * columns > MAX_PIXELS:
        raise InputError(f"The photo has {columns} x {rows} pixels; give at least {MIN_SIDE} a side, and 100 megapixels at most.")
    linear = _linear(pixels, encoding)
    linear = np.repeat(linear[..., None], 3, axis=2) if linear.ndim == 2 else linear
    return Photo(np.ascontiguousarray(linear), hashlib.sha256(np.ascontiguousarray(pixels).tobytes()).hexdigest())


def with_mask(photo: Photo, mask: MaskLike | None) -> Photo:
    """Return ``photo`` with what ``mask`` leaves out counted as transparent, so that ``opaque`` is all that is used.

    Raises InputError for a mask of another size, one that is empty, and one that leaves only transparent pixels.
    """
    if mask is None:
        return photo
    rows, columns = photo.pixels.shape[:2]
    white = load_mask(mask, (rows, columns)) if isinstance(mask, str | Path) else _array_mask(mask, (rows, columns))
    used = white if photo.opaque is None else white & photo.opaque
    if not used.any():
        name = f"The mask {mask}" if isinstance(mask, str | Path) else "The mask"
        raise InputError(f"{name} leaves only transparent pixels of the photo; paint other parts white.")
    return replace(photo, opaque=np.ascontiguousarray(used))


def load_masked(photo: PhotoLike, mask: MaskLike | None = None, *, encoding: Encoding = "auto") -> Photo:
    """Return `as_photo` with its mask, `with_mask`."""
    return with_mask(as_photo(photo, encoding=encoding), mask)


def used_of(photo: Photo) -> NDArray[np.bool_]:
    """Return which pixels (H, W) of a photo are used."""
    return np.ones(photo.pixels.shape[:2], dtype=bool) if photo.opaque is None else photo.opaque


def _linear(pixels: NDArray[Any], encoding: Encoding) -> NDArray[np.float32]:
    if pixels.dtype == np.uint8 or pixels.dtype == np.uint16:
        values = pixels.astype(np.float64) / np.iinfo(pixels.dtype).max
        return np.asarray(values if encoding == "linear" else to_linear(values), np.float32)
    if pixels.dtype.kind != "f":
        raise InputError(f"The photo is an array of {pixels.dtype}; give floats, or whole numbers of type uint8 or uint16.")
    values = pixels.astype(np.float32)
    if not np.isfinite(values).all():
        raise InputError("The photo holds values that are NaN or infinite; repair them first.")
    if values.size and values.min() < 0:
        raise InputError(f"The photo holds negative values, down to {values.min():.3g}; light is 0 or more.")
    return np.asarray(to_linear(values) if encoding == "srgb" else values, np.float32)


def _array_mask(mask: NDArray[Any], shape: tuple[int, int]) -> NDArray[np.bool_]:
    values = np.asarray(mask)
    if values.shape != shape:
        raise InputError(f"The mask is an array of shape {values.shape} and the photo {shape}; give one of the photo's size.")
    if values.dtype != bool:
        half = np.iinfo(values.dtype).max / 2 if values.dtype.kind in "iu" else 0.5
        values = values > half
    if not values.any():
        raise InputError("The mask is empty: no pixel is True; mark what is to be used.")
    return values
