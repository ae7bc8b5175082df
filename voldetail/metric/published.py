"""The metric as published: histograms of filter amplitudes, GD10 section 5."""

import numpy as np

from voldetail.metric.layers import LEVEL_NAMES, Layers
from voldetail.metric.quantiles import Array, Parts

BINS = 32
"""h_n of GD10, section 5."""

TOP_QUANTILE = 0.999
"""The paper gives no bin edges. Here the range of each frequency and level starts at zero and ends at this quantile
of the reference's amplitudes: a maximum that a single bright pixel cannot move. Equal bins; the last one is open."""


def basis(layers: Layers, /) -> Parts:
    """Upper end of the histograms' range for each frequency, (17,) a level, taken from the reference."""
    tops = {}
    for name, amplitudes in zip(LEVEL_NAMES, layers.amplitudes, strict=True):
        rank = min(int(TOP_QUANTILE * amplitudes.shape[1]), amplitudes.shape[1] - 1)
        tops[name] = np.maximum(np.partition(amplitudes, rank, axis=1)[:, rank], np.float32(1e-6))
    return tops


def measure(layers: Layers, tops: Parts, /) -> Parts:
    """Normalised histograms h_{u,v,l}, (17, 32) a level, each row with sum 1."""
    histograms = {}
    for name, amplitudes in zip(LEVEL_NAMES, layers.amplitudes, strict=True):
        filters, samples = amplitudes.shape
        bins = (amplitudes * (BINS / tops[name])[:, None]).astype(np.int32)
        np.minimum(bins, BINS - 1, out=bins)
        bins += (np.arange(filters, dtype=np.int32) * BINS)[:, None]
        counts = np.bincount(bins.ravel(), minlength=filters * BINS)
        histograms[name] = (counts.reshape(filters, BINS) / samples).astype(np.float32)
    return histograms


def apart(a: Array, b: Array, basis: Array | None, /) -> Array:
    """One level's share of M: the squared differences summed over frequencies and bins."""
    return np.asarray(np.sum((a.astype(np.float64) - b) ** 2, axis=(-2, -1)))
