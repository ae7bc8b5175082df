"""A colour texture from one photograph (LVLD10 article, section 5.3; report, section 7).

    channels_c = axes_c . colour,      z_c = Gaussianised channel,      weights of z_c by its power spectrum

Three channels, uncorrelated over the photo's pixels (principal components); of each, ten samples of its histogram and a
weight for every octave of wavelengths. A 512 x 512 photo becomes 66 numbers: 9 weights and 10 samples a channel, and 9 of the
rotation. The mean is in the samples, since the channels are not centred.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from voldetail.detail.colour import ColourChannel, ColourTexture
from voldetail.errors import InputError
from voldetail.image import to_srgb
from voldetail.texture.curve import PLACES, fitted_curve, gaussian_curve
from voldetail.texture.gaussian import gaussianise
from voldetail.texture.isotropy import isotropy_of
from voldetail.texture.lobes import lobes_of
from voldetail.texture.power import band_powers, weights_of
from voldetail.types import Floats

SMALLEST_SIDE = 8
"""Pixels: three octaves of wavelengths, the fewest that tell a slope of the spectrum."""

FEWEST_PIXELS = 64

LEAST_DIRECTED = 64
"""Pixels a side below which directions are not looked for: an octave has hardly a bin a sector."""

CONSTANT = 1e-4
"""Deviation under which a channel is constant: a fortieth of a step of an 8-bit file, far over single precision's rounding."""


def analyse(
    photo: ArrayLike,
    mask: ArrayLike | None = None,
    *,
    seed: int = 0,
    name: str = "texture",
    photo_name: str = "",
    match_histogram: bool = True,
    encoding: str = "srgb",
    directed: bool | None = None,
) -> ColourTexture:
    """Return the procedural texture of ``photo`` (H, W, 3), linear light; what is outside 0 to 1 is clipped.

    mask: (H, W), True where the photo is to be used; all of it by default. The spectrum is that of the photo with its mean
    outside the mask, divided by the share that is inside. match_histogram: False gives every channel a Gaussian histogram of
    its mean and deviation. encoding: "srgb" (default) or "linear", what the channels are sums of; in sRGB most photographs
    are closer to Gaussian. seed: of the noise. directed: whether channels are made of lobes, which know directions, and not of
    bands; by default where the test of texture.isotropy finds that the channel's spectrum has directions. A grey photo (H, W)
    or (H, W, 3) has one channel that varies, a constant one none: the texture of a flat colour. Raises InputError for another
    shape, under 8 pixels a side, NaN, infinities, and a mask of another size or of under 64 pixels.
    """
    pixels, used = _checked(photo, mask)
    if encoding not in ("srgb", "linear"):
        raise InputError(f"The encoding {encoding!r} is not known; use srgb or linear.")
    clipped = np.clip(pixels, 0.0, 1.0)
    encoded = to_srgb(clipped) if encoding == "srgb" else clipped
    rows, columns = encoded.shape[:2]
    inside = encoded.reshape(-1, 3) if used is None else encoded[used]
    axes = principal_axes(inside)
    values = inside @ axes.T.astype(np.float32)
    channels = [_channel(values[:, c], used, (rows, columns), match_histogram, directed) for c in range(3)]
    return ColourTexture(
        name=name, seed=seed, encoding="srgb" if encoding == "srgb" else "linear", axes=tuple(axes.ravel().tolist()),
        channels=(channels[0], channels[1], channels[2]), texels=(columns, rows), photo=photo_name,
    )  # fmt: skip


def principal_axes(colours: NDArray[np.float32]) -> Floats:
    """Return the principal axes (3, 3) of ``colours`` (N, 3), one a row, the most varied first: a rotation, determinant 1.

    The first two point to where their components' sum is positive (or the first that is not 0); the third follows. Where the
    colours vary along one line only, as grey ones do, the others are set at right angles by a rule and not by rounding.
    """
    middle = colours.mean(axis=0, dtype=np.float64)
    centred = colours - middle.astype(np.float32)
    # Blocks of single-precision products, summed in double: exact to 1e-7 of the variance, at a third of the time.
    covariance = sum((part.T @ part).astype(np.float64) for part in np.array_split(centred, max(1, len(centred) // 4096))) / len(
        centred
    )
    values, vectors = np.linalg.eigh(covariance)
    first, second = vectors[:, 2], vectors[:, 1]
    if values[2] < CONSTANT**2:
        return np.eye(3)
    if values[1] < CONSTANT**2:
        across = np.eye(3)[int(np.argmin(np.abs(first)))]
        second = across - (across @ first) * first
        second = second / np.linalg.norm(second)
    first, second = (_facing(v) for v in (first, second))
    return np.stack([first, second, np.cross(first, second)])


def _facing(vector: Floats) -> Floats:
    total = float(vector.sum())
    if abs(total) < 1e-9:
        total = float(vector[np.flatnonzero(np.abs(vector) > 1e-9)[0]])
    return vector if total > 0 else -vector


def _channel(
    values: NDArray[np.float32],
    inside: NDArray[np.bool_] | None,
    shape: tuple[int, int],
    match_histogram: bool,
    directed: bool | None,
) -> ColourChannel:
    mean, deviation = float(values.mean(dtype=np.float64)), float(values.std(dtype=np.float64))
    if deviation < CONSTANT:
        return ColourChannel(weights=(0.0,), curve=(round(mean, 7),) * len(PLACES))
    if match_histogram:
        z: NDArray[np.floating]
        z, quantiles = gaussianise(values, PLACES)
        curve = fitted_curve(quantiles, mean, deviation)
    else:
        z, curve = (values - np.float32(mean)) / np.float32(deviation), gaussian_curve(mean, deviation)
    if inside is None:
        picture = np.asarray(z, np.float32).reshape(shape)
    else:
        picture = np.zeros(shape, np.float32)
        picture[inside] = z
    curve = np.maximum.accumulate(curve)
    if directed or (directed is None and _has_direction(picture, inside)):
        return ColourChannel(weights=(), lobes=lobes_of(picture.astype(np.float64), inside), curve=tuple(curve.tolist()))
    weights = weights_of(band_powers(picture, inside), shape)
    if not weights.any():
        # All of the variance is slower than the photo is long, by the solution's reckoning: the slowest band has it.
        weights[-1] = 1.0
    return ColourChannel(weights=tuple(weights.tolist()), curve=tuple(curve.tolist()))


def _has_direction(picture: NDArray[np.float32], used: NDArray[np.bool_] | None) -> bool:
    if min(picture.shape) < LEAST_DIRECTED:
        return False
    return not isotropy_of(picture.astype(np.float64), used).isotropic


def pixels_of(photo: ArrayLike) -> NDArray[np.float32]:
    """Return a photo (H, W, 3), or a grey one (H, W), as (H, W, 3) float32. Raises InputError for anything else."""
    try:
        pixels = np.asarray(photo, dtype=np.float32)
    except (TypeError, ValueError):
        raise InputError("The photo is no array of numbers; give rows of pixels (H, W, 3) of linear light.") from None
    if pixels.ndim == 2:
        pixels = np.repeat(pixels[..., None], 3, axis=2)
    if pixels.ndim != 3 or pixels.shape[2] != 3:
        raise InputError(f"The photo has the shape {pixels.shape}; (H, W, 3) or, for grey, (H, W) is needed.")
    return pixels


def _checked(photo: ArrayLike, mask: ArrayLike | None) -> tuple[NDArray[np.float32], NDArray[np.bool_] | None]:
    pixels = pixels_of(photo)
    rows, columns = pixels.shape[:2]
    if min(rows, columns) < SMALLEST_SIDE:
        raise InputError(
            f"The photo has {columns} x {rows} pixels; at least {SMALLEST_SIDE} a side are needed, so give a larger part of it."
        )
    if mask is None:
        inside = None
    else:
        inside = np.asarray(mask)
        if inside.shape != (rows, columns):
            raise InputError(f"The mask has the shape {inside.shape} and the photo {(rows, columns)}; give one of its size.")
        inside = inside.astype(bool)
        count = int(np.count_nonzero(inside))
        if count < FEWEST_PIXELS:
            raise InputError(f"The mask leaves {count} pixels of the photo; at least {FEWEST_PIXELS} are needed, so mask less.")
        if count == inside.size:
            inside = None
    if not np.isfinite(pixels if inside is None else pixels[inside]).all():
        raise InputError("The photo has pixels that are NaN or infinite; repair them or leave them out with a mask.")
    if inside is not None:
        pixels = np.where(inside[..., None], pixels, np.float32(0.0))
    return pixels, inside
