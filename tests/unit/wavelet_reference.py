"""A second implementation of wavelet noise, in NumPy and double precision, from Cook and DeRose 2005 (sections 3 and 4).

It filters lines of coefficients with the published 32 numbers, one at a time, and evaluates the spline by its knots; of the
package it shares the hash's definition (noise_reference) and the constants.
"""

from __future__ import annotations

import itertools

import numpy as np
from noise_reference import TURN, hash_words
from numpy.typing import NDArray

from voldetail.noise.wavelet_spectrum import PHASE, covariance_lines

Floats = NDArray[np.float64]

DOWN = [
    0.000334, -0.001528, 0.000410, 0.003545, -0.000938, -0.008233, 0.002172, 0.019120, -0.005040, -0.044412, 0.011655,
    0.103311, -0.025936, -0.243780, 0.033979, 0.655340,
]  # fmt: skip
"""The first half of Cook and DeRose's downsampling filter; the second half mirrors it."""
DOWN_FILTER = np.array(DOWN + DOWN[::-1])
UP_FILTER = np.array([0.25, 0.75, 0.75, 0.25])


def low_part(line: Floats) -> Floats:
    """Downsample and upsample one periodic line."""
    n = len(line)
    half = np.zeros(n // 2)
    for k in range(n // 2):
        for tap, value in enumerate(DOWN_FILTER):
            half[k] += value * line[(2 * k + tap - 15) % n]
    full = np.zeros(n)
    for k in range(n // 2):
        for tap, value in enumerate(UP_FILTER):
            full[(2 * k + tap - 1) % n] += value * half[k]
    return full


def moves(nodes: NDArray[np.int64], axis: int, band: int, seed: int, dims: int, side: int) -> NDArray[np.int64]:
    """By how many coefficients the block of each node on ``axis`` moves the other axes (N, dims)."""
    block = np.floor_divide(nodes, side)
    cells = np.stack([block, np.full_like(block, axis), np.full_like(block, band)], -1)
    words = hash_words(cells, (seed + band * dims) % 2**32)[:, :dims].astype(np.int64)
    words[:, axis] = 0
    return words


def noise(points: Floats, band: int, seed: int, tile: NDArray[np.float32]) -> Floats:
    """Values (N, channels) at points (N, dims) in texels."""
    dims, side = points.shape[1], tile.shape[0]
    place = (points @ TURN.T if dims == 3 else points) / 2.0**band + PHASE + (0.618034 * band if band >= 2 else 0.0)
    middle = np.floor(place + 0.5).astype(np.int64)
    total = np.zeros((len(points), tile.shape[-1]))
    for step in itertools.product((-1, 0, 1), repeat=dims):
        nodes = middle + np.array(step)
        weight = np.ones(len(points))
        for axis in range(dims):
            distance = np.abs(place[:, axis] - nodes[:, axis])
            weight *= np.where(distance <= 0.5, 0.75 - distance**2, 0.5 * np.maximum(1.5 - distance, 0) ** 2)
        where = nodes.copy()
        for axis in range(dims):
            where += moves(nodes[:, axis], axis, band, seed, dims, side)
        where %= side
        total += weight[:, None] * tile[tuple(where[:, axis] for axis in reversed(range(dims)))]
    return total


def slice_shares(side: int = 512, step: float = 0.25, octaves: int = 6) -> Floats:
    """Share of a 3D band's variance by octave in a slice, from one finer than its own: the mean over three planes.

    The covariance along the turned lattice's planes, transformed: of `solid.SLICE_SHARE` the numbers.
    """
    tau = np.linspace(-60.0, 60.0, 6001)
    lines = covariance_lines(tau)
    d = (np.arange(side) - side // 2) * step
    x, y = np.meshgrid(d, d)
    frequency = np.abs(np.fft.fftfreq(side, step))
    largest = np.maximum(frequency[:, None], frequency[None])
    total = np.zeros(octaves)
    for u, v in itertools.combinations(TURN.T, 2):
        cov = np.zeros((side, side))
        for term, sign in enumerate((1.0, -2.0, 1.0)):
            cov += sign * np.prod([np.interp(x * u[k] + y * v[k], tau, lines[term], 0.0, 0.0) for k in range(3)], axis=0)
        power = np.fft.fft2(np.fft.ifftshift(cov)).real
        for row in range(octaves):
            k = row - 1
            total[row] += power[(largest > 2.0 ** -(k + 2)) & (largest <= 2.0 ** -(k + 1))].sum() / power.sum() / 3.0
    return total
