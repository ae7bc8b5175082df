"""The descriptor of GKHF14 section 4: mean and deviation of 374 Gabor responses, compared as Gaussian distributions.

(Gieseke, Koch, Hahn & Fuchs, "Interactive Parameter Retrieval for Two-Tone Procedural Textures", 2014.) Sixteen
orientations, four frequencies and an isotropic kernel on six scales, less the highest frequency on the finest scale, which
no pixel grid can hold. Filters are products of spectra; each is evaluated on a grid just fine enough for what it lets pass.

What the paper leaves open is chosen here and said beside each constant. It works on structure maps from 0 to 1; here those
are the encoded values.
"""

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray
from scipy import fft
from scipy.ndimage import distance_transform_edt

from voldetail.metric.layers import Layers, Mask
from voldetail.metric.quantiles import Array, Parts
from voldetail.metric.sensitivity import contrast_sensitivity

ORIENTATIONS = 16
SCALES = 6
CYCLES = (0.25, 0.5, 0.75, 1.0)
"""The four frequencies, in cycles per standard deviation of the window: one to four periods in four deviations."""

FINEST = 1.5
"""Standard deviation of the finest window in pixels. Its third frequency is then the sampling limit and its fourth beyond,
the one that the paper leaves out."""

RATIO = 2**0.75
"""From scale to scale. The coarsest window is then 20 pixels: what it needs on every side, see REACH, is a fifth of the 256
pixels that the paper's textures have."""

REACH = 2.5
"""Standard deviations over which a window must be inside the picture: it has then fallen to 4 %."""

PASSED = 0.5
"""Cycles per deviation beside its frequency that a filter lets pass: there a window's spectrum has fallen to 0.7 %."""

GLOBAL = 1.8
"""w_global. The paper wants mean and deviation to count as much as all local structure, and takes the sum of the other weights
for this, 250 here; in equation 6 that lets them count for some ten thousand times as much. This is the paper's wish, met in the
median over pairs of the 42 textures of results/metric: the root of 3.3, by which the squared local distance is the larger."""

FEWEST_SAMPLES = 64
"""A side on which responses are evaluated, of a picture that has as many: turning a picture then moves no sample by much."""

SAMPLES_TOGETHER = 2**19
"""Of filters whose responses are found at once: 4 MB of them; one at a time, calls take longer than sums in small pictures."""

Indices = NDArray[np.intp]
Spectrum = NDArray[np.complexfloating]

SIGMAS = tuple(FINEST * RATIO**scale for scale in range(SCALES))
NAMES = ("global", *(f"scale {scale}" for scale in range(SCALES)))


def cycles(scale: int) -> tuple[float, ...]:
    """The frequencies of a scale: all, but for the one beyond the sampling limit."""
    return tuple(c for c in CYCLES if c / SIGMAS[scale] <= 0.5)


def basis(layers: Layers, /) -> Parts:
    """Weights: (1, 1 + 16 frequencies) for each scale and (1, 1) for the global part, see `weights`."""
    return weights()


def measure(layers: Layers, basis: Parts, /) -> Parts:
    """Mean and deviation, the rows, of each response of equation 5 over the area A_i; NaN where no window fits.

    Columns: the isotropic kernel, then for each frequency the 16 orientations from 0 (waves along x) counter-clockwise
    in steps of pi / 16. Turning the picture by such a step moves the columns of a frequency on by one.
    """
    image, mask = layers.images[0], layers.masks[0]
    inside = image if mask is None else image[mask]
    filled = image if mask is None else np.where(mask, image, np.float32(inside.mean()))
    # Low frequencies of a large mean would drown the rest in single precision.
    spectrum = np.tile(fft.fft2(np.asarray(filled - inside.mean(), np.float32)), (2, 2))
    depth = _depth(image.shape, mask)
    found = {"global": np.array([[inside.mean()], [inside.std()]], np.float32)}
    for scale in range(SCALES):
        columns = [_moments(spectrum, depth, scale, 0.0, inside.mean())]
        columns += [_moments(spectrum, depth, scale, c, 0.0) for c in cycles(scale)]
        found[f"scale {scale}"] = np.concatenate(columns, axis=1)
    return found


def apart(a: Array, b: Array, basis: Array | None, /) -> Array:
    """Sum of w_i^2 d_i^2 of equation 6, d_i^2 = (mean - mean')^2 + (deviation - deviation')^2 the squared 2-Wasserstein
    distance of two Gaussians (Dowson & Landau 1982). The root over the sum of all parts is left out, as in the paper."""
    gaps = np.nan_to_num(np.sum((a - b) ** 2, axis=-2, keepdims=True))
    return np.asarray(np.sum(gaps if basis is None else gaps * basis**2, axis=(-2, -1)))


@lru_cache
def weights() -> Parts:
    """Weights w_i by the eye's sensitivity to each filter's frequency (an isotropic kernel: to the lowest of its scale).

    The paper's table of weights is a picture of one observer's test chart, so the model of `sensitivity` stands for it.
    w_global is GLOBAL.
    """
    found = {}
    for scale, sigma in enumerate(SIGMAS):
        frequencies = [CYCLES[0], *np.repeat(cycles(scale), ORIENTATIONS)]
        found[f"scale {scale}"] = contrast_sensitivity(np.array([frequencies], np.float64) / sigma).astype(np.float32)
    return {"global": np.full((1, 1), GLOBAL, np.float32)} | found


def _depth(shape: tuple[int, ...], mask: Mask | None) -> Array:
    """How far each pixel is from where windows would cross the border or what is masked.

    The paper's area A_i is the largest disc: turning a picture about its middle then changes nothing. The disc belongs to
    the mask's box; in one that is longer than wide it is drawn out to what a disc covers that moves along.
    """
    use = np.ones(shape, bool) if mask is None else mask
    rows, columns = np.flatnonzero(use.any(1)), np.flatnonzero(use.any(0))
    half = [(found[-1] - found[0] + 1) / 2 for found in (rows, columns)]
    y, x = (
        np.maximum(np.abs(np.arange(n) - (found[0] + found[-1]) / 2) - (h - min(half)), 0)
        for n, found, h in zip(shape, (rows, columns), half, strict=True)
    )
    disc = min(half) - np.hypot(y[:, None], x)
    return np.asarray(disc if mask is None else np.minimum(disc, distance_transform_edt(use)), np.float32)


def _moments(spectrum: Spectrum, depth: Array, scale: int, frequency: float, shift: float) -> Array:
    """Mean and deviation (2, filters) of |I * g| over A_i, divided by the integral of |g| (equation 5).

    spectrum: (2h, 2w), the picture's twice in each direction, so that any h x w of it is one piece.
    """
    filters, rows, columns = _filters(depth.shape, scale, frequency)
    area = np.flatnonzero(depth[np.ix_(rows, columns)] >= REACH * SIGMAS[scale])
    if not len(area):
        return np.full((2, len(filters)), np.nan, np.float32)
    share = np.float32(len(rows) * len(columns) / depth.size)
    together = max(1, SAMPLES_TOGETHER // (len(rows) * len(columns)))
    parts = []
    for first in range(0, len(filters), together):
        pieces = [
            spectrum[row : row + len(rows), column : column + len(columns)] * transfer
            for row, column, transfer in filters[first : first + together]
        ]
        # The order of frequencies multiplies by a wave of modulus 1; without a frequency, signs matter.
        passed = np.stack(pieces) if frequency else fft.ifftshift(np.stack(pieces), axes=(1, 2))
        response = fft.ifft2(passed, overwrite_x=True).reshape(len(pieces), -1)[:, area]
        values = np.sqrt(response.real**2 + response.imag**2) * share if frequency else np.abs(response.real * share + shift)
        parts.append(np.stack([values.mean(axis=1), values.std(axis=1)]))
    return np.concatenate(parts, axis=1).astype(np.float32)


Filter = tuple[int, int, Array]


@lru_cache(64)
def _filters(shape: tuple[int, int], scale: int, frequency: float) -> tuple[tuple[Filter, ...], Indices, Indices]:
    """One frequency's filters, each as a piece of a spectrum (its first row and column) and its own spectrum there, and the
    rows and columns of the picture that are evaluated.

    g(x) = G(x) (exp(2 pi i f . x) - c) with a Gaussian G of integral 1 and c such that g has none, as Manjunath & Ma
    (1996) have it: a filter that answered to brightness would measure little else. Frequency 0 is G alone. What a filter
    passes is moved from about its wave to about 0, which multiplies the response by a wave of modulus 1: a grid as fine as G
    needs then holds the response's magnitude, however short the wave.
    """
    sigma = SIGMAS[scale]
    f = frequency / sigma
    sizes = [_size(n, 2 * PASSED / sigma) for n in shape]
    bias = np.exp(-2 * np.pi**2 * frequency**2) if frequency else 0.0
    filters = []
    for angle in np.arange(ORIENTATIONS if frequency else 1) * np.pi / ORIENTATIONS:
        # Rows run downwards, angles counter-clockwise.
        wave = (-f * np.sin(angle), f * np.cos(angle))
        first = [round(w * n) - m // 2 for w, n, m in zip(wave, shape, sizes, strict=True)]
        y, x = ((k + np.arange(m)) / n for k, m, n in zip(first, sizes, shape, strict=True))
        transfer = _window(sigma, y - wave[0], x - wave[1]) - bias * _window(sigma, y, x)
        scaled = np.asarray(transfer / _integral(frequency), np.float32)
        filters.append((first[0] % shape[0], first[1] % shape[1], scaled))
    rows, columns = ((np.arange(m) * n) // m for n, m in zip(shape, sizes, strict=True))
    return tuple(filters), rows, columns


def _window(sigma: float, y: NDArray[np.float64], x: NDArray[np.float64]) -> NDArray[np.float64]:
    """Spectrum of a Gaussian of integral 1 on the pixel grid: what lies beyond the sampling limit is folded back."""
    rows, columns = (sum(np.exp(-2 * (np.pi * sigma * (axis + turn)) ** 2) for turn in (-1, 0, 1)) for axis in (y, x))
    return np.asarray(np.multiply.outer(rows, columns))


def _size(pixels: int, passed: float) -> int:
    """Samples on which a filter that passes `passed` cycles a pixel, both ways together, is evaluated."""
    needed = max(int(np.ceil(pixels * passed)) + 1, FEWEST_SAMPLES)
    return min(int(fft.next_fast_len(needed)), pixels)


@lru_cache
def _integral(frequency: float) -> float:
    """Integral of |g|, which depends on the cycles a deviation only: the mean of |exp(2 pi i f t) - c| under a normal t."""
    if not frequency:
        return 1.0
    t = np.linspace(-8, 8, 4001)
    normal = np.exp(-t * t / 2) / np.sqrt(2 * np.pi)
    wave = np.exp(2j * np.pi * frequency * t) - np.exp(-2 * np.pi**2 * frequency**2)
    return float(np.sum(normal * np.abs(wave)) * (t[1] - t[0]))
