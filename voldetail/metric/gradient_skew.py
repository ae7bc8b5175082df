"""Skew of the gradient, which tells from where relief is lit: the lopsided part of brightness differences by direction.

Relief lit from one side is not the same upside down: slopes that face the light are broad and bright, those that turn away
short and dark, and shadows end sharply on one side. Spectra, correlations of magnitudes, local patterns and openings are
even: they take a photo turned by half a turn, stones for dents, for another crop. Differences of brightness between a
pixel and one further on have a distribution whose lopsidedness changes its sign there.
"""

import numpy as np

from voldetail.metric.layers import LEVEL_NAMES, Layers
from voldetail.metric.quantiles import Array, Parts, quantile_functions, spread

LAGS = ((0, 2), (2, 0), (2, 2), (2, -2))
"""Displacements in rows and columns of each level; even, so that a difference has a pixel as its middle."""

SUPPORT = 3
"""Side in pixels of the window that a difference needs."""


def basis(layers: Layers, /) -> Parts:
    """Nothing: shapes have no unit."""
    return {}


def measure(layers: Layers, basis: Parts, /) -> Parts:
    """(Q(p) + Q(1 - p)) / 2 of each level, (4, 32): Q the quantile function of the differences at a lag in their own
    deviations. It is 0 where they are distributed alike up and down, and turns its sign with the picture."""
    skews: dict[str, Array] = {}
    for level, (name, image) in enumerate(zip(LEVEL_NAMES, layers.images, strict=True)):
        stride = 1 if level == len(LEVEL_NAMES) - 1 else 2  # neighbours say nearly the same
        gaps = np.stack([_gap(image, rows // 2, columns // 2)[::stride, ::stride] for rows, columns in LAGS])
        functions = quantile_functions(layers.pick(gaps, level, SUPPORT, stride))
        shape = functions / spread(functions)
        skews[name] = (shape + shape[:, ::-1]) * np.float32(0.5)
    return skews


def apart(a: Array, b: Array, basis: Array | None, /) -> Array:
    """Mean absolute difference over quantiles and lags."""
    return np.asarray(np.mean(np.abs(a - b), axis=(-2, -1)))


def _gap(image: Array, rows: int, columns: int) -> Array:
    """image(y + rows, x + columns) - image(y - rows, x - columns) at every pixel but the outermost."""
    height, width = image.shape
    ahead = image[1 + rows : height - 1 + rows, 1 + columns : width - 1 + columns]
    behind = image[1 - rows : height - 1 - rows, 1 - columns : width - 1 - columns]
    return np.asarray(ahead - behind)
