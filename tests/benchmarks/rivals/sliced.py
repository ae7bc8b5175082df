"""Sliced Wasserstein distance (Rabin, Peyre, Delon & Bernot 2011) of steerable-pyramid vectors at each level.

A vector holds a pixel's four bands, real and imaginary parts, their four magnitudes and the four of its parent.
"""

from functools import lru_cache

import numpy as np

from tests.benchmarks.rivals.steerable import LEVELS, doubled, pyramid
from voldetail.metric.layers import Layers
from voldetail.metric.quantiles import Array, Parts, quantile_functions, spread, wasserstein

DIRECTIONS = 48
SEED = 4711
"""Any number would do: the directions only have to be the same for all pictures."""


@lru_cache
def _directions(dimensions: int) -> Array:
    drawn = np.random.default_rng(SEED).standard_normal((DIRECTIONS, dimensions))
    return np.asarray(drawn / np.linalg.norm(drawn, axis=1, keepdims=True), np.float32)


def basis(layers: Layers, /) -> Parts:
    """Deviation of each of the reference's projections, (48, 1) a level."""
    return {name: spread(functions) for name, functions in measure(layers, {}).items()}


def measure(layers: Layers, basis: Parts, /) -> Parts:
    """Quantile functions (48, 32) of the projections a level."""
    return {
        name: quantile_functions(np.asarray(_directions(len(vectors)) @ vectors, np.float32))
        for name, vectors in _vectors(layers).items()
    }


def compare(a: Array, b: Array, basis: Array | None, /) -> float:
    """Mean over directions, in the reference's deviations."""
    return float(wasserstein(a, b, basis))


def _vectors(layers: Layers) -> Parts:
    _, bands, _ = pyramid(layers.images[0])
    found = {}
    for level, band in enumerate(bands):
        rows = [band.real, band.imag, np.abs(band)]
        if level + 1 < LEVELS:
            rows.append(np.abs(doubled(bands[level + 1])) / 2)  # about as strong as the level itself
        found[f"level {level}"] = np.concatenate(rows).reshape(-1, band[0].size)
    return found
