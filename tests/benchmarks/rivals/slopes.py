"""Shapes of the distributions of brightness differences, signed, by direction and distance.

Relief lit from one side is not the same upside down: slopes towards the light are short and bright, those away long and dark.
"""

import numpy as np

from voldetail.metric.layers import LEVEL_NAMES, Layers
from voldetail.metric.quantiles import Array, Parts, quantile_functions, spread

LAGS = ((0, 2), (2, 0), (2, 2), (2, -2))
"""Displacements in rows and columns of each level; even, so that a difference has a pixel as its middle."""


def basis(layers: Layers, /) -> Parts:
    """Nothing: shapes have no unit."""
    return {}


def measure(layers: Layers, basis: Parts, /) -> Parts:
    """Quantile functions (4, 32) of the differences at each lag in their own deviations, and their part that is skewed."""
    found: dict[str, Array] = {}
    for level, (name, image) in enumerate(zip(LEVEL_NAMES, layers.images, strict=True)):
        stride = 1 if level == 2 else 2
        ends = [image[1 + y // 2 : image.shape[0] - 1 + y // 2, 1 + x // 2 : image.shape[1] - 1 + x // 2] for y, x in LAGS]
        starts = [image[1 - y // 2 : image.shape[0] - 1 - y // 2, 1 - x // 2 : image.shape[1] - 1 - x // 2] for y, x in LAGS]
        gaps = np.stack([e[::stride, ::stride] - s[::stride, ::stride] for e, s in zip(ends, starts, strict=True)])
        functions = quantile_functions(layers.pick(gaps, level, 3, stride))
        found[name] = functions / spread(functions)
        found[f"skew {name}"] = (found[name] + found[name][:, ::-1]) * np.float32(0.5)
    return found


def compare(a: Array, b: Array, basis: Array | None, /) -> float:
    """1-Wasserstein distance, mean over lags."""
    return float(np.mean(np.abs(a - b)))
