"""Elongation of a texture, from the power spectrum of its photo (GD10 section 7, first heuristic)."""

import numpy as np
from numpy.typing import NDArray

from voldetail.errors import InputError
from voldetail.image import to_srgb
from voldetail.metric.layers import Mask

LOWEST = 6.0
"""Cycles across the shorter side of the zone below which the spectrum is taken for shading and left out; with fewer
the window's own width (2 cycles) blurs the direction."""

HIGHEST = 0.25
"""Cycles a pixel above which it is left out: the corners of a square spectrum and a camera's grain are not texture."""

MOST = 8.0
"""Largest factor told: beyond it the minor axis of the spectrum is as narrow as the window."""

SMALLEST = 32
"""Pixels that the zone's shorter side must have."""

FLAT = 1e-5
"""Range of encoded values below which a picture varies by rounding alone; an 8-bit step is 400 times as much."""


def anisotropy(luminance: NDArray[np.floating], mask: Mask | None = None) -> tuple[float, float]:
    """Factor >= 1 and angle in [0, pi) such that the texture is `factor` times longer along `angle` than across.

    `luminance` is (H, W) linear, `mask` (H, W) bool, True = use; the angle is in the image plane, x to the right,
    y up, counter-clockwise, in radians. The factor is the square root of the ratio of the spectrum's second moments
    along its two main axes, between LOWEST cycles a zone and HIGHEST cycles a pixel; a texture stretched by f has a
    spectrum narrowed by f. 1 means none, and the angle then means nothing.

    Light biases it: relief lit from one side shows its slopes along the light and hides those across, so an isotropic
    relief seems stretched at right angles to the light's azimuth. Isotropic relief with slopes of 0.37 (r.m.s.) under
    Lambert shading seemed stretched by 1.7 to 1.9 with the light 30 degrees above the surface, by 1.4 to 1.7 at 60
    degrees. Under a flash from the camera or a sky there is no such bias. Trust it as the start of a search only.
    Raises InputError where no zone of 32 x 32 pixels is left.
    """
    image, use = _zone(luminance, mask)
    if np.ptp(image[use]) < FLAT:
        return 1.0, 0.0
    window = np.sqrt(np.outer(np.hanning(image.shape[0] + 2)[1:-1], np.hanning(image.shape[1] + 2)[1:-1])) * use
    window *= window
    image = (image - np.sum(image * window) / np.sum(window)) * window
    power = np.abs(np.fft.fft2(image)) ** 2
    x = np.asarray(np.fft.fftfreq(image.shape[1])[None, :], np.float64)
    y = np.asarray(-np.fft.fftfreq(image.shape[0])[:, None], np.float64)  # rows run downwards, y upwards
    return _elongation(power, x, y, LOWEST / min(image.shape))


def _zone(luminance: NDArray[np.floating], mask: Mask | None) -> tuple[NDArray[np.float64], Mask]:
    """The encoded picture and mask, cut to the mask's bounding box."""
    image = np.asarray(luminance, np.float64)
    use = np.ones(image.shape, bool) if mask is None else np.asarray(mask, bool)
    if image.ndim != 2 or use.shape != image.shape:
        raise InputError(
            f"the picture has shape {image.shape} and the mask {use.shape}, but both must be (height, width): "
            "convert colours to luminance and paint the mask over the same picture"
        )
    rows, columns = np.flatnonzero(use.any(1)), np.flatnonzero(use.any(0))
    if min(rows.size, columns.size) < SMALLEST:
        raise InputError(
            f"the zone is smaller than {SMALLEST} x {SMALLEST} pixels, too small to see the direction of a texture: "
            "choose a larger zone or a higher resolution"
        )
    box = (slice(rows[0], rows[-1] + 1), slice(columns[0], columns[-1] + 1))
    image, use = image[box], use[box]
    if not np.isfinite(image[use]).all():
        raise InputError("the picture has values that are not finite (NaN or infinity): repair or mask them")
    return np.asarray(to_srgb(np.maximum(np.where(use, image, 0), 0)), np.float64), use


def _elongation(power: NDArray[np.float64], x: NDArray[np.float64], y: NDArray[np.float64], lowest: float) -> tuple[float, float]:
    """Main axes of the spectrum between two radii, by moments within an ellipse that follows them.

    Moments within a circle underrate a stretched spectrum, since the circle cuts its long axis and not its short
    one. The band's shape is therefore adapted: measured inside the ellipse found before, of the same area.
    """
    factor, angle = 1.0, 0.0
    for _ in range(40):
        along = (np.cos(angle) * x + np.sin(angle) * y) * np.sqrt(factor)
        across = (np.cos(angle) * y - np.sin(angle) * x) / np.sqrt(factor)
        radius = np.hypot(along, across)
        weight = power * ((radius >= lowest) & (radius <= HIGHEST))
        if not weight.sum() > 0:
            return 1.0, 0.0
        xx, yy, xy = (float(np.sum(weight * p)) for p in (x * x, y * y, x * y))
        spread = np.hypot(xx - yy, 2 * xy)
        wide, narrow = (xx + yy + spread) / 2, max((xx + yy - spread) / 2, 1e-30)
        new = min(float(np.sqrt(wide / narrow)), MOST)
        # The spectrum is widest across the direction in which the texture is long.
        angle = float((np.arctan2(2 * xy, xx - yy) / 2 + np.pi / 2) % np.pi)
        if abs(new - factor) < 1e-3 * factor:
            return new, angle
        factor = new
    return factor, angle
