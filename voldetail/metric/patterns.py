"""Uniform local binary patterns at three radii (Ojala, Pietikainen & Maenpaa 2002).

Each pixel's eight neighbours are brighter than it or not. The pattern ignores contrast and brightness and so sees
little of the spectrum, but sees spots, edges, corners and lines, that is local phase.
"""

import numpy as np
from numpy.typing import NDArray

from voldetail.metric.layers import Layers
from voldetail.metric.marginals import smoothed
from voldetail.metric.quantiles import Array, Parts

_NEIGHBOURS = ((0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1), (1, 0), (1, 1))


def _labels() -> NDArray[np.uint8]:
    """Label of each of the 256 patterns: 0..57 for those with at most two changes round the circle, 58 for all others."""
    table = np.full(256, 58, np.uint8)
    label = 0
    for pattern in range(256):
        bits = [(pattern >> i) & 1 for i in range(8)]
        if sum(bits[i] != bits[i - 1] for i in range(8)) <= 2:
            table[pattern] = label
            label += 1
    return table


_LABELS = _labels()
LABELS = 59


def basis(layers: Layers, /) -> Parts:
    """Nothing: the patterns need no range."""
    return {}


def measure(layers: Layers, basis: Parts, /) -> Parts:
    """Normalised histograms (59,) of the patterns."""
    out = {}
    for level, image in enumerate(layers.images):
        for r, im, name in ((1, image, "raw"), (2, smoothed(image), "smooth")):
            extra = 0 if name == "raw" else 4
            out[f"{name} level {level}"] = histogram(layers, level, im, r, 2 * r + 1 + extra)
    return out


def histogram(layers: Layers, level: int, image: Array, radius: int, support: int) -> Array:
    height, width = image.shape[0] - 2 * radius, image.shape[1] - 2 * radius
    centre = image[radius:-radius, radius:-radius]
    patterns = np.zeros((height, width), np.uint8)
    for bit, (y, x) in enumerate(_NEIGHBOURS):
        top, left = radius * (1 + y), radius * (1 + x)
        brighter = image[top : top + height, left : left + width] > centre
        patterns |= brighter.view(np.uint8) << np.uint8(bit)
    picked = layers.pick(_LABELS[patterns][None], level, support)
    counts = np.bincount(picked.ravel(), minlength=LABELS)
    return (counts / max(counts.sum(), 1)).astype(np.float32)


def compare(a: Array, b: Array, basis: Array | None, /) -> float:
    """Hellinger."""
    return float(np.sqrt(np.sum((np.sqrt(a) - np.sqrt(b)) ** 2)/2))
