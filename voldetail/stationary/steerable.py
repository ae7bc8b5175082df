"""One level of a steerable pyramid, as it is and inverted (MJHRW17 eq. 4; Simoncelli and Freeman 1995).

The picture is split into a highpass residue, ORIENTATIONS bands of one octave and a lowpass residue by multiplications
of its spectrum. The squares of all gains add up to one, so the same filters put the picture together again.
"""

from __future__ import annotations

from functools import lru_cache
from math import factorial, sqrt

import numpy as np
from numpy.typing import NDArray
from scipy import fft

from voldetail.types import Array

ORIENTATIONS = 4
"""o of MJHRW17 section 3.3; at one magnitude m."""

REACH = 16
"""Pixels by which a picture that does not tile is continued (mirrored), and within which a filter's response still
depends on what lies there."""


def bands(plane: Array) -> Array:
    """Responses F_o * f of a periodic picture (H, W): (4, H, W)."""
    _, oriented, _ = _gains(plane.shape[0], plane.shape[1])
    spectrum = fft.rfft2(plane)
    return np.asarray(fft.irfft2(spectrum * oriented, s=plane.shape, axes=(1, 2)), np.float32)


def bands_of_photo(plane: Array) -> Array:
    """Responses (4, H, W) of a picture (H, W) that does not tile: it is mirrored at its edges."""
    padded = np.pad(plane, REACH, mode="symmetric")
    return np.ascontiguousarray(bands(padded)[:, REACH:-REACH, REACH:-REACH])


def with_bands(plane: Array, changed: Array) -> Array:
    """The periodic picture (H, W) whose residues are those of `plane` and whose bands are `changed` (4, H, W).

    Of all such pictures it is the one that Heeger and Bergen 1995 take: each response weights its filter.
    """
    high, oriented, low = _gains(plane.shape[0], plane.shape[1])
    residue = fft.rfft2(plane) * (high**2 + low**2)
    oriented_part = (fft.rfft2(changed, axes=(1, 2)) * np.conj(oriented)).sum(axis=0)
    return np.asarray(fft.irfft2(residue + oriented_part, s=plane.shape), np.float32)


@lru_cache(maxsize=16)
def _gains(height: int, width: int) -> tuple[Array, NDArray[np.complex64], Array]:
    """Gains of the highpass (H, K), the bands (4, H, K) and the lowpass residue (H, K) on a half spectrum."""
    fy, fx = fft.fftfreq(height)[:, None], fft.rfftfreq(width)[None, :]
    octave = np.log2(np.maximum(2 * np.hypot(fx, fy), 1e-9))  # 0 at the highest frequency along an axis
    angle = np.arctan2(fy, fx)
    high, below = _split(octave + 1)
    band, low = _split(octave + 2)
    order = ORIENTATIONS - 1
    gain = 2**order * factorial(order) / sqrt(ORIENTATIONS * factorial(2 * order))  # squares add up to one
    turned = [(-1j) ** order * gain * np.cos(angle - np.pi * k / ORIENTATIONS) ** order for k in range(ORIENTATIONS)]
    # A picture of even sides cannot hold an odd response at its highest frequency: what is there stays in the residue.
    lost = (np.abs(fy) == 0.5) | (fx == 0.5)
    oriented = np.where(lost, 0, below * band * np.array(turned))
    high = np.where(lost, np.sqrt(np.maximum(1 - (below * low) ** 2, 0)), high)
    return np.asarray(high, np.float32), np.asarray(oriented, np.complex64), np.asarray(below * low, np.float32)


def _split(octave: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Highpass and lowpass gains that go over into each other from octave 0 to 1, as a quarter of a cosine."""
    t = np.clip(octave, 0, 1) * np.pi / 2
    return np.sin(t), np.cos(t)
