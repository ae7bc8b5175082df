"""Projection of a tile onto stationary ones: local statistics are matched to global ones (MJHRW17 section 4.3).

Symbols: F, the cumulative histogram around a block's centre; G, that of the whole tile; c' = G^-1(F(c)), the new value
of a pixel. Overlapping blocks each propose a c', and the same Gaussian weights blend the proposals. Since blending is
linear, the curves c -> c' of all blocks are blended first, and then looked up once a pixel.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from voldetail.stationary.local import Neighbourhoods, neighbourhoods
from voldetail.stationary.measure import ORDERS, Measure
from voldetail.stationary.pearson import cumulative
from voldetail.stationary.steerable import bands, with_bands
from voldetail.types import Array

BINS = 64
"""Of the histograms, between a channel's lowest and highest value."""

BLOCK_SPACING = (2.0, 5.0)
"""k of MJHRW17 section 4.3 in pixels: at the top of the pyramid and at its bottom."""

LEAST_SPREAD = 0.05
"""Of the tile's standard deviation: a block with less counts as having so much, lest rounding be blown up to texture."""

MOST_SIGMAS = 5
"""Windows of which a map of sigmas is put together."""


def project(tile: NDArray[Any], measure: Measure, sigma: float | NDArray[Any], spacing: float = BLOCK_SPACING[1]) -> Array:
    """A tile (N, N, 3) in CIE L*a*b* with its local statistics matched to its global ones, channel by channel.

    `measure` names the statistics. `sigma` is the window's standard deviation in pixels, or a map of them (N, N): then
    projections with a few sigmas are made and interpolated between (linear in log sigma). `spacing` is the distance
    of the blocks in pixels; opposite edges meet. Channels that are constant stay as they are.
    """
    if np.ndim(sigma) == 0:
        near = neighbourhoods(tile.shape[:2], float(sigma), min(spacing, float(sigma)), toroidal=True)
        return np.stack([_projected(np.ascontiguousarray(tile[..., c]), measure, near) for c in range(3)], axis=-1)
    wanted = np.log(np.asarray(sigma, np.float64))
    steps = np.linspace(wanted.min(), wanted.max(), MOST_SIGMAS) if np.ptp(wanted) > 0 else wanted.ravel()[:1]
    results = [project(tile, measure, float(np.exp(s)), spacing) for s in steps]
    if len(results) == 1:
        return results[0]
    out = np.zeros_like(results[0])
    for step, result in zip(steps, results, strict=True):
        share = np.clip(1 - np.abs(wanted - step) / (steps[1] - steps[0]), 0, 1)
        out += share[..., None].astype(np.float32) * result
    return out


def _projected(plane: Array, measure: Measure, near: Neighbourhoods) -> Array:
    if np.ptp(plane) <= 1e-5 * (1 + abs(float(plane[0, 0]))):
        return plane
    if measure == "steerable":
        return with_bands(plane, np.stack([_by_histogram(band, near) for band in bands(plane)]))
    if measure == "histogram":
        return _by_histogram(plane, near)
    return _by_moments(plane, near, ORDERS[measure])


def _by_histogram(plane: Array, near: Neighbourhoods) -> Array:
    """The plane (N, N) with every local histogram matched to the global one."""
    borders = _borders(plane)
    width = borders[1] - borders[0]
    local, everywhere = [], []
    for border in borders:
        below = np.clip((border - plane) / width + 0.5, 0, 1)  # Parzen window: a box of a bin's width
        local.append(near.mean(below).ravel())
        everywhere.append(below.mean(dtype=np.float64))
    return _looked_up(plane, _matched(np.stack(local, axis=-1), np.array(everywhere), borders), borders, near)


def _by_moments(plane: Array, near: Neighbourhoods, highest: int) -> Array:
    """The plane (N, N) with local moments up to order `highest` matched to the global ones.

    One or two: each block is shifted, and scaled. Three and four: both histograms are Pearson's with those moments.
    """
    borders = _borders(plane)
    mean, spread, skewness, kurtosis = _moments(plane, near, highest)
    one = [np.array([v]) for v in _standardised([float((plane.astype(np.float64) ** p).mean()) for p in range(1, 5)])]
    spread = np.maximum(spread, LEAST_SPREAD * one[1])
    if highest == 1:
        return _looked_up(plane, borders[None, :] + (one[0] - mean)[:, None], borders, near)
    if highest == 2:
        gain = (one[1] / spread)[:, None]
        return _looked_up(plane, one[0] + gain * (borders[None, :] - mean[:, None]), borders, near)
    local = cumulative(mean, spread, skewness, kurtosis if highest == 4 else None, borders)
    everywhere = cumulative(one[0], one[1], one[2], one[3] if highest == 4 else None, borders)[0]
    return _looked_up(plane, _matched(local, everywhere, borders), borders, near)


def _moments(plane: Array, near: Neighbourhoods, highest: int) -> list[NDArray[np.float64]]:
    """Mean, standard deviation, skewness and kurtosis around every point, (K,) each; those above `highest` are 0."""
    centre = float(plane.mean())
    raw = [near.mean((plane - centre) ** p).ravel().astype(np.float64) if p <= highest else np.zeros(1) for p in range(1, 5)]
    found = _standardised(raw)
    found[0] = found[0] + centre
    return [np.broadcast_to(f, raw[0].shape) for f in found]


def _standardised(raw: list[Any]) -> list[Any]:
    """Mean, standard deviation, skewness and kurtosis from the raw moments of orders 1 to 4."""
    m1, m2, m3, m4 = raw
    variance = np.maximum(m2 - m1**2, 0)
    spread = np.sqrt(variance)
    safe = np.where(variance > 1e-12, spread, 1)
    skewness = np.where(variance > 1e-12, (m3 - 3 * m1 * m2 + 2 * m1**3) / safe**3, 0)
    kurtosis = np.where(variance > 1e-12, (m4 - 4 * m1 * m3 + 6 * m1**2 * m2 - 3 * m1**4) / safe**4, 3)
    return [m1, spread, skewness, kurtosis]


def _borders(plane: Array) -> NDArray[np.float64]:
    return np.linspace(float(plane.min()), float(plane.max()), BINS + 1)


def _matched(local: NDArray[Any], everywhere: NDArray[Any], borders: NDArray[np.float64]) -> NDArray[np.float64]:
    """Curves c' = G^-1(F(c)) at the bins' borders (K, n), from the cumulative histograms F (K, n) and G (n,)."""
    # Where no pixel lies G is level; the slightest slope makes its inverse unique.
    rising = np.maximum.accumulate(everywhere) + 1e-7 * np.arange(len(everywhere))
    return np.interp(local.ravel(), rising, borders).reshape(local.shape)


def _looked_up(plane: Array, curves: NDArray[np.float64], borders: NDArray[np.float64], near: Neighbourhoods) -> Array:
    """Blend the blocks' curves (K, n) at every pixel and apply them to the plane."""
    fields = near.blend(curves.reshape(*near.grid, -1).astype(np.float32))
    place = np.clip((plane - borders[0]) / (borders[1] - borders[0]), 0, BINS)
    index = np.minimum(place.astype(np.int64), BINS - 1)[..., None]
    low, high = np.take_along_axis(fields, index, 2)[..., 0], np.take_along_axis(fields, index + 1, 2)[..., 0]
    return np.asarray(low + (high - low) * (place - index[..., 0]), np.float32)


def match_histogram(tile: Array, quantiles: Array, alpha: float) -> Array:
    """A tile (N, N, 3) whose histograms are moved by the share `alpha` (0 to 1) towards those of the exemplar.

    `quantiles` (Q, 3) are the exemplar's, evenly spaced from 0 to 1. Between the two, cumulative histograms are
    interpolated along the axis of values (MJHRW17 section 4.2, after Matusik et al. 2005).
    """
    if alpha <= 0:
        return tile
    out = np.empty_like(tile)
    probability = np.linspace(0, 1, len(quantiles))
    for c in range(3):
        plane = tile[..., c].ravel()
        ranks = np.empty(plane.size)
        ranks[np.argsort(plane, kind="stable")] = (np.arange(plane.size) + 0.5) / plane.size
        out[..., c] = ((1 - alpha) * plane + alpha * np.interp(ranks, probability, quantiles[:, c])).reshape(tile.shape[:2])
    return out
