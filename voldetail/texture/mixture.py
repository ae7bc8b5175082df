"""A sparse sum of Gaussian pairs fitted to a power spectrum: expectation and maximisation (Dempster, Laird and Rubin 1977).

Symbols
    p_n, f_n     power and centroid of bin n of the half plane, V_n the spread of the power inside of it (2, 2)
    pi_k, mu_k   share and centre of pair k, K_k its covariance (2, 2)
    r_nk+-       the responsibility of the pair's half at + mu_k or - mu_k for bin n

Taken as a density, a power spectrum has the mixture of greatest likelihood where sum_n p_n log sum_k pi_k G_k(f_n) is greatest:
the Kullback-Leibler divergence is smallest. Shares stay positive and keep their sum without being asked, so the noise has the
channel's variance, and a weak octave counts by its share of the power and by its relative error.

Each ellipse has its axes along and across its centre's direction, as `Lobe` has them (a full covariance would need one number
more a lobe); at a centre near zero the axes are those of the power around it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

ROUNDS = 60
"""Rounds of expectation and maximisation; tuned on photos: twice as many gain at most 0.008 nats."""

CENTRED = 1.0
"""A pair whose centre is nearer to zero than this many of its own deviations is one bump at zero: its halves overlap."""

FINE_BINS = 20
"""Bins of the spectrum around zero that are kept; each octave beyond merges blocks of twice the side. A block's own spread
is not lost (V_n), and a half circle of radius 20 still has 60 directions."""

TINY = 1e-300


@dataclass(frozen=True)
class Bins:
    """Power (N,) that sums to one, centroids (N, 2), spreads (N, 2, 2): the spectrum, coarser with its frequency."""

    power: NDArray[np.float64]
    centroid: NDArray[np.float64]
    spread: NDArray[np.float64]


@dataclass(frozen=True)
class Pairs:
    """share (K,), centre (K, 2) in cycles per texel, angle (K,) of the first axis, deviations (K, 2) along and across it."""

    share: NDArray[np.float64]
    centre: NDArray[np.float64]
    angle: NDArray[np.float64]
    deviation: NDArray[np.float64]


def binned(power: NDArray[np.float64], fx: NDArray[np.float64], fy: NDArray[np.float64]) -> Bins:
    """Return the bins of ``power`` (rows fy, columns fx >= 0), merged by blocks of 1, 2, 4 ... a side, octave by octave."""
    x, y = np.meshgrid(fx, fy)
    weight = power * np.where((fx > 0) & (fx < 0.5), 2.0, 1.0)
    radius = np.maximum(np.abs(x), np.abs(y))
    level = np.ceil(np.log2(np.maximum(radius / (FINE_BINS * fx[1]), 1.0))).astype(int)
    rows, columns = np.indices(power.shape)
    key = (level * 4096 + (rows >> level)) * 4096 + (columns >> level)
    _, label = np.unique(key.ravel(), return_inverse=True)

    def summed(values: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.asarray(np.bincount(label, (weight * values).ravel()), np.float64)

    total = np.maximum(summed(np.ones_like(x)), TINY)
    mx, my = summed(x) / total, summed(y) / total
    xx, xy, yy = summed(x * x) / total - mx**2, summed(x * y) / total - mx * my, summed(y * y) / total - my**2
    return Bins(total / total.sum(), np.stack([mx, my], 1), np.stack([xx, xy, xy, yy], 1).reshape(-1, 2, 2))


def first_pairs(bins: Bins, count: int, least: float) -> Pairs:
    """Return ``count`` pairs to start from: the power is cut again and again where its spread, in octaves and angle, is most."""
    x, y = bins.centroid.T
    radius = np.hypot(x, y)
    # One octave weighs like a radian over two; the angle is doubled, since a frequency and its negative are one.
    place = np.stack([np.log(np.maximum(radius, least)), np.cos(2 * np.arctan2(y, x)), np.sin(2 * np.arctan2(y, x))], 1)
    place[:, 1:] *= np.minimum(radius / (2 * least), 1.0)[:, None]
    parts = [np.arange(len(radius))]

    def spread(part: NDArray[np.intp]) -> tuple[float, int, float]:
        p, values = bins.power[part], place[part]
        mean = p @ values / p.sum()
        moment = p @ (values - mean) ** 2
        axis = int(np.argmax(moment))
        return (float(moment[axis]) if len(part) > 1 else 0.0), axis, float(mean[axis])

    while len(parts) < count:
        spreads = [spread(part) for part in parts]
        chosen = max(range(len(parts)), key=lambda i: spreads[i][0])
        if spreads[chosen][0] <= 0:
            break
        part, (_, axis, mean) = parts[chosen], spreads[chosen]
        above = place[part, axis] > mean
        parts[chosen : chosen + 1] = [part[above], part[~above]]
    member = np.zeros((len(radius), len(parts)))
    for k, part in enumerate(parts):
        member[part, k] = 1.0
    # Which of a frequency and its negative is meant: that which lies on the side of the part's own direction.
    direction = np.array([np.angle((bins.power[p] * np.exp(2j * np.arctan2(y[p], x[p]))).sum()) / 2 for p in parts])
    sign = np.where(np.outer(x, np.cos(direction)) + np.outer(y, np.sin(direction)) < 0, -1.0, 1.0)
    return _maximised(bins, member * (sign > 0), member * (sign < 0), least)


def fit_pairs(bins: Bins, start: Pairs, least: float, rounds: int = ROUNDS) -> Pairs:
    """Return the pairs after ``rounds`` rounds from ``start``; no deviation falls below ``least`` (cycles per texel)."""
    pairs = start
    for _ in range(rounds):
        plus, minus = _halves(bins, pairs)
        total = np.maximum(plus.sum(1) + minus.sum(1), TINY)[:, None]
        pairs = _maximised(bins, plus / total, minus / total, least)
    return pairs


def _halves(bins: Bins, pairs: Pairs) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the densities (N, K) of both halves at the bins' centroids, times their shares."""
    c, s = np.cos(pairs.angle), np.sin(pairs.angle)
    x, y = bins.centroid.T
    along, across = np.outer(x, c) + np.outer(y, s), np.outer(y, c) - np.outer(x, s)
    distance = pairs.centre[:, 0] * c + pairs.centre[:, 1] * s
    b, w = pairs.deviation.T
    height = pairs.share / (4 * np.pi * b * w)
    side = height * np.exp(-0.5 * (across / w) ** 2)
    return side * np.exp(-0.5 * ((along - distance) / b) ** 2), side * np.exp(-0.5 * ((along + distance) / b) ** 2)


def _maximised(bins: Bins, plus: NDArray[np.float64], minus: NDArray[np.float64], least: float) -> Pairs:
    """Return the pairs of greatest likelihood for responsibilities (N, K) of the two halves."""
    p = bins.power[:, None]
    both = p * (plus + minus)
    mass = both.sum(0)
    kept = mass > 1e-9
    both, mass, signed = both[:, kept], mass[kept], (p * (plus - minus))[:, kept]
    centre = signed.T @ bins.centroid / mass[:, None]
    outer = bins.centroid[:, :, None] * bins.centroid[:, None, :] + bins.spread
    second = np.tensordot(both.T, outer, 1) / mass[:, None, None]
    # At zero the direction is that of the power itself.
    vectors = np.linalg.eigh(second)[1]
    distance = np.linalg.norm(centre, axis=1)
    variance = np.maximum(np.trace(second, axis1=1, axis2=2) - distance**2, 2 * least**2) / 2
    centred = distance < CENTRED * np.sqrt(variance)
    axis = np.where(centred[:, None], vectors[:, :, 1], centre / np.maximum(distance, TINY)[:, None])
    centre = np.where(centred[:, None], 0.0, centre)
    distance = np.where(centred, 0.0, distance)
    along = np.einsum("ki,kij,kj->k", axis, second, axis) - distance**2
    across = np.trace(second, axis1=1, axis2=2) - np.einsum("ki,kij,kj->k", axis, second, axis)
    deviation = np.sqrt(np.maximum(np.stack([along, across], 1), least**2))
    return Pairs(mass / mass.sum(), centre, np.arctan2(axis[:, 1], axis[:, 0]), deviation)
