"""A photo as a blend of two tones: its structure map and its two colours (GKHF14 section 3).

    T(x) = (1 - s(x)) c_1 + s(x) c_2                                       (equation 2)

(Gieseke, Koch, Hahn & Fuchs, "Interactive Parameter Retrieval for Two-Tone Procedural Textures", 2014.)

Symbols
    c_1, c_2    the tones, sRGB-encoded RGB in [0, 1], c_1 the darker
    s           structure, 0 at c_1 and 1 at c_2
    t           place of a pixel's projection on the line of the first principal component

The paper's colours are RGB values as pictures store them, so the line is fitted to encoded values, where equal steps also
look more alike than in linear light.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from voldetail.errors import InputError
from voldetail.image import luminance, to_linear, to_srgb
from voldetail.texture.analysis import CONSTANT, pixels_of, principal_axes
from voldetail.types import Array, Mask

WELL_EXPLAINED = 0.9
"""Share of the variance on the line from which a photo counts as two-tone. Tuned on 22 photographs: stone,
sand, cloth and clouds have 0.94 to 1 and look right in two tones, gravel under leaves of another colour has 0.87."""

FEWEST_PIXELS = 64

SAME_LUMINANCE = 1e-6
"""Difference of luminance under which two tones are ordered by their channels instead."""


@dataclass(frozen=True, eq=False)
class TwoTone:
    """A photo's two-tone reading.

    structure: s (H, W) in [0, 1], 0 outside the mask. dark, bright: c_1 and c_2 (3,), sRGB-encoded. explained: share of the
    colours' variance that lies along the line, 0 to 1. poor: empty, or a sentence where the line leaves out too much.
    """

    structure: Array
    dark: Array
    bright: Array
    explained: float
    poor: str


def two_tone(photo: ArrayLike, mask: ArrayLike | None = None, *, trim: float = 0.0) -> TwoTone:
    """Return the two tones of ``photo`` (H, W, 3), linear light, and its structure map (GKHF14 section 3).

        t(x) = axis . (T(x) - mean),    s(x) = (t(x) - t_1) / (t_2 - t_1), held in [0, 1]

    axis: the first principal component of the encoded colours. t_1, t_2: the extremal places, moved along the line to the
    RGB cube's surface where they are outside. mask: (H, W), True = use; all by default. trim: share of the pixels, at either
    end, that may lie beyond the tones (0 by default, as in the paper; a thousandth leaves out specks). A grey photo may be
    (H, W). What is outside 0 to 1 is clipped. Raises InputError for other shapes, a photo of one colour, values inside the
    mask that are not finite, a mask of another size or of under 64 pixels, and a trim that is not from 0 to 0.4.
    """
    pixels, inside = _checked(photo, mask, trim)
    encoded = to_srgb(np.clip(np.where(inside[..., None], pixels, np.float32(0.0)), 0.0, 1.0))
    colours = encoded[inside]
    axis = principal_axes(colours)[0]
    mean = colours.mean(axis=0, dtype=np.float64)
    places = (colours - mean) @ axis
    variance = float(colours.var(axis=0, dtype=np.float64).sum())
    if variance < CONSTANT**2:
        raise InputError("The photo has one colour only and no structure; give one with two tones.")
    ends = np.quantile(places, [trim, 1.0 - trim])
    if ends[1] - ends[0] < CONSTANT:
        raise InputError("Hardly a pixel of the photo differs from the others; trim less, or give one with two tones.")
    first, second = _within_cube(ends, mean, axis)
    tones = np.clip(np.stack([mean + first * axis, mean + second * axis]), 0.0, 1.0)
    structure = np.zeros(inside.shape, np.float32)
    structure[inside] = np.clip((places - first) / (second - first), 0.0, 1.0)
    if not _in_order(tones):
        tones = tones[::-1]
        structure[inside] = 1.0 - structure[inside]
    explained = min(float(places.var()) / variance, 1.0)
    dark, bright = np.asarray(tones, np.float32)
    return TwoTone(structure, dark, bright, explained, _poor(explained))


def recolour(structure: ArrayLike, dark: ArrayLike, bright: ArrayLike) -> Array:
    """Return the picture (H, W, 3), linear light, of a structure map (H, W) in [0, 1] in two sRGB-encoded tones (equation 2).

    Raises InputError for tones that are not three numbers from 0 to 1, and a structure that is not a finite map.
    """
    s = np.asarray(structure, np.float32)
    tones = [np.asarray(tone, np.float32) for tone in (dark, bright)]
    if any(tone.shape != (3,) or not ((tone >= 0) & (tone <= 1)).all() for tone in tones):
        raise InputError("A tone has to be three numbers from 0 to 1: encoded red, green and blue.")
    if s.ndim != 2 or not np.isfinite(s).all():
        raise InputError(f"The structure has the shape {s.shape}; a map (H, W) of finite numbers is needed.")
    s = np.clip(s, 0.0, 1.0)[..., None]
    return to_linear((1.0 - s) * tones[0] + s * tones[1])


def _within_cube(ends: NDArray[np.float64], mean: NDArray[np.float64], axis: NDArray[np.float64]) -> tuple[float, float]:
    """Hold places on the line within the RGB cube. The mean of colours is inside it, so the line crosses it."""
    along = np.abs(axis) > 1e-12
    at_0, at_1 = -mean[along] / axis[along], (1.0 - mean[along]) / axis[along]
    return max(ends[0], float(np.minimum(at_0, at_1).max())), min(ends[1], float(np.maximum(at_0, at_1).min()))


def _in_order(tones: NDArray[np.float64]) -> bool:
    dark, bright = (float(v) for v in luminance(to_linear(tones)))
    if abs(dark - bright) > SAME_LUMINANCE:
        return dark < bright
    return tuple(tones[0]) <= tuple(tones[1])


def _poor(explained: float) -> str:
    if explained >= WELL_EXPLAINED:
        return ""
    return (
        f"The photo has more than two tones: {1 - explained:.0%} of its colours' variance is off the line between them, "
        "so expect a match of its structure only."
    )


def _checked(photo: ArrayLike, mask: ArrayLike | None, trim: float) -> tuple[Array, Mask]:
    pixels = pixels_of(photo)
    inside = np.ones(pixels.shape[:2], bool) if mask is None else np.asarray(mask).astype(bool)
    if inside.shape != pixels.shape[:2]:
        raise InputError(f"The mask has the shape {inside.shape} and the photo {pixels.shape[:2]}; give one of its size.")
    count = int(np.count_nonzero(inside))
    if count < FEWEST_PIXELS:
        raise InputError(f"There are {count} pixels to read tones from; at least {FEWEST_PIXELS} are needed.")
    if not np.isfinite(pixels[inside]).all():
        raise InputError("The photo has pixels that are NaN or infinite; repair them or leave them out with a mask.")
    if not 0.0 <= trim <= 0.4:
        raise InputError(f"The trim is {trim:g}; a share from 0 to 0.4 is allowed.")
    return pixels, inside
