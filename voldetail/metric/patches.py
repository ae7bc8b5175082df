"""Sliced Wasserstein distance of 7 x 7 patches of the band-passed levels."""

from functools import lru_cache

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from voldetail.metric.layers import LEVEL_NAMES, Layers
from voldetail.metric.marginals import band
from voldetail.metric.quantiles import Array, Parts, quantile_functions, spread, wasserstein

PATCH = 7
PROJECTIONS = 32
SEED = 7349


@lru_cache
def projections() -> Array:
    """Fixed random directions (32, 49) of unit length."""
    directions = np.random.default_rng(SEED).standard_normal((PROJECTIONS, PATCH * PATCH))
    return (directions / np.linalg.norm(directions, axis=1, keepdims=True)).astype(np.float32)


def basis(layers: Layers, /) -> Parts:
    return {name: spread(functions) for name, functions in measure(layers, {}).items()}


def measure(layers: Layers, basis: Parts, /) -> Parts:
    found = {}
    for level, (name, image) in enumerate(zip(LEVEL_NAMES, layers.images, strict=True)):
        stride = 1 if level == 2 else 2
        patches = sliding_window_view(band(image), (PATCH, PATCH))[::stride, ::stride]
        rows, columns = patches.shape[:2]
        projected = patches.reshape(rows * columns, -1) @ projections().T
        picked = layers.pick(projected.T.reshape(PROJECTIONS, rows, columns), level, PATCH + 4, stride)
        found[name] = quantile_functions(picked)
    return found


def compare(a: Array, b: Array, basis: Array | None, /) -> float:
    return wasserstein(a, b, basis)
