"""A complex steerable pyramid in the frequency domain (Portilla & Simoncelli 2000, section 2.1 and figure 2)."""

from functools import lru_cache
from math import factorial

import numpy as np
from numpy.typing import NDArray
from scipy import fft

LEVELS = 4
ORIENTATIONS = 4

Complex = NDArray[np.complex64]
Real = NDArray[np.float32]


def even(image: Real) -> Real:
    """The picture cut to sides that halve as often as the pyramid does."""
    step = 2**LEVELS
    return image[: image.shape[0] // step * step, : image.shape[1] // step * step]


def pyramid(image: Real) -> tuple[Real, list[Complex], list[Real]]:
    """Highpass residue (H, W), bands (4, H_l, W_l) a level, and the lowpass that enters each level and leaves the last.

    Bands are analytic: their real parts are the real pyramid's, with their Hilbert transforms as imaginary parts.
    """
    spectrum = fft.fft2(even(np.asarray(image, np.float32)))
    radius, _ = _polar(spectrum.shape)
    half = np.asarray(radius / 2, np.float32)
    high = fft.ifft2(spectrum * _high(half)).real
    spectrum = spectrum * _low(half)
    bands, lows = [], []
    for _ in range(LEVELS):
        lows.append(fft.ifft2(spectrum).real)
        bands.append(fft.ifft2(spectrum * _orientated(spectrum.shape)))
        spectrum = _halved(spectrum * _low(_polar(spectrum.shape)[0]))
    lows.append(fft.ifft2(spectrum).real)
    return high, bands, lows


def doubled(maps: NDArray[np.complexfloating]) -> NDArray[np.complexfloating]:
    """(K, h, w) -> (K, 2 h, 2 w), by zeros in the spectrum."""
    count, height, width = maps.shape
    spectrum = fft.fftshift(fft.fft2(maps), axes=(1, 2))
    padded = np.zeros((count, 2 * height, 2 * width), spectrum.dtype)
    padded[:, height // 2 : height // 2 + height, width // 2 : width // 2 + width] = spectrum
    return np.asarray(4 * fft.ifft2(fft.ifftshift(padded, axes=(1, 2))))


@lru_cache
def _orientated(shape: tuple[int, int]) -> Real:
    radius, angle = _polar(shape)
    order = ORIENTATIONS - 1
    # So that the squares of all orientations, both half-planes together, add up to one.
    gain = 2**order * factorial(order) / np.sqrt(ORIENTATIONS * factorial(2 * order))
    out = []
    for k in range(ORIENTATIONS):
        turned = np.angle(np.exp(1j * (angle - np.pi * k / ORIENTATIONS)))
        out.append(2 * gain * np.cos(turned) ** order * (np.abs(turned) < np.pi / 2) * _high(radius))
    return np.asarray(out, np.float32)


@lru_cache
def _polar(shape: tuple[int, int]) -> tuple[Real, Real]:
    """Radius in radians a pixel and angle of each frequency; rows run downwards, angles counter-clockwise."""
    y, x = np.fft.fftfreq(shape[0])[:, None], np.fft.fftfreq(shape[1])
    return np.asarray(2 * np.pi * np.hypot(y, x), np.float32), np.asarray(np.arctan2(-y, x), np.float32)


def _octave(radius: Real) -> Real:
    """0 from pi / 2 on, 1 up to pi / 4."""
    return np.asarray(np.clip(-np.log2(np.maximum(radius, 1e-6) * 2 / np.pi), 0, 1), np.float32)


def _low(radius: Real) -> Real:
    return np.sin(np.pi / 2 * _octave(radius)).astype(np.float32)


def _high(radius: Real) -> Real:
    return np.cos(np.pi / 2 * _octave(radius)).astype(np.float32)


def _halved(spectrum: Complex) -> Complex:
    """Every second sample: the inner half of the spectrum, beyond which nothing is left."""
    height, width = spectrum.shape
    middle = fft.fftshift(spectrum)[height // 4 : height // 4 + height // 2, width // 4 : width // 4 + width // 2]
    return np.asarray(fft.ifftshift(middle) / 4)
