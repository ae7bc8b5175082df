"""A channel's histogram made Gaussian, by ranks."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtri

from voldetail.types import Floats

LEVELS = 1 << 16
"""Levels that a channel is sorted into: ranks by counting, in a fifth of the time that sorting takes. Values closer than a
65 536th of the range share their mean rank, as equal ones have to."""


def gaussianise(values: NDArray[np.floating], places: Floats) -> tuple[NDArray[np.float32], Floats]:
    """Return (z, quantiles): ``values`` (N,) as normal deviates of the same order, and their quantiles at ``places``.

    z = Phi^-1(mean rank / N); places are normal deviates. The values must not all be equal.
    """
    low, high = float(values.min()), float(values.max())
    levels = np.minimum(((values - low) * (LEVELS / (high - low))).astype(np.int32), LEVELS - 1)
    counts = np.bincount(levels, minlength=LEVELS)
    after = np.cumsum(counts)
    middle = (after - 0.5 * counts) / len(values)
    used = np.flatnonzero(counts)
    table = np.zeros(LEVELS, np.float32)
    table[used] = ndtri(middle[used])
    quantiles = np.interp(places, table[used], low + (used + 0.5) * ((high - low) / LEVELS))
    return table[levels], quantiles
