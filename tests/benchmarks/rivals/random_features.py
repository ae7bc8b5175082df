"""Untrained convolutional features: two layers of random filters with rectifiers at three scales, and their Gram matrices.

Ustyuzhaninov, Brendel, Gatys & Bethge 2017, "What does it take to generate natural textures?": random filters carry much of
what trained ones do, and their Gram matrices are the statistics of Gatys et al. 2015.
"""

from functools import lru_cache

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from voldetail.metric.layers import LEVEL_NAMES, Layers
from voldetail.metric.marginals import band
from voldetail.metric.quantiles import Array, Parts

SEED = 20170
FIRST, FIRST_SIDE = 24, 7
SECOND, SECOND_SIDE = 48, 3


@lru_cache
def _filters() -> tuple[Array, Array]:
    """Filters of mean zero and length one: (24, 49) and (48, 9 x 24)."""
    rng = np.random.default_rng(SEED)
    drawn = [rng.standard_normal(s) for s in ((FIRST, FIRST_SIDE**2), (SECOND, SECOND_SIDE**2 * FIRST))]
    centred = [d - d.mean(axis=1, keepdims=True) for d in drawn]
    first, second = (np.asarray(c / np.linalg.norm(c, axis=1, keepdims=True), np.float32) for c in centred)
    return first, second


def basis(layers: Layers, /) -> Parts:
    """Nothing: differences are relative."""
    return {}


def measure(layers: Layers, basis: Parts, /) -> Parts:
    """Means and upper halves of the Gram matrices of the features of each layer and level."""
    found: dict[str, Array] = {}
    for name, image in zip(LEVEL_NAMES, layers.images, strict=True):
        shown = 10 * band(image)  # about 1, so that means and products, of degree one and two, weigh alike
        first, second = _filters()
        one = _layer(shown[None], first, FIRST_SIDE, 1)
        two = _layer(one[:, ::2, ::2], second, SECOND_SIDE, 1)
        found |= {f"first {name}": _gram(one), f"second {name}": _gram(two)}
    return found


def compare(a: Array, b: Array, basis: Array | None, /) -> float:
    """Mean difference over the mean size of both."""
    return float(np.mean(np.abs(a - b)) / max(float(np.mean(np.abs(a) + np.abs(b))) / 2, 1e-6))


def _layer(maps: Array, filters: Array, side: int, stride: int) -> Array:
    patches = sliding_window_view(maps, (side, side), axis=(1, 2))[:, ::stride, ::stride]
    channels, height, width = patches.shape[:3]
    flat = patches.transpose(1, 2, 0, 3, 4).reshape(height * width, channels * side * side)
    return np.maximum(flat @ filters.T, 0).T.reshape(len(filters), height, width)


def _gram(maps: Array) -> Array:
    flat = maps.reshape(len(maps), -1)
    gram = flat @ flat.T / flat.shape[1]
    return np.concatenate([flat.mean(axis=1), gram[np.triu_indices(len(gram))]]).astype(np.float32)
