"""Brightness that varies more slowly than the filters' windows: the large forms that carry the small ones.

The widest of GD10's 17 filters spans 32 pixels of the picture. A wall of rock has ledges wider than that, and a fit that
leaves them out keeps every finer statistic. Two octaves of band-passed brightness, by differences of Gaussians on the
coarsest level, say how strong they are; direction is left to the finer bands.
"""

import numpy as np
from scipy.ndimage import gaussian_filter

from voldetail.metric.layers import Layers
from voldetail.metric.quantiles import Array, Parts, quantile_functions, spread, wasserstein

LEVEL = 2
"""Level of the pyramid that is blurred, a quarter of the picture's size."""

SIGMAS = (2.0, 4.0, 8.0)
"""Blurs in pixels of that level; the bands between them lie about wavelengths of 50 and 100 pixels of the picture."""

NAMES = ("50 pixels", "100 pixels")

_FAINT = 1e-3
"""Weight of a blurred mask below which nothing near is inside."""


def basis(layers: Layers, /) -> Parts:
    """Standard deviation of the reference's bands, (1, 1) each."""
    return {part: spread(functions) for part, functions in measure(layers, {}).items()}


def measure(layers: Layers, basis: Parts, /) -> Parts:
    """Quantile functions (1, 32) of the two bands inside the mask."""
    image, mask = layers.images[LEVEL], layers.masks[LEVEL]
    if mask is None:
        blurred = [gaussian_filter(image, sigma, mode="reflect") for sigma in SIGMAS]
    else:
        # Blurred over what is inside alone, so that nothing beyond the mask's border gets in.
        weight = mask.astype(np.float32)
        blurred = [
            gaussian_filter(image * weight, sigma, mode="reflect")
            / np.maximum(gaussian_filter(weight, sigma, mode="reflect"), _FAINT)
            for sigma in SIGMAS
        ]
    return {
        name: quantile_functions(layers.pick((fine - coarse)[None], LEVEL, 1))
        for name, fine, coarse in zip(NAMES, blurred[:-1], blurred[1:], strict=True)
    }


def apart(a: Array, b: Array, basis: Array | None, /) -> Array:
    """1-Wasserstein distance in the reference's standard deviations."""
    return wasserstein(a, b, basis)
