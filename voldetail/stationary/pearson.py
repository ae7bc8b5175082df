"""Histograms that have given moments: Gaussian for two, Pearson's for three and four (MJHRW17 section 4.3).

Pearson's densities solve p'/p = -(x + c1) / (c0 + c1 x + c2 x^2) about the mean; the coefficients follow from the
moments in closed form (Johnson and Kotz 1970, chapter 12, eq. 15 ff., with beta1 = skewness^2 and beta2 = kurtosis).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Numbers = NDArray[np.float64]

REACH = 6.0
"""Standard deviations to each side of the mean within which a density is sampled."""

SAMPLES = 193
"""Across that; odd, so that the mean is one of them."""

LEAST_DENOMINATOR = 1e-3
"""Where the quadratic falls below this the density's support has ended: Pearson's types I and II are bounded."""

STEEPEST = 50.0
"""Bound of |p'/p| per standard deviation: near an end of the support it goes to infinity."""


def cumulative(mean: Numbers, spread: Numbers, skewness: Numbers, kurtosis: Numbers | None, borders: Numbers) -> Numbers:
    """Cumulative distributions (K, n) at `borders` (n,) for K sets of moments (K,), each of the unit of the borders.

    `spread` is the standard deviation, `kurtosis` the fourth standardised moment (3 for a Gaussian), or None for
    Pearson's type III, which has three free moments.
    """
    x = np.linspace(-REACH, REACH, SAMPLES)
    c0, c1, c2 = coefficients(skewness, kurtosis)
    quadratic = c0[:, None] + c1[:, None] * x + c2[:, None] * x**2
    slope = np.clip(-(x + c1[:, None]) / np.maximum(quadratic, LEAST_DENOMINATOR), -STEEPEST, STEEPEST)
    middle, step = SAMPLES // 2, x[1] - x[0]
    log = np.concatenate([np.zeros((len(mean), 1)), np.cumsum((slope[:, 1:] + slope[:, :-1]) * step / 2, axis=1)], axis=1)
    inside = _connected(quadratic > LEAST_DENOMINATOR, middle)
    log = np.where(inside, log, -np.inf)
    density = np.exp(log - log.max(axis=1, keepdims=True))
    total = np.concatenate([np.zeros((len(mean), 1)), np.cumsum((density[:, 1:] + density[:, :-1]) / 2, axis=1)], axis=1)
    total /= total[:, -1:]
    return _sampled(total, (borders[None, :] - mean[:, None]) / spread[:, None])


def coefficients(skewness: Numbers, kurtosis: Numbers | None) -> tuple[Numbers, Numbers, Numbers]:
    """c0, c1 and c2 of Pearson's equation for a variance of one, (K,) each."""
    beta1 = skewness**2
    if kurtosis is None:
        return np.ones_like(skewness), skewness / 2, np.zeros_like(skewness)
    # No distribution has a kurtosis below 1 + skewness^2; U-shaped ones, next to it, would split a histogram in two.
    beta2 = np.clip(kurtosis, 1.2 * beta1 + 1.81, 1.5 * beta1 + 5)
    scale = 10 * beta2 - 12 * beta1 - 18
    return (4 * beta2 - 3 * beta1) / scale, skewness * (beta2 + 3) / scale, (2 * beta2 - 3 * beta1 - 6) / scale


def _connected(inside: NDArray[np.bool_], middle: int) -> NDArray[np.bool_]:
    """Keep of each row (K, n) the run of True that holds the element `middle`."""
    right = np.logical_and.accumulate(inside[:, middle:], axis=1)
    left = np.logical_and.accumulate(inside[:, middle::-1], axis=1)[:, ::-1]
    return np.concatenate([left[:, :-1], right], axis=1)


def _sampled(total: Numbers, where: Numbers) -> Numbers:
    """The tables `total` (K, SAMPLES) at `where` (K, n), in standard deviations from the mean."""
    place = np.clip((where + REACH) / (2 * REACH) * (SAMPLES - 1), 0, SAMPLES - 1)
    index = np.minimum(place.astype(np.int64), SAMPLES - 2)
    low, high = np.take_along_axis(total, index, 1), np.take_along_axis(total, index + 1, 1)
    return np.asarray(low + (high - low) * (place - index))
