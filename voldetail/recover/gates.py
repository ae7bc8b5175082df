"""What of a photo's light can be read as shading: not what is burnt out, in shadow, masked, or paint by its colour.

Symbols
    L    linear luminance of the photo
    L_0  its Gaussian mean over `SLOW` of the shorter side: slow shading, and the exposure
    d    L / L_0 - 1, the relative detail; 0 where it says nothing
    c    (log R/G, log B/G) less their own slow means: shading moves a colour along a line through black and leaves c alone,
         paint does not
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter

from voldetail.image import luminance

SLOW = 0.125
"""Standard deviation of the slow mean over the shorter side. Looked at on the scans and the pebble wall: more lets stains and the
lamp's own fall-off in, less takes large stones' shading away."""

DARKEST, BRIGHTEST = -0.85, 1.2
"""Between which d is kept: below lies cast shadow, whose depth tells nothing of the slope, above gloss."""

BURNT = 0.985
"""Stored light from which a channel may be clipped."""

BLACK = 1e-4
"""Light below which a channel has no colour."""

FILL = 2.0
"""Pixels: the standard deviation of the mean that fills what is left out."""

RIDGE = 1e-3
"""Of the mean square of c, so that a grey photo is not divided by zero."""


@dataclass(frozen=True, eq=False)
class Gated:
    """detail (H, W): d without paint, 0 outside. weight (H, W): 1 where it was read, 0 where it was filled in. slow (H, W): L_0.

    paint: the share of the variance of d that goes with the colour, 0 to 1. burnt: the share of the used pixels that is clipped.
    """

    detail: NDArray[np.float32]
    weight: NDArray[np.float32]
    slow: NDArray[np.float32]
    paint: float
    burnt: float


def gate(pixels: NDArray[np.float32], used: NDArray[np.bool_]) -> Gated:
    """Return what can be read of ``pixels`` (H, W, 3), linear light, where ``used`` (H, W)."""
    light = luminance(pixels)
    clipped = used & (pixels.max(axis=-1) >= BURNT)
    read = used & ~clipped
    # What is burnt out was bright: it counts for the slow mean, but its pattern is gone.
    sigma = SLOW * min(light.shape)
    slow = np.maximum(slow_mean(light, used, sigma), BLACK)
    detail = np.clip(light / slow - 1.0, DARKEST, BRIGHTEST).astype(np.float32)
    detail, paint = _without_paint(detail, pixels, read, sigma)
    weight = read.astype(np.float32)
    near = gaussian_filter(weight, FILL)
    filled = gaussian_filter(detail * weight, FILL) / np.maximum(near, 1e-3) * np.minimum(near / 0.1, 1.0)
    detail = np.where(read, detail, np.where(used, filled, 0.0)).astype(np.float32)
    return Gated(detail, weight, slow, paint, float(clipped.sum() / max(int(used.sum()), 1)))


def slow_mean(values: NDArray[np.floating], used: NDArray[np.bool_], sigma: float) -> NDArray[np.float32]:
    """Return the Gaussian mean of ``values`` (H, W) over what is ``used``, of standard deviation ``sigma`` in pixels."""
    weight = gaussian_filter(used.astype(np.float32), sigma, mode="constant", truncate=3.0)
    total = gaussian_filter(np.where(used, values, 0.0).astype(np.float32), sigma, mode="constant", truncate=3.0)
    mean = float(values[used].mean()) if used.any() else 0.0
    return np.asarray((total + 1e-4 * mean) / (weight + 1e-4), np.float32)


def _without_paint(
    detail: NDArray[np.float32], pixels: NDArray[np.float32], read: NDArray[np.bool_], sigma: float
) -> tuple[NDArray[np.float32], float]:
    """Return d less what its linear regression on c explains, as far as it explains (by R squared), and R squared."""
    if read.sum() < 64:
        return detail, 0.0
    logs = np.log(np.maximum(pixels, BLACK))
    chroma = np.stack([logs[..., 0] - logs[..., 1], logs[..., 2] - logs[..., 1]], axis=-1)
    chroma -= np.stack([slow_mean(chroma[..., k], read, sigma) for k in (0, 1)], axis=-1)
    x, y = chroma[read].astype(np.float64), detail[read].astype(np.float64)
    y = y - y.mean()
    gram = x.T @ x / len(x)
    gram += np.eye(2) * (RIDGE * float(np.trace(gram)) + 1e-8)
    slope = np.linalg.solve(gram, x.T @ y / len(y))
    explained = float(np.clip(1.0 - ((y - x @ slope) ** 2).mean() / max(float((y * y).mean()), 1e-12), 0.0, 1.0))
    painted = np.asarray(chroma @ slope.astype(np.float32), np.float32) * np.float32(explained)
    return np.clip(detail - painted, DARKEST, BRIGHTEST).astype(np.float32), explained
