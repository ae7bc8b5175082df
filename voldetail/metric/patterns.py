"""Uniform local binary patterns (Ojala, Pietikainen & Maenpaa 2002) at three scales.

Each pixel's eight neighbours are brighter than it or not. The pattern ignores contrast and brightness and so sees
little of the spectrum, but it sees spots, edges, corners and lines, that is local phase.
"""

import numpy as np
from numpy.typing import NDArray

from voldetail.metric.layers import Layers
from voldetail.metric.marginals import smoothed
from voldetail.metric.quantiles import Array, Parts

LABELS = 59
"""58 patterns with at most two changes round the circle, and one label for all others."""

THRESHOLD = 0.5 / 255
"""A neighbour counts as brighter from half an 8-bit step on: an 8-bit photo's ties then fall as a rendering's do."""

_NEIGHBOURS = ((0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1), (1, 0), (1, 1))


def _labels() -> NDArray[np.uint8]:
    """Label of each of the 256 patterns."""
    table = np.full(256, LABELS - 1, np.uint8)
    label = 0
    for pattern in range(256):
        bits = [(pattern >> i) & 1 for i in range(8)]
        if sum(bits[i] != bits[i - 1] for i in range(8)) <= 2:
            table[pattern] = label
            label += 1
    return table


_LABELS = _labels()


def basis(layers: Layers, /) -> Parts:
    """Nothing: the patterns need no range."""
    return {}


def measure(layers: Layers, basis: Parts, /) -> Parts:
    """Shares (59,) of the patterns: radius 1 at levels 0 and 1, and radius 2 of the smoothed level 0 between them."""
    fine, middle, _ = layers.images
    return {
        "level 0": _shares(layers, 0, _patterns(fine, 1), 3),
        "level 0 smoothed": _shares(layers, 0, _patterns(smoothed(fine), 2), 9),
        "level 1": _shares(layers, 1, _patterns(middle, 1), 3),
    }


def apart(a: Array, b: Array, basis: Array | None, /) -> Array:
    """Hellinger distance, 0 to 1, of any number of ``b`` (..., 59) at once."""
    return np.asarray(np.sqrt(np.sum((np.sqrt(a) - np.sqrt(b)) ** 2, axis=-1) / 2))


def _patterns(image: Array, radius: int) -> NDArray[np.uint8]:
    """Pattern of each pixel whose neighbours at `radius` are inside: (H, W) -> (H - 2 radius, W - 2 radius)."""
    height, width = image.shape[0] - 2 * radius, image.shape[1] - 2 * radius
    centre = image[radius:-radius, radius:-radius] + np.float32(THRESHOLD)
    patterns = np.zeros((height, width), np.uint8)
    for bit, (y, x) in enumerate(_NEIGHBOURS):
        top, left = radius * (1 + y), radius * (1 + x)
        brighter = image[top : top + height, left : left + width] > centre
        patterns |= brighter.view(np.uint8) << np.uint8(bit)
    return patterns


def _shares(layers: Layers, level: int, patterns: NDArray[np.uint8], support: int) -> Array:
    picked = layers.pick(_LABELS[patterns][None], level, support)
    counts = np.bincount(picked.ravel(), minlength=LABELS)
    return np.asarray(counts / max(counts.sum(), 1), np.float32)
