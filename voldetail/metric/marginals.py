"""Distributions of the band-passed levels' pixels, signed: their width and, apart from it, their shape.

A band of a photograph of relief is skewed (thin dark cracks between broad bright stones) and heavy-tailed; a
phase-randomised one is Gaussian whatever its spectrum. Skewness and kurtosis say so with single numbers that a few
pixels can move; the quantile function of the band in its own standard deviations says the same steadily.
"""

from functools import reduce

import numpy as np

from voldetail.metric.layers import LEVEL_NAMES, Layers
from voldetail.metric.quantiles import Array, Parts, quantile_functions, spread, wasserstein

_BINOMIAL = np.array([1, 4, 6, 4, 1], np.float32) / 16


def smoothed(image: Array) -> Array:
    """5-tap binomial blur of (H, W) where the filter fits: (H - 4, W - 4)."""
    rows = [weight * image[i : image.shape[0] - 4 + i] for i, weight in enumerate(_BINOMIAL)]
    down = reduce(np.add, rows)
    return reduce(np.add, [weight * down[:, i : image.shape[1] - 4 + i] for i, weight in enumerate(_BINOMIAL)])


def band(image: Array) -> Array:
    """What the 5-tap binomial blur removes, (H - 4, W - 4)."""
    return image[2:-2, 2:-2] - smoothed(image)


def basis(layers: Layers, /) -> Parts:
    """Unit of each part: the standard deviation of the reference's band, (1, 1); 1 for its shape."""
    found = measure(layers, {})
    return {part: spread(functions) for part, functions in found.items()}


def measure(layers: Layers, basis: Parts, /) -> Parts:
    """Quantile functions (1, 32) of each level's band, in encoded units and in its own standard deviations."""
    found: dict[str, Array] = {}
    for level, (name, image) in enumerate(zip(LEVEL_NAMES, layers.images, strict=True)):
        functions = quantile_functions(layers.pick(band(image)[None], level, 5))
        found[name] = functions
        found[f"shape {name}"] = (functions - functions.mean()) / spread(functions)
    return found


def apart(a: Array, b: Array, basis: Array | None, /) -> Array:
    """1-Wasserstein distance in the reference's standard deviations."""
    return wasserstein(a, b, basis)
