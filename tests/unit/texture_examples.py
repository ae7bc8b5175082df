"""Photos that are drawn and not taken, for the tests of colour textures."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter

from voldetail.detail.colour import ColourChannel, ColourTexture
from voldetail.texture.curve import gaussian_curve

Floats = NDArray[np.float64]


def blotches(rows: int = 96, columns: int = 128, seed: int = 0) -> NDArray[np.float32]:
    """A linear colour photo with skewed, correlated channels and more power at long wavelengths."""
    random = np.random.default_rng(seed)
    layers = [gaussian_filter(random.standard_normal((rows, columns)), s) for s in (0.7, 1.5, 4.0)]
    layers = [v / v.std() for v in layers]
    first = layers[0] + layers[1] + layers[2]
    photo = np.stack([0.4 + 0.06 * first + 0.03 * layers[1], 0.35 + 0.04 * first, 0.25 + 0.025 * first - 0.02 * layers[2]], -1)
    return np.clip(photo + 0.006 * np.maximum(first, 0)[..., None] ** 2, 0.0, 1.0).astype(np.float32)


def grey_noise(weights: Floats, side: int = 256, seed: int = 0) -> ColourTexture:
    """A grey texture of linear encoding and Gaussian histogram, of deviation 0.05 sqrt(3) along the grey axis."""
    axes = np.array([[1, 1, 1] / np.sqrt(3), [2, -1, -1] / np.sqrt(6), [0, 1, -1] / np.sqrt(2)])
    flat = ColourChannel(weights=(0.0,), curve=(0.0,) * 10)
    curve = gaussian_curve(0.5 * np.sqrt(3), 0.05 * np.sqrt(3))
    return ColourTexture(
        seed=seed, encoding="linear", axes=tuple(axes.ravel().tolist()), texels=(side, side),
        channels=(ColourChannel(weights=tuple(weights.tolist()), curve=tuple(curve.tolist())), flat, flat),
    )  # fmt: skip
