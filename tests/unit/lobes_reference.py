"""A second implementation of the noise of lobes, in NumPy and double precision, from the equations of noise.lobes.

Only constants are taken from the package; the hash is written in Python's wrapping integers of NumPy.
"""

import math

import numpy as np
from noise_reference import hash_words
from numpy.typing import NDArray

from voldetail.noise import lobes as constants

Floats = NDArray[np.float64]
MULTIPLIER = np.uint32(1664525)


def node_numbers(iu: NDArray[np.int64], iv: NDArray[np.int64], lobe: int, seed: int) -> NDArray[np.complex128]:
    """g_j of the nodes (iu, iv)."""
    shift = hash_words(np.array([[lobe, 0, 0]]), seed)[0]
    a = iu.astype(np.uint32) * MULTIPLIER + shift[0]
    b = iv.astype(np.uint32) * MULTIPLIER + shift[1]
    for _ in range(2):
        a = a + b * MULTIPLIER
        b = b + a * MULTIPLIER
        a, b = a ^ (a >> np.uint32(16)), b ^ (b >> np.uint32(16))

    def bell(word: NDArray[np.uint32]) -> Floats:
        total = sum(((word >> np.uint32(4 * i)) & np.uint32(15)).astype(float) for i in range(8))
        return (total - 60.0) / math.sqrt(8 * (16**2 - 1) / 12)

    return bell(a) - 1j * bell(b)


def spline(t: Floats) -> Floats:
    """The quadratic B-spline, centred at zero, support 3."""
    t = np.abs(t)
    return np.where(t < 0.5, 0.75 - t**2, np.where(t < 1.5, 0.5 * (1.5 - t) ** 2, 0.0))


def noise(x: Floats, y: Floats, lobes: Floats, seed: int) -> Floats:
    """N(x): carriers times envelopes, node by node."""
    total = np.zeros_like(x)
    for k, (frequency, angle, bandwidth, across, variance) in enumerate(lobes):
        direction = np.array([math.cos(angle), math.sin(angle)])
        along, aside = x * direction[0] + y * direction[1], y * direction[0] - x * direction[1]
        u = along * bandwidth / constants.CELL_BANDWIDTH + k * constants.OFFSETS[0] % 1
        v = aside * across / constants.CELL_BANDWIDTH + k * constants.OFFSETS[1] % 1
        envelope, squares = np.zeros_like(x, dtype=complex), np.zeros_like(x)
        for i in (-1, 0, 1):
            for j in (-1, 0, 1):
                iu, iv = np.floor(u).astype(np.int64) + i, np.floor(v).astype(np.int64) + j
                weight = spline(u - iu - 0.5) * spline(v - iv - 0.5)
                envelope += weight * node_numbers(iu, iv, k, seed)
                squares += weight**2
        total += math.sqrt(variance) * (envelope / np.sqrt(squares) * np.exp(2j * math.pi * frequency * along)).real
    return total
