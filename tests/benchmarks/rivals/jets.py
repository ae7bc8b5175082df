"""Joint histogram over levels of local jets: columns of Basic Image Features (Crosier & Griffin 2010).

Each pixel of a level belongs to the kind of local structure that its derivatives up to order two answer most: flat,
slope, dark or light blob, dark or light line, saddle. Counted are the pairs of kinds at one place in adjacent levels.
"""

import numpy as np
from numpy.typing import NDArray

from voldetail.metric.layers import LEVELS, Layers
from voldetail.metric.marginals import smoothed
from voldetail.metric.quantiles import Array, Parts

KINDS = 7

FLATNESS = 0.02
"""Share of the local brightness below which any structure counts as flat (epsilon of the paper; tuned on photos)."""

_SUPPORT = 7


def basis(layers: Layers, /) -> Parts:
    """Nothing: the kinds need no range."""
    return {}


def measure(layers: Layers, basis: Parts, /) -> Parts:
    """Shares (49,) of the pairs of kinds, for levels 0 and 1, 1 and 2."""
    kinds = [_kinds(image) for image in layers.images]
    found: dict[str, Array] = {}
    for level in range(LEVELS - 1):
        # Kind (y, x) belongs to pixel (y + 3, x + 3), and coarse pixel y + 3 lies on fine pixel 2 y + 6.
        fine, coarse = kinds[level][3::2, 3::2], kinds[level + 1]
        rows, columns = min(fine.shape[0], coarse.shape[0]), min(fine.shape[1], coarse.shape[1])
        pairs = fine[:rows, :columns] * KINDS + coarse[:rows, :columns]
        allowed = layers.windows(level + 1, _SUPPORT)
        picked = pairs.ravel() if allowed is None else pairs[allowed[:rows, :columns]]
        counts = np.bincount(picked, minlength=KINDS * KINDS)
        found[f"level {level}"] = (counts / max(counts.sum(), 1)).astype(np.float32)
    return found


def compare(a: Array, b: Array, basis: Array | None, /) -> float:
    """Hellinger distance, 0 to 1."""
    return float(np.sqrt(np.sum((np.sqrt(a) - np.sqrt(b)) ** 2) / 2))


def _kinds(image: Array) -> NDArray[np.intp]:
    """Kind 0..6 of each pixel, (H, W) -> (H - 6, W - 6)."""
    s = smoothed(image)
    centre, left, right, up, down = s[1:-1, 1:-1], s[1:-1, :-2], s[1:-1, 2:], s[:-2, 1:-1], s[2:, 1:-1]
    xx, yy = right + left - 2 * centre, down + up - 2 * centre
    xy = (s[2:, 2:] + s[:-2, :-2] - s[2:, :-2] - s[:-2, 2:]) / 4
    slope = np.hypot(right - left, down - up)
    mean, bent = xx + yy, np.hypot(xx - yy, 2 * xy)
    half = np.float32(2**-0.5)
    answers = [FLATNESS * centre, slope, mean, -mean, half * (bent + mean), half * (bent - mean), bent]
    return np.asarray(np.argmax(np.stack(answers, axis=-1), axis=-1))
