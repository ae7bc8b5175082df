"""Joint histogram over levels of local jets: Basic Image Features columns (Crosier & Griffin 2010)."""

import numpy as np

from voldetail.metric.layers import Layers, inside
from voldetail.metric.marginals import smoothed
from voldetail.metric.quantiles import Array, Parts

CLASSES = 7
FLAT = 0.02


def classes(image: Array) -> np.ndarray:
    s = smoothed(image)
    c = s[1:-1, 1:-1]
    x = (s[1:-1, 2:] - s[1:-1, :-2]) / 2
    y = (s[2:, 1:-1] - s[:-2, 1:-1]) / 2
    xx = s[1:-1, 2:] + s[1:-1, :-2] - 2 * c
    yy = s[2:, 1:-1] + s[:-2, 1:-1] - 2 * c
    xy = (s[2:, 2:] + s[:-2, :-2] - s[2:, :-2] - s[:-2, 2:]) / 4
    lam = (xx + yy)
    gam = np.sqrt((xx - yy) ** 2 + 4 * xy**2)
    r2 = np.float32(2 ** -0.5)
    stack = np.stack([FLAT * c, 2 * np.sqrt(x * x + y * y), lam, -lam, r2 * (gam + lam), r2 * (gam - lam), gam])
    return stack.argmax(0).astype(np.int32)


def basis(layers: Layers, /) -> Parts:
    return {}


def measure(layers: Layers, basis: Parts, /) -> Parts:
    codes = [classes(i) for i in layers.images]
    found = {}
    for l in (0, 1):
        fine = codes[l][3::2, 3::2]
        coarse = codes[l + 1]
        # code pixel y is image pixel y+3; fine 2y'+6 = 2(y'+3)
        h, w = min(fine.shape[0], coarse.shape[0]), min(fine.shape[1], coarse.shape[1])
        joint = fine[:h, :w] * 7 + coarse[:h, :w]
        if layers.masks[l + 1] is not None:
            joint = joint[inside(layers.masks[l + 1], 7)[:h, :w]]
        n = np.bincount(joint.ravel(), minlength=49)
        found[f"{l}-{l+1}"] = (n / n.sum()).astype(np.float32)
    return found


def compare(a: Array, b: Array, basis: Array | None, /) -> float:
    return float(np.sqrt(np.sum((np.sqrt(a) - np.sqrt(b)) ** 2) / 2))
