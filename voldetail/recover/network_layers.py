"""A U-Net run by NumPy: convolutions as products of matrices, channels last.

A picture (H, W, C) with a rim of zeros is a matrix of (H + 2)(W + 2) rows. The three neighbours in a row are put side by side,
and the three rows of a 3 x 3 filter are then three products of contiguous parts of one matrix, added up in place.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from scipy.linalg.blas import sgemm

from voldetail.types import Array

Weights = Mapping[str, Array]

LEAK = 0.1
"""Slope of the rectifier below 0."""


def convolved(x: Array, weight: Array, bias: Array) -> Array:
    """Return ``x`` (H, W, C) under filters ``weight`` (D, C, 3, 3), zeros beyond the edges, plus ``bias`` (D,): (H, W, D)."""
    rows, columns, channels = x.shape
    wide = columns + 2
    beside = np.zeros((rows + 2, wide, 3 * channels), np.float32)
    beside[1:-1, 1:-1, channels : 2 * channels] = x
    beside[1:-1, 2:, :channels] = x
    beside[1:-1, :-2, 2 * channels :] = x
    flat = beside.reshape((rows + 2) * wide, 3 * channels)
    out = np.empty((rows * wide, len(bias)), np.float32)
    out[:] = bias
    for k in range(3):
        # (3 C, D): the filter's row k, its columns one after the other, as they lie side by side above.
        matrix = np.ascontiguousarray(weight[:, :, k, :].transpose(2, 1, 0).reshape(3 * channels, -1))
        part = flat[k * wide : k * wide + rows * wide]
        sgemm(1.0, matrix.T, part.T, beta=1.0, c=out.T, overwrite_c=1)
    return out.reshape(rows, wide, -1)[:, 1:-1]


def rectified(x: Array) -> Array:
    """Return max(x, LEAK x)."""
    return np.maximum(x, np.float32(LEAK) * x)


def halved(x: Array) -> Array:
    """Return the means of 2 x 2 pixels."""
    return np.float32(0.25) * (x[::2, ::2] + x[1::2, ::2] + x[::2, 1::2] + x[1::2, 1::2])


def doubled(x: Array) -> Array:
    """Return each pixel as 2 x 2."""
    return x.repeat(2, axis=0).repeat(2, axis=1)


def _double(x: Array, weights: Weights, name: str) -> Array:
    for part in ("first", "second"):
        x = rectified(convolved(x, weights[f"{name}.{part}.weight"], weights[f"{name}.{part}.bias"]))
    return x


def run(x: Array, weights: Weights) -> Array:
    """Return what the network says of features ``x`` (H, W, C), both sides multiples of `multiple`."""
    levels = sum(1 for name in weights if name.startswith("down.") and name.endswith(".first.weight"))
    kept = []
    for k in range(levels):
        x = _double(x if k == 0 else halved(x), weights, f"down.{k}")
        kept.append(x)
    for k in range(levels - 2, -1, -1):
        x = _double(np.concatenate([kept.pop(k), doubled(x)], axis=-1), weights, f"up.{k}")
    weight = weights["last.weight"][:, :, 0, 0]
    return np.asarray(x @ weight.T + weights["last.bias"], np.float32)


def multiple(weights: Weights) -> int:
    """Return what sides have to be a multiple of."""
    levels = sum(1 for name in weights if name.startswith("down.") and name.endswith(".first.weight"))
    return int(2 ** (levels - 1))
