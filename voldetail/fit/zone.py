"""Which part of the photo is fitted when the user does not say."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter, uniform_filter

from voldetail.errors import InputError
from voldetail.image import to_srgb
from voldetail.setup.photo import SMALLEST_ZONE
from voldetail.setup.view import Zone

FEATURE_PIXELS = 12.0
"""Size in working pixels that the texture's main wavelength should have: enough to shape a bump by, and some sixteen of
them across 192 pixels; tuned on photographs of rough surfaces."""

SHADING_SHARE = 0.08
"""Blur, in photo widths, that is taken away as slow shading before the wavelength is measured."""

CLIPPED = (0.003, 0.85)
"""Linear luminance outside which a pixel of an 8-bit photo says little: crushed or burnt out."""

ANALYSED = 1024
POSITIONS = 9


def default_zone(luminance: NDArray[np.float32], mask: NDArray[np.bool_], resolution: int) -> Zone:
    """Return a square zone whose main wavelength suits ``resolution``, where most pixels are usable.

    It lies where the fewest pixels are masked, crushed or burnt out, as near to the mask's middle as that allows.
    Raises InputError where the mask is too small for any zone.
    """
    rows, columns = np.any(mask, axis=1), np.any(mask, axis=0)
    top, bottom = int(np.argmax(rows)), len(rows) - int(np.argmax(rows[::-1]))
    left, right = int(np.argmax(columns)), len(columns) - int(np.argmax(columns[::-1]))
    longest = min(bottom - top, right - left)
    if longest < SMALLEST_ZONE:
        raise InputError(
            f"The mask's box is {right - left} x {bottom - top} pixels, too small to fit: at least {SMALLEST_ZONE} each"
            " way are needed."
        )
    wanted = resolution * main_wavelength(luminance[top:bottom, left:right]) / FEATURE_PIXELS
    side = int(min(longest, max(wanted, min(resolution, longest))))
    bad = ~mask | (luminance < CLIPPED[0]) | (luminance > CLIPPED[1])
    share = uniform_filter(bad.astype(np.float32), side, mode="nearest")
    best, chosen = np.inf, ((left + right - side) // 2, (top + bottom - side) // 2)
    for y in np.linspace(top, bottom - side, POSITIONS):
        for x in np.linspace(left, right - side, POSITIONS):
            away = np.hypot(x + side / 2 - (left + right) / 2, y + side / 2 - (top + bottom) / 2) / longest
            # A tenth of the pixels lost weighs as much as half a mask's width away from the middle.
            cost = 5.0 * share[int(y + side / 2), int(x + side / 2)] + away
            if cost < best - 1e-9:
                best, chosen = cost, (int(x), int(y))
    return chosen[0], chosen[1], side, side


def check_zone(zone: Zone, shape: tuple[int, int]) -> None:
    """Raise InputError where ``zone`` reaches outside a photo of ``shape`` (rows, columns)."""
    x, y, w, h = zone
    rows, columns = shape
    if x + w > columns or y + h > rows:
        raise InputError(
            f"The zone {x},{y},{w},{h} reaches outside the photo of {columns} x {rows} pixels:"
            " x + width and y + height must stay within it."
        )


def main_wavelength(luminance: NDArray[np.float32]) -> float:
    """Return the wavelength in pixels about which the texture's energy lies.

    The mean logarithm of the wavelength over the power spectrum of the encoded picture, slow shading taken away. Grain
    of two or three pixels is left out, since photographs of anything have it.
    """
    step = max(1, round(max(luminance.shape) / ANALYSED))
    picture = to_srgb(np.clip(luminance[::step, ::step], 0.0, 1.0)).astype(np.float64)
    detail = picture - gaussian_filter(picture, SHADING_SHARE * max(picture.shape))
    window = np.outer(np.hanning(picture.shape[0]), np.hanning(picture.shape[1]))
    power = np.abs(np.fft.rfft2(detail * window)) ** 2
    fy, fx = np.fft.fftfreq(picture.shape[0])[:, None], np.fft.rfftfreq(picture.shape[1])[None, :]
    frequency = np.hypot(fx, fy)
    used = (frequency > 2.0 / min(picture.shape)) & (frequency < 0.3)
    if not used.any() or power[used].sum() <= 0:
        return FEATURE_PIXELS
    mean = float(np.sum(power[used] * np.log(1.0 / frequency[used])) / power[used].sum())
    return float(np.exp(mean)) * step


def around(zone: Zone, shape: tuple[int, int], reach: float) -> Zone:
    """Return the part of a photo of ``shape`` (rows, columns) about ``zone`` that is ``reach`` times as long, or ends with it."""
    x, y, w, h = zone
    rows, columns = shape
    wide, high = min(columns, round(w * reach)), min(rows, round(h * reach))
    left, top = (
        min(max(0, at + side // 2 - new // 2), most - new) for at, side, new, most in ((x, w, wide, columns), (y, h, high, rows))
    )
    return left, top, wide, high
