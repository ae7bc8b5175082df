"""The scheme that the package does not use: sparse-convolution Gabor noise of the same lobes, for speed and law side by side.

Lagae, Lefebvre, Drettakis and Dutre, Procedural noise using sparse Gabor convolution, ACM TOG 28(3), 2009, with a random phase
an impulse (Galerne et al. 2012): a grid a lobe, cells as long as the kernel's radius, `impulses` in each, nine cells in reach.
Fixed counts instead of Poisson ones: the kinder case for it.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from voldetail.noise.lattice import cell_hash, unit

CUT = 0.05
"""Height of the kernel's Gaussian at its radius, relative to its centre, as in the 2009 article."""

RADIUS = math.sqrt(-2 * math.log(CUT))
"""The same in deviations."""


def sparse_gabor(points: tuple[Any, Any], rows: NDArray[np.float64], impulses: int, seed: Any) -> Any:
    """Return the noise of ``rows`` (n, 5), as `voldetail.noise.lobes.lobe_table` has them, at ``points`` in texels, y up."""
    import drjit as dr  # not above: voldetail has to be imported first, to choose the LLVM that it reads

    x, y = points
    float_type: Any = type(x)
    uint_type: Any = type(seed)
    int_type = dr.int32_array_t(float_type)
    frequency, angle, bandwidth, across, variance = rows.T
    # Cells along and across: a kernel whose power has deviation b has deviation 1 / (2 sqrt(2) pi b) itself.
    cells = np.stack([bandwidth, across]) * 2 * math.sqrt(2) * math.pi / RADIUS
    # Mean squares of kernel times cosine: impulses a cell times half the integral of exp(-r^2) in the cell's units.
    scale = np.sqrt(variance / (impulses * 0.5 * math.pi / RADIUS**2))
    packed = [np.cos(angle), np.sin(angle), *cells, frequency / cells[0], scale, 0 * scale, 0 * scale]
    table = float_type(np.stack(packed, 1).astype(np.float32).ravel())
    four: Any = dr.replace_shape_t(float_type, (4, -1))
    count = dr.opaque(uint_type, len(rows))

    def body(index: Any, total: Any) -> tuple[Any, Any]:
        c, s, cells_along, cells_across = dr.gather(four, table, 2 * index)
        turns, height, _, _ = dr.gather(four, table, 2 * index + 1)
        u, v = dr.fma(x, c, y * s) * cells_along, dr.fma(y, c, -x * s) * cells_across
        iu, iv = int_type(dr.floor(u)), int_type(dr.floor(v))
        value = dr.zeros(float_type)
        for i in (-1, 0, 1):
            for j in (-1, 0, 1):
                for k in range(impulses):
                    cell = [dr.reinterpret_array(uint_type, a) for a in (iu + i, iv + j)]
                    a, b, phase, _ = cell_hash(cell[0], cell[1], index, seed + (k * 0x632BE5AB & 0xFFFFFFFF))
                    du = u - float_type(iu + i) - unit(a, float_type)
                    dv = v - float_type(iv + j) - unit(b, float_type)
                    square = (du * du + dv * dv) * RADIUS**2
                    wave = dr.cos(2 * math.pi * dr.fma(turns, du, unit(phase, float_type)))
                    value += dr.select(square < RADIUS**2, dr.exp(-0.5 * square) * wave, 0.0)
        return index + 1, dr.fma(height, value, total)

    state = (dr.zeros(uint_type, dr.width(x)), dr.zeros(float_type, dr.width(x)))
    return dr.while_loop(state, lambda index, total: index < count, body, label="lobes of impulses")[1]
