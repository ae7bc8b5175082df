"""Contours of brightness: how long they are and how many pieces and holes they bound, at each of several levels of brightness.

These are the Minkowski functionals of the sets brighter than a threshold (Mecke 1996, "Morphological characterization of
patterns in reaction-diffusion systems", section II): boundary length, here by direction, and Euler number, pieces less holes.
Thresholds are quantiles of the picture itself, so that contrast, exposure and any other change of tone leave them as they are.
Of a Gaussian field the spectrum says all about them; stones, cracks and ledges are what makes the difference.
"""

import numpy as np

from voldetail.metric.layers import LEVEL_NAMES, Layers
from voldetail.metric.marginals import smoothed
from voldetail.metric.quantiles import Array, Parts

SHARES = (0.1, 0.2, 0.35, 0.5, 0.65, 0.8, 0.9)
"""Shares of the pixels below each threshold."""

SUPPORT = 6
"""A square of 2 x 2 pixels of a picture that was blurred by five."""


def _functionals() -> Array:
    """(5, 16) shares of a 2 x 2 square's pattern: boundary across columns, across rows, across each diagonal, Euler number.

    Bits are top left, top right, bottom left, bottom right. Squares with one pixel set count a quarter, with three minus a
    quarter (Gray 1971, "Local properties of binary images in two dimensions"); the term by which four and eight neighbours
    differ is left out, which is their mean.
    """
    out = np.zeros((5, 16), np.float32)
    for pattern in range(16):
        a, b, c, d = ((pattern >> i) & 1 for i in range(4))
        corners = a + b + c + d
        out[:, pattern] = (
            ((a != b) + (c != d)) / 2, ((a != c) + (b != d)) / 2, a != d, b != c, ((corners == 1) - (corners == 3)) / 4,
        )  # fmt: skip
    return out


_FUNCTIONALS = _functionals()


def basis(layers: Layers, /) -> Parts:
    """Unit of each functional: its root mean square over the reference's thresholds, (5, 1)."""
    return {
        name: np.maximum(np.sqrt(np.mean(found**2, axis=1, keepdims=True)), np.float32(1e-4))
        for name, found in measure(layers, {}).items()
    }


def measure(layers: Layers, basis: Parts, /) -> Parts:
    """Functionals a pixel (5, 7) at each threshold, of each level blurred."""
    found: dict[str, Array] = {}
    for level, name in enumerate(LEVEL_NAMES):
        image = smoothed(layers.images[level])
        values = np.sort(layers.pick(image[None], level, 5)[0])
        columns = []
        for share in SHARES:
            above = (image > values[int(share * len(values))]).view(np.uint8)
            pattern = above[:-1, :-1] | above[:-1, 1:] << 1 | above[1:, :-1] << 2 | above[1:, 1:] << 3
            counts = np.bincount(layers.pick(pattern[None], level, SUPPORT).ravel(), minlength=16)
            columns.append(_FUNCTIONALS @ (counts / max(counts.sum(), 1)).astype(np.float32))
        found[name] = np.stack(columns, axis=1)
    return found


def compare(a: Array, b: Array, basis: Array | None, /) -> float:
    """Mean difference in the reference's units."""
    return float(np.mean(np.abs(a - b) if basis is None else np.abs(a - b) / basis))
