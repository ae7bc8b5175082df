"""Distributions as quantile functions, compared by the 1-Wasserstein distance."""

from collections.abc import Mapping

import numpy as np

from voldetail.types import Array

Parts = Mapping[str, Array]

STEPS = 32
"""Steps of a quantile function, each the mean of the values between two quantiles: none hangs on one pixel."""


def quantile_functions(values: Array) -> Array:
    """(K, N) samples of K distributions -> (K, 32) quantile functions; a step is the mean of 1/32 of the samples."""
    ordered = np.sort(values, axis=1)
    samples = ordered.shape[1]
    if samples < STEPS:
        ordered = np.repeat(ordered, -(-STEPS // samples), axis=1)
        samples = ordered.shape[1]
    edges = np.linspace(0, samples, STEPS + 1).round().astype(np.intp)
    sums = np.add.reduceat(ordered, edges[:-1], axis=1)
    functions: Array = (sums / np.diff(edges)).astype(np.float32)
    return functions


def spread(functions: Array) -> Array:
    """Standard deviation of each distribution, (K, 1), never zero: the unit its distances are given in."""
    return np.asarray(np.maximum(functions.std(axis=1, keepdims=True), 1e-4), np.float32)


def wasserstein(a: Array, b: Array, unit: Array | None) -> Array:
    """Mean of the 1-Wasserstein distances of K distributions (K, 32), each in its unit (K, 1) (None: 1), from those of b.

    ``b`` may be any number of them at once, (..., K, 32).
    """
    gap = np.abs(a - b)
    return np.asarray(np.mean(gap if unit is None else gap / unit, axis=(-2, -1)))
