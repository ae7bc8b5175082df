"""Gaussian noise with a sum of Gaussian pairs as its power spectrum, at any place: the spectrum model of Gabor noise by
example (Galerne, Lagae, Lefebvre and Drettakis, ACM TOG 31(4), 2012), made by carriers with random envelopes.

Symbols
    S(f)      sum_k v_k / 2 (G_k(f - f_k) + G_k(f + f_k)), the power spectrum, f in cycles per texel
    v_k, f_k  variance and centre of lobe k; G_k the Gaussian density of deviations b_k along f_k and c_k across it
    N(x)      sum_k sqrt(v_k) Re(E_k(x) exp(2 pi i f_k . x)), the noise
    E_k(x)    sum_j w(u - j) g_j / sqrt(sum_j w(u - j)^2), the envelope of lobe k: g_j are complex numbers drawn for the
              nodes j of a lattice of its own, u is x in the cells of that lattice, w the quadratic B-spline a side
    sigma     deviation of the pixel filter, a Gaussian, in texels

Why not impulses: sparse Gabor noise draws nine cells of kernels in reach for every lobe, each with a cosine and an exponential
of its own. Here one carrier serves all nodes of a lobe, which takes under half of the processor's time of one impulse a cell
and a tenth of that of five (tests.benchmarks.colour_lobes), and the variance is exact at every place, since the squares of the
weights sum to one. The lattices, of other sizes and directions from lobe to lobe, do not show in a sum of several; a single
lobe at zero frequency shows a little of its own. The envelope's spectrum, near sinc^6, is the Gaussian within 1.5 % of its
height, and 1 % of the power lies elsewhere.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import drjit as dr
import numpy as np
from numpy.typing import NDArray

from voldetail.noise.lattice import PCG_MULTIPLIER, cell_hash

ROWS = 64
"""Most lobes of a table; tables are padded to it, so that one compiled kernel serves any number of lobes."""

COLUMNS = 5
"""Numbers a lobe: frequency, angle, bandwidth along the frequency, bandwidth across it, variance."""

CELL_BANDWIDTH = 0.2157
"""Deviation of the envelope's power spectrum in cycles per cell: the root of the mean over u of sum_j (dW_j/du)^2 / 4 pi^2
for the weights W_j after their division; a test works it out."""

LEAST_BANDWIDTH = 1e-6
"""Cycles per texel: cells no longer than a quarter of a million texels, so that a table has no infinite number."""

NIBBLES_MEAN, NIBBLES_DEVIATION = 60.0, math.sqrt(8 * (16**2 - 1) / 12)
"""Of the sum of the eight half-bytes of a word: a bell within 4.6 deviations, kurtosis 2.85. A texel blends nine such numbers
for each lobe, which brings the kurtosis of even a single lobe to 2.95."""

EVEN_NIBBLES, SUM_OF_BYTES = 0x0F0F0F0F, 0x01010101
OFFSETS = (0.7548776662466927, 0.5698402909980532)
"""Steps of the lattices' origins from lobe to lobe, of the most even sequence in two dimensions (powers of 1 / 1.3247, the
plastic number), so that no two lattices have a node in the same place."""


@dataclass(frozen=True)
class LobeTable:
    """The lobes as the kernel reads them: opaque arrays, ROWS lobes long, and how many of these count.

    shapes: four numbers a lobe: cos and sin of its angle, and the cells of its lattice a texel along and across it.
    strengths: four more: f_k in cycles per texel, sqrt(v_k), the origin of the lattice in cells. variance: sum_k v_k.
    """

    count: Any
    shapes: Any
    strengths: Any
    variance: Any


def lobe_table(lobes: NDArray[np.float64], float_type: Any) -> LobeTable:
    """Return the table of ``lobes`` (n, 5), each (frequency, angle, bandwidth, across, variance), in arrays of ``float_type``.

    Frequency and bandwidths in cycles per texel, the angle in radians counter-clockwise from x with y up. Raises ValueError
    for more than ROWS lobes, none, another shape, or numbers that are negative (but the angle) or not finite.
    """
    rows = np.asarray(lobes, np.float64)
    if rows.ndim != 2 or rows.shape[1] != COLUMNS or not 1 <= len(rows) <= ROWS:
        raise ValueError(f"lobes have the shape {rows.shape}, and need (1 to {ROWS}, {COLUMNS})")
    if not np.isfinite(rows).all() or (rows[:, [0, 2, 3, 4]] < 0).any():
        raise ValueError("a lobe has a number that is negative or not finite")
    frequency, angle, bandwidth, across, variance = rows.T
    cells = np.maximum([bandwidth, across], LEAST_BANDWIDTH) / CELL_BANDWIDTH
    origins = np.outer(OFFSETS, np.arange(len(rows))) % 1.0

    def packed(*columns: NDArray[np.float64]) -> Any:
        padded = np.zeros((ROWS, len(columns)), np.float32)
        padded[: len(rows)] = np.stack(columns, axis=1)
        return float_type(padded.ravel())

    return LobeTable(
        count=dr.opaque(dr.uint32_array_t(float_type), len(rows)),
        shapes=packed(np.cos(angle), np.sin(angle), *cells),
        strengths=packed(frequency, np.sqrt(variance), *origins),
        variance=dr.opaque(float_type, float(variance.sum())),
    )


def lobe_noise(points: tuple[Any, Any], lobes: LobeTable, seed: Any, footprint: Any | None = None) -> tuple[Any, Any]:
    """Return (N(x), the variance that is left), both float arrays, at ``points`` (x, y) in texels with y up.

    ``seed`` is a UInt array of width 1 (opaque). ``footprint`` is sigma, texels, a float array of width 1 or that of the
    points: every lobe fades to the share of its variance that passes the filter, `passed`. None: nothing is filtered and the
    variance that is left is the table's, sum_k v_k, everywhere.
    """
    x, y = points
    float_type: Any = type(x)
    uint_type: Any = type(seed)
    four: Any = dr.replace_shape_t(float_type, (4, -1))  # four numbers in one read: sixteen reads take longer than the noise
    width = dr.width(x, y)

    def body(index: Any, value: Any, left: Any) -> tuple[Any, Any, Any]:
        c, s, cells_along, cells_across = dr.gather(four, lobes.shapes, index)
        frequency, amplitude, origin_u, origin_v = dr.gather(four, lobes.strengths, index)
        along, across = dr.fma(x, c, y * s), dr.fma(y, c, -x * s)
        u, v = dr.fma(along, cells_along, origin_u), dr.fma(across, cells_across, origin_v)
        real, imaginary = _envelope(u, v, index, seed)
        turns = frequency * along
        # Whole turns are taken off first: the sine of a large number is less exact than the number.
        sine, cosine = dr.sincos((turns - dr.floor(turns)) * (2.0 * math.pi))
        if footprint is not None:
            share = passed(footprint, frequency, cells_along * CELL_BANDWIDTH, cells_across * CELL_BANDWIDTH)
            left += amplitude * amplitude * share
            amplitude = amplitude * dr.sqrt(share)
        return index + 1, dr.fma(amplitude, dr.fma(real, cosine, imaginary * sine), value), left

    _, value, left = dr.while_loop(
        (dr.zeros(uint_type, width), dr.zeros(float_type, width), dr.zeros(float_type, width)),
        lambda index, value, left: index < lobes.count,
        body,
        label="lobes of the spectrum",
    )
    return value, left if footprint is not None else lobes.variance


def passed(footprint: Any, frequency: Any, bandwidth: Any, across: Any) -> Any:
    """Return the share of a lobe's variance that a Gaussian pixel filter of deviation ``footprint`` (texels) lets pass.

    The integral of G(f - f_k) exp(-4 pi^2 sigma^2 f^2): with q = 8 pi^2 sigma^2,
    exp(-q f^2 / 2 (1 + q b^2)) / sqrt((1 + q b^2) (1 + q c^2)), in (0, 1].
    """
    q = footprint * footprint * (8.0 * math.pi**2)
    along = 1.0 + q * bandwidth * bandwidth
    return dr.exp(-0.5 * q * frequency * frequency / along) / dr.sqrt(along * (1.0 + q * across * across))


def _envelope(u: Any, v: Any, lobe: Any, seed: Any) -> tuple[Any, Any]:
    """Return the real and imaginary part of E at the lattice place (u, v), each of variance 1."""
    float_type: Any = type(u)
    uint_type: Any = type(seed)
    int_type = dr.int32_array_t(float_type)
    across_u, across_v = _weights(u - dr.floor(u)), _weights(v - dr.floor(v))
    iu: Any = dr.reinterpret_array(uint_type, int_type(dr.floor(u)))
    iv: Any = dr.reinterpret_array(uint_type, int_type(dr.floor(v)))
    # Lobe and seed move the lattice to a random part of the one hashed plane of 2^64 nodes.
    shift_u, shift_v, _, _ = cell_hash(lobe, uint_type(0), uint_type(0), seed)
    # Minus one wraps round in unsigned integers, which is what the reinterpreted index needs.
    columns = [(iu + (step & 0xFFFFFFFF)) * PCG_MULTIPLIER + shift_u for step in (-1, 0, 1)]
    rows = [(iv + (step & 0xFFFFFFFF)) * PCG_MULTIPLIER + shift_v for step in (-1, 0, 1)]
    real, imaginary = dr.zeros(float_type), dr.zeros(float_type)
    for row, weight_v in zip(rows, across_v, strict=True):
        sums = [dr.zeros(float_type), dr.zeros(float_type)]
        for column, weight_u in zip(columns, across_u, strict=True):
            for part, word in enumerate(_node_hash(column, row)):
                sums[part] = dr.fma(weight_u, _bell(word, float_type), sums[part])
        real, imaginary = dr.fma(weight_v, sums[0], real), dr.fma(weight_v, sums[1], imaginary)
    return real, imaginary


def _node_hash(a: Any, b: Any) -> tuple[Any, Any]:
    """Return two well-mixed words: the pcg2d of Jarzynski and Olano (noise.lattice), after its first multiplication."""
    for _ in range(2):
        a = a + b * PCG_MULTIPLIER
        b = b + a * PCG_MULTIPLIER
        a, b = a ^ (a >> 16), b ^ (b >> 16)
    return a, b


def _weights(t: Any) -> tuple[Any, Any, Any]:
    """Return the quadratic B-spline's three weights at ``t`` in [0, 1) of a cell, over the root of their squares' sum."""
    before, after = 0.5 * (1.0 - t) * (1.0 - t), 0.5 * t * t
    middle = 1.0 - before - after
    # Not dr.rsqrt: its last bits come from the processor's own estimate and differ between machines.
    scale = 1.0 / dr.sqrt(before * before + middle * middle + after * after)
    return before * scale, middle * scale, after * scale


def _bell(word: Any, float_type: Any) -> Any:
    """Return a number of mean 0 and variance 1 from the eight half-bytes of a word, near a Gaussian."""
    pairs = (word & EVEN_NIBBLES) + ((word >> 4) & EVEN_NIBBLES)
    total = dr.int32_array_t(float_type)((pairs * SUM_OF_BYTES) >> 24)
    return (float_type(total) - NIBBLES_MEAN) * (1.0 / NIBBLES_DEVIATION)
