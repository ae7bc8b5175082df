"""Weights of the wavelet bands from the power spectrum of a picture (LVLD10 article, eq. 12 and 13).

    P_b = sum over b < max(|fx|, |fy|)'s band of |F(picture)|^2 = sum_i L[b, i] w_i^2

Symbols
    P_b     power in frequency band b, as the variance that it adds
    w_i     weight of noise band i
    L       what band i is expected to put into frequency band b (`noise.wavelet_spectrum.leak_matrix`)

Eq. 12 takes L = 0.265 on its diagonal and nothing beside it. Wavelet noise leaks into the bands around it, and a photograph
has an end, at which what is brighter on one side than on the other looks like power at all frequencies. Both are known here:
the picture is faded out along its rim by a taper, and the squares of the weights are solved for, none negative, under the
leak of the tapered picture.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray
from scipy.fft import rfft2
from scipy.optimize import nnls

from voldetail.detail.colour import MOST_BANDS
from voldetail.noise.wavelet_spectrum import band_of, leak_matrix, variance
from voldetail.types import Floats

TAPER = 0.5
"""Share of each side over which the picture fades (a Tukey window); tuned by `tests.benchmarks.colour_weights`."""

NEIGHBOURS = 2.0
"""How much the squares of two neighbouring weights may differ, in their mean, before it costs as much as one deviation of
chance. On random weights 2 makes the error of band 7 of 9 a quarter less than none at all, and leaves the finer ones alone."""

INDEPENDENT = 0.55
"""Independent frequencies for each one of the tapered picture: (mean of h^2)^2 / mean of h^4, for both tapers h."""


def bands_in(shape: tuple[int, int]) -> int:
    """Return how many bands a picture of (rows, columns) tells of: 9 for 512 x 512."""
    return min(MOST_BANDS, max(1, int(np.floor(np.log2(max(shape)) + 1e-9))))


@lru_cache(maxsize=64)
def taper_line(count: int, share: float = TAPER) -> Floats:
    """Return a taper (count,): 1, and a cosine's half wave over half of ``share`` at each end, never 0."""
    distance = (np.arange(count) + 0.5) / count
    rim = np.minimum(distance, 1.0 - distance)
    if share <= 0 or count < 8:
        return np.ones(count)
    line = np.where(rim < share / 2, 0.5 - 0.5 * np.cos(np.pi * np.minimum(rim / (share / 2), 1.0)), 1.0)
    line.flags.writeable = False
    return line


@lru_cache(maxsize=16)
def _leak(shape: tuple[int, int], share: float) -> Floats:
    return leak_matrix(taper_line(shape[1], share), taper_line(shape[0], share), bands_in(shape))


@lru_cache(maxsize=4)
def _bins(shape: tuple[int, int]) -> tuple[NDArray[np.int64], Floats]:
    fy, fx = np.abs(np.fft.fftfreq(shape[0])), np.fft.rfftfreq(shape[1])
    largest = np.maximum(fy[:, None], fx[None, :])
    band = np.clip(band_of(largest), 0, bands_in(shape) - 1)
    # A real picture's other half of the spectrum mirrors this one, but for the columns that are their own mirror image.
    twice = np.full(len(fx), 2.0)
    twice[0] = 1.0
    if shape[1] % 2 == 0:
        twice[-1] = 1.0
    weight = np.broadcast_to(twice, band.shape).copy()
    weight[0, 0] = 0.0
    return band.ravel(), weight.ravel()


def band_powers(picture: NDArray[np.floating], mask: NDArray[np.bool_] | None = None, share: float = TAPER) -> Floats:
    """Return P_b (bands,) of a picture (H, W) of zero mean, finest first; their sum is the variance, about.

    Outside the mask the picture counts as its mean, 0, and the power is divided by the share of the taper's square that lies
    inside: right for the sum, while the mask's own outline spreads some of it over the bands around.
    """
    shape = (picture.shape[0], picture.shape[1])
    taper = np.outer(taper_line(shape[0], share), taper_line(shape[1], share)).astype(np.float32)
    if mask is not None:
        taper *= mask
    total = float(np.sum(np.square(taper), dtype=np.float64))
    used = np.asarray(picture, np.float32) * taper
    used -= taper * np.float32(np.sum(used, dtype=np.float64) / np.sum(taper, dtype=np.float64))
    power = np.square(np.abs(rfft2(used)), dtype=np.float64).ravel()
    band, weight = _bins(shape)
    return np.bincount(band, power * weight, minlength=bands_in(shape)) / (picture.size * total)


def weights_of(powers: Floats, shape: tuple[int, int], share: float = TAPER) -> Floats:
    """Return w_i (bands,) from P_b of a picture of ``shape``: least squares, each error counted in what chance makes of P_b.

    A sum over n independent frequencies is off by 1 / sqrt(n) of itself. The slowest two bands have a handful between them
    and leak into each other; there, neighbours that differ by more than NEIGHBOURS of their size are held to be chance.
    """
    matrix = _leak(shape, share)
    band, weight = _bins(shape)
    frequencies = np.bincount(band, weight, minlength=len(powers)) / 2.0 * INDEPENDENT
    size = np.maximum(powers, 1e-6 * max(float(powers.sum()), 1e-30))
    certainty = np.sqrt(np.maximum(frequencies, INDEPENDENT)) / size
    between = NEIGHBOURS * (size[:-1] + size[1:]) / (2.0 * variance(2))
    smooth = (np.eye(len(powers))[:-1] - np.eye(len(powers))[1:]) / between[:, None]
    rows = np.concatenate([matrix * certainty[:, None], smooth])
    squares, _ = nnls(rows, np.concatenate([powers * certainty, np.zeros(len(smooth))]))
    return np.sqrt(squares)
