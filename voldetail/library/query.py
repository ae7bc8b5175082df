"""A photo made ready to be looked for in a library: its crop, its two tones and its descriptor (GKHF14 sections 3 and 4).

The descriptor's lengths are pixels, and entries are pictures of 256 pixels, so a photo's size decides what it is compared
with: a brick of 500 pixels is in no library, one of 50 is.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from voldetail.errors import InputError
from voldetail.image import resize, resize_mask
from voldetail.library.entries import SIDE
from voldetail.library.span import TRIM
from voldetail.library.two_tone import TwoTone, two_tone
from voldetail.library.vectors import SMALLEST_SIDE, vector_of
from voldetail.texture.analysis import pixels_of
from voldetail.types import Array

Zone = tuple[int, int, int, int]

LARGEST_SIDE = 2048
"""Pixels of a photo that is described: seconds and some hundred MB."""


@dataclass(frozen=True, eq=False)
class Query:
    """A photo ready to be looked for.

    photo: the crop as it was described, (H, W, 3) linear. mask: (H, W), True = used. tones: its two-tone reading. vector:
    descriptor (750,) of its structure. scale: pixels here for one of the photo. missing: how many of the descriptor's six
    scales, the coarsest first, do not fit and are not compared.
    """

    photo: Array
    mask: NDArray[np.bool_]
    tones: TwoTone
    vector: Array
    scale: float
    missing: int


def query(
    photo: ArrayLike, mask: ArrayLike | None = None, *, zone: Zone | None = None, scale: float | None = None, trim: float = TRIM
) -> Query:
    """Return ``photo`` (H, W, 3) or (H, W), linear light, made ready.

    mask: (H, W), True = use. zone: x, y, width, height in pixels of the part to use, by default all. scale: what that part is
    resized by, over 0; by default its longer side becomes 256 pixels, and a smaller photo keeps its size. trim: see `two_tone`;
    by default half a percent. Raises InputError for a zone outside the photo, a result under 32 or over 2048 pixels a side, and
    whatever `two_tone` and `vector_of` refuse.
    """
    pixels = pixels_of(photo)
    inside = np.ones(pixels.shape[:2], bool) if mask is None else np.asarray(mask).astype(bool)
    if inside.shape != pixels.shape[:2]:
        raise InputError(f"The mask has the shape {inside.shape} and the photo {pixels.shape[:2]}; give one of its size.")
    if zone is not None:
        x, y, width, height = zone
        rows, columns = pixels.shape[:2]
        if min(x, y) < 0 or min(width, height) < 1 or x + width > columns or y + height > rows:
            raise InputError(f"The zone {x},{y},{width},{height} reaches outside the photo of {columns} x {rows} pixels.")
        pixels, inside = pixels[y : y + height, x : x + width], inside[y : y + height, x : x + width]
    factor = min(1.0, SIDE / max(inside.shape)) if scale is None else scale
    size = _size(inside.shape, factor)
    if size != inside.shape:
        pixels, inside = resize(_filled(pixels, inside), size), resize_mask(inside, size)
    tones = two_tone(pixels, inside, trim=trim)
    vector = vector_of(tones.structure, None if inside.all() else inside)
    missing = int(np.isnan(vector[2:8]).sum())
    return Query(np.ascontiguousarray(pixels), inside, tones, vector, factor, missing)


def _size(shape: tuple[int, ...], factor: float) -> tuple[int, int]:
    if not (np.isfinite(factor) and factor > 0):
        raise InputError(f"The scale is {factor:g}; a number over 0 is needed: what the photo is resized by.")
    # Checked before rounding, since a huge factor has no whole number.
    if max(shape) * factor > LARGEST_SIDE:
        raise InputError(
            f"The photo would be {max(shape) * factor:.0f} pixels long at a scale of {factor:g}; at most {LARGEST_SIDE} are "
            "compared, so give a smaller scale or zone."
        )
    rows, columns = (round(n * factor) for n in shape)
    if min(rows, columns) < SMALLEST_SIDE:
        raise InputError(
            f"The photo would be {columns} x {rows} pixels at a scale of {factor:g}; at least {SMALLEST_SIDE} a side are "
            "needed, so give a larger scale or zone."
        )
    return rows, columns


def _filled(pixels: Array, used: NDArray[np.bool_]) -> Array:
    """What is not used may be anything, and must not be smeared over what is."""
    return pixels if used.all() else np.where(used[..., None], pixels, pixels[used].mean(axis=0) if used.any() else 0.0)
