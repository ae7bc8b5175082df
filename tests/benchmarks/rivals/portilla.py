"""The statistics of Portilla & Simoncelli 2000, section 2, over a complex steerable pyramid of four levels and orientations."""

import numpy as np
from scipy import fft

from tests.benchmarks.rivals.steerable import LEVELS, doubled, even, pyramid
from voldetail.metric.layers import Layers
from voldetail.metric.quantiles import Array, Parts

REACH = 3
"""Autocorrelations within 7 x 7 shifts; section 2's M = 7."""

FAINT = 1e-6


def basis(layers: Layers, /) -> Parts:
    """Units of the moments: the reference's deviation for what is a brightness, 1 for shapes."""
    unit = max(float(layers.images[0].std()), 1e-4)
    return {
        "pixels": np.array([unit, unit, 1, 1, unit, unit], np.float32),
        "lowpass": np.array([unit, 1, 1] * (LEVELS + 1) + [unit], np.float32),
    }


def measure(layers: Layers, basis: Parts, /) -> Parts:
    """Section 2.1 to 2.4: pixels, lowpass images, raw autocorrelation, magnitudes, cross-scale phase."""
    image = even(layers.images[0])
    centred = image - image.mean()
    found = {"pixels": np.array([image.mean(), *_shape(centred), *np.quantile(centred, (0.001, 0.999))], np.float32)}
    high, bands, lows = pyramid(centred)
    found["lowpass"] = np.array([moment for low in lows for moment in _shape(low)] + [high.std()], np.float32)
    found["autocorrelation"] = np.concatenate([_autocorrelation(low) for low in lows])
    magnitudes = [np.abs(band) - np.abs(band).mean(axis=(1, 2), keepdims=True) for band in bands]
    found["magnitude space"] = np.concatenate([_autocorrelation(m) for level in magnitudes for m in level])
    within, across, phase = [], [], []
    for level in range(LEVELS):
        within.append(_correlations(magnitudes[level], magnitudes[level])[np.triu_indices(len(bands[level]), 1)])
        if level + 1 < LEVELS:
            parents = doubled(bands[level + 1])
            above = np.abs(parents) - np.abs(parents).mean(axis=(1, 2), keepdims=True)
            across.append(_correlations(magnitudes[level], above).ravel())
            turned = parents**2 / np.maximum(np.abs(parents), FAINT)  # at twice the phase, the frequency of the child
            both = np.concatenate([turned.real, turned.imag])
            phase.append(_correlations(bands[level].real, both).ravel())
    found["magnitude within"] = np.concatenate(within)
    found["magnitude across"] = np.concatenate(across)
    found["phase"] = np.concatenate(phase)
    return {name: np.asarray(values, np.float32) for name, values in found.items()}


def compare(a: Array, b: Array, basis: Array | None, /) -> float:
    """Root mean square difference, of moments in their units."""
    gap = a - b if basis is None else (a - b) / basis
    return float(np.sqrt(np.mean(gap**2)))


def _shape(values: Array) -> tuple[float, float, float]:
    """Deviation, skewness and kurtosis, the last as a logarithm: it runs from 2 to hundreds."""
    deviation = max(float(values.std()), FAINT)
    standard = (values - values.mean()) / deviation
    return deviation, float(np.mean(standard**3)), float(np.log(np.mean(standard**4) + FAINT))


def _autocorrelation(values: Array) -> Array:
    """Correlations at shifts up to 3, the half of them that differ: (25,)."""
    power = fft.ifft2(np.abs(fft.fft2(values - values.mean())) ** 2).real
    shifted = np.roll(power, (REACH, REACH), (0, 1))[: 2 * REACH + 1, : 2 * REACH + 1]
    return np.asarray(shifted.ravel()[: shifted.size // 2 + 1] / max(float(power[0, 0]), FAINT), np.float32)


def _correlations(one: Array, other: Array) -> Array:
    a, b = one.reshape(len(one), -1), other.reshape(len(other), -1)
    lengths = np.outer(np.linalg.norm(a, axis=1), np.linalg.norm(b, axis=1))
    return np.asarray(a @ b.T / np.maximum(lengths, FAINT), np.float32)
