"""What wavelet noise is expected to do: covariance, variance, power by octave and what a pixel's box lets through.

Nothing is drawn at random here. The coefficients' covariance is a sum of three products of functions of one coordinate
(see `noise.wavelet_tile`; K = I x I - P x P - P' x P' + P P' x P P', made stationary), B-splines are products too, and so

    cov(d) = 2 (a(dx) a(dy) - 2 b(dx) b(dy) + c(dx) c(dy)),        in 3D with a third factor each,

where a, b and c are the covariances of 1D splines with the coefficients' kernels 1, P and P P'.

Symbols
    tau     a distance in coefficients            band i has a coefficient every 2^i texels
    L[b,i]  variance that band i of unit weight puts into frequency band b of a picture
    u       side of a pixel in coefficients
"""

from __future__ import annotations

from functools import cache

import numpy as np
from numpy.typing import NDArray

from voldetail.noise.wavelet_tile import GAIN, projection
from voldetail.types import Floats

PHASE = 0.2597
"""Where texels lie from the nearest coefficient. A spline's variance depends on that place (0.17 on the edge between two
coefficients, 0.36 on one); here it is the mean over all places, as found with `covariance_lines` by bisection. The finest
band meets no other place where a picture is made texel for texel."""

TERMS = (1.0, -2.0, 1.0)
REACH = 24
"""Coefficients after which P's kernel is below 1e-4 of its height."""

_LINE = 128
_PHASES = 16
_QUADRATURE = 32
_SLICE_REACH = 10.0  # coefficients within which all of a slice's covariance lies, to 1e-3


@cache
def kernels() -> Floats:
    """Return the stationary kernels (3, 2 REACH + 1) of 1, P and P P' at distances -REACH to REACH."""
    part = projection(_LINE)
    spectra = np.zeros((3, 2 * REACH + 1))
    spectra[0, REACH] = 1.0
    places = np.arange(_LINE)
    for column, distance in enumerate(range(-REACH, REACH + 1)):
        for row, matrix in ((1, part), (2, part @ part.T)):
            spectra[row, column] = np.mean(matrix[places, (places + distance) % _LINE])
    return spectra


def spline(x: NDArray[np.floating]) -> NDArray[np.floating]:
    """Return the quadratic B-spline of unit integral, centred on 0."""
    x = np.abs(x)
    return np.where(x < 0.5, 0.75 - x * x, np.where(x < 1.5, 0.5 * (1.5 - x) ** 2, 0.0))


@cache
def _covariance_at(phases: tuple[float, ...], distances: tuple[float, ...]) -> Floats:
    tau = np.asarray(distances)
    covariance = np.zeros((3, len(tau)))
    for phase in phases:
        own = spline(phase - np.arange(-1, 2))  # weights of the coefficients -1, 0, 1
        other = np.floor(phase + tau + 0.5).astype(np.int64)
        for step in (-1, 0, 1):
            weight = spline(phase + tau - (other + step))
            for j in range(3):
                lag = other + step - (j - 1)
                inside = np.abs(lag) <= REACH
                kernel = np.where(inside, kernels()[:, np.clip(lag, -REACH, REACH) + REACH], 0.0)
                covariance += weight * own[j] * kernel
    return covariance / len(phases)


def covariance_lines(tau: Floats, spacing: float = 0.0) -> Floats:
    """Return a, b, c (3, N) at the distances ``tau`` (N,) in coefficients.

    spacing: between the places where the noise is looked at, in coefficients, the first at PHASE; 0 is everywhere.
    """
    count = _PHASES if spacing <= 1.0 / _PHASES else max(1, round(1.0 / spacing))
    phases = tuple((PHASE + k / count + 0.5) % 1.0 - 0.5 for k in range(count))
    return _covariance_at(phases, tuple(np.asarray(tau, np.float64).tolist()))


@cache
def variance(dims: int) -> float:
    """Return the variance of the noise in 2 or 3 dimensions: 0.270 and 0.196, where Cook and DeRose measured 0.265 and 0.210."""
    a = covariance_lines(np.zeros(1))[:, 0]
    return float(GAIN * np.sum(np.asarray(TERMS) * a**dims))


def band_of(frequency: Floats) -> NDArray[np.int64]:
    """Return the band of max(|fx|, |fy|) in cycles a texel, 0 the finest: LVLD10 article, eq. 13, counted from 0.

    Frequency 0 counts as 2^-60."""
    return np.asarray(np.floor(-np.log2(np.maximum(frequency, 2.0**-60)) + 1e-9).astype(np.int64) - 1)


def line_power(band: int, taper: Floats) -> Floats:
    """Return the expected power (3, N) of a line of N texels of band ``band`` under a taper (N,), by frequency k / N.

    Divided by the taper's own sum of squares: the sum over frequencies is the variance of one term.
    """
    count = len(taper)
    overlap = np.correlate(taper, taper, "full") if count < 64 else _autocorrelation(taper)
    lags = np.arange(-(count - 1), count)
    lines = covariance_lines(lags / 2.0**band, 2.0**-band) * overlap
    folded = np.zeros((3, count))
    for term in range(3):
        np.add.at(folded[term], lags % count, lines[term])
    return np.asarray(np.fft.fft(folded, axis=1).real / (count * np.sum(taper**2)))


def _autocorrelation(taper: Floats) -> Floats:
    spectrum = np.abs(np.fft.rfft(taper, 2 * len(taper))) ** 2
    line = np.fft.irfft(spectrum)
    return np.concatenate([line[len(taper) + 1 :], line[: len(taper)]])


def leak_matrix(taper_x: Floats, taper_y: Floats, count: int) -> Floats:
    """Return L (count, count): expected power of noise bands (columns) in frequency bands (rows) of one finite picture.

    The picture's texels are multiplied by both tapers; frequency 0 is left out, as in a picture without its mean. Exact for
    the law of the noise: the spectrum's tails, the finite picture, and what the raster folds back are in it.
    """
    edges = 2.0 ** -(np.arange(count + 1) + 1.0)
    matrix = np.zeros((count, count))
    for band in range(count):
        cumulative = np.zeros(count + 1)
        along = [line_power(band, taper) for taper in (taper_x, taper_y)]
        place = [np.abs(np.fft.fftfreq(len(taper))) for taper in (taper_x, taper_y)]
        for index, edge in enumerate(edges):
            sums = [power[:, f <= edge * (1 + 1e-9)].sum(axis=1) for power, f in zip(along, place, strict=True)]
            cumulative[index] = GAIN * np.sum(np.asarray(TERMS) * sums[0] * sums[1])
        zero = GAIN * np.sum(np.asarray(TERMS) * along[0][:, 0] * along[1][:, 0])
        cumulative[-1] = zero  # what lies below the coarsest band's lower edge counts as its own, but the mean does not
        matrix[:, band] = cumulative[:-1] - cumulative[1:]
    return matrix


def passed_slice(side: Floats, turn: Floats) -> Floats:
    """Return what `passed_variance` does, for squares in the planes xy, xz and yz of a 3D noise whose lattice is turned.

    turn: the rotation (3, 3) to the lattice's axes. The mean over the three planes, by the midpoint rule.
    """
    tau = np.linspace(-_SLICE_REACH * 2.0, _SLICE_REACH * 2.0, 6001)
    lines = covariance_lines(tau)
    passed = np.zeros(len(side))
    for index, u in enumerate(np.asarray(side, np.float64)):
        span = min(float(u), _SLICE_REACH)
        count = max(8, int(np.ceil(span / 0.2)))
        step = span / count
        x = (np.arange(count) + 0.5) * step
        y = (np.arange(2 * count) - count + 0.5) * step
        weight = 2.0 * step * step * (1.0 - x[None, :] / u) * (1.0 - np.abs(y)[:, None] / u) / u**2
        for across, up in ((0, 1), (0, 2), (1, 2)):
            places = [x[None, :] * row[across] + y[:, None] * row[up] for row in turn]
            for term, sign in enumerate(TERMS):
                product = np.prod([np.interp(place, tau, lines[term]) for place in places], axis=0)
                passed[index] += GAIN * sign * float(np.sum(product * weight)) / 3.0
    return np.asarray(np.clip(passed / variance(3), 0.0, 1.0))


def passed_variance(side: Floats) -> Floats:
    """Return the share of the 2D noise's variance that is left after the mean over a square of ``side`` coefficients.

    With sides along the axes; 1 for 0, falling to 0. The integral of the covariance times the square's own.
    """
    nodes, weights = np.polynomial.legendre.leggauss(_QUADRATURE)
    passed = np.zeros(len(side))
    for index, u in enumerate(np.asarray(side, np.float64)):
        if u == 0.0:
            passed[index] = variance(2)
            continue
        # Pieces no longer than half a coefficient: the covariance is a polynomial between them, nearly.
        span = min(float(u), REACH + 3.0)
        pieces = np.linspace(0.0, span, int(np.ceil(2 * span)) + 1)
        low, high = pieces[:-1, None], pieces[1:, None]
        tau = (low + (high - low) * (nodes + 1) / 2).ravel()
        weight = ((high - low) / 2 * weights).ravel()
        means = (covariance_lines(tau) * (2.0 * weight * (1.0 - tau / u) / u)).sum(axis=1)
        passed[index] = GAIN * np.sum(np.asarray(TERMS) * means**2)
    return np.asarray(np.maximum(passed, 0.0) / variance(2))
