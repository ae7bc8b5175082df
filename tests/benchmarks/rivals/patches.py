"""Sliced Wasserstein distance of the 7 x 7 patches of the band-passed levels.

Patches are projected on fixed random directions; pictures whose patches are distributed alike have like projections
(Rabin, Peyre, Delon & Bernot 2011, "Wasserstein barycenter and its application to texture mixing").
"""

from functools import lru_cache

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from voldetail.errors import InputError
from voldetail.metric.layers import LEVEL_NAMES, Layers
from voldetail.metric.marginals import band
from voldetail.metric.quantiles import Array, Parts, quantile_functions, spread, wasserstein

PATCH = 7
DIRECTIONS = 32
SEED = 7349
"""Any number would do: the directions only have to be the same for all pictures."""


@lru_cache
def _directions() -> Array:
    """Random directions (32, 49) of unit length."""
    drawn = np.random.default_rng(SEED).standard_normal((DIRECTIONS, PATCH * PATCH))
    return np.asarray(drawn / np.linalg.norm(drawn, axis=1, keepdims=True), np.float32)


def basis(layers: Layers, /) -> Parts:
    """Standard deviation of the reference's projections, (32, 1) a level."""
    return {name: spread(functions) for name, functions in measure(layers, {}).items()}


def measure(layers: Layers, basis: Parts, /) -> Parts:
    """Quantile functions (32, 32) of the projections, of every second patch at levels 0 and 1."""
    found = {}
    for level, (name, image) in enumerate(zip(LEVEL_NAMES, layers.images, strict=True)):
        stride = 2 if level < 2 else 1
        patches = sliding_window_view(band(image), (PATCH, PATCH))[::stride, ::stride]
        # Row by row: no product is large (see `filters`).
        projected = np.matmul(patches.reshape(*patches.shape[:2], -1), _directions().T)
        picked = layers.pick(projected.transpose(2, 0, 1), level, PATCH + 4, stride)
        if not picked.shape[1]:
            raise InputError(
                f"the mask is too small for the metric 'patches', which needs {PATCH + 4} x {PATCH + 4} pixels of "
                f"pyramid level {level} inside it: paint a larger zone or use another metric"
            )
        found[name] = quantile_functions(picked)
    return found


def compare(a: Array, b: Array, basis: Array | None, /) -> float:
    """Mean over directions, in standard deviations of the reference."""
    return float(wasserstein(a, b, basis))
