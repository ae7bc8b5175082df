"""Gradient noise on a hashed lattice (Perlin 1985, with the fade of 2002) and its turbulence.

    n(x) = sum over the cell's corners c of fade(x - c) (g_c . (x - c)),      fade with 6t^5 - 15t^4 + 10t^3

Gradients g_c are unit vectors whose angle comes from the integer hash of `noise.lattice`: any point, in any order, on any
machine, and no table that repeats.
"""

from __future__ import annotations

from typing import Any

from voldetail.noise.lattice import UNIT_24, cell_hash
from voldetail.texture.structures.arrays import clip, functions

DEVIATION = 0.216
"""Of n over the plane: of all octaves the same, measured over 200 000 points."""

ABSOLUTE_MEAN = 0.177
"""Mean of |n|, measured so as well."""

OCTAVE_STEP = 0x632BE5AB
"""Step of the seed from octave to octave; any odd number does, the hash mixes it."""

FINEST_CELL = 3.0
"""Texels: lattice cells under half of this are left out of a turbulence, those under it fade in. A wave of gradient noise is
about two cells long."""

TURN = 6.2831853


def cell_words(ix: Any, iy: Any, seed: int) -> tuple[Any, Any, Any, Any]:
    """Return four numbers in [0, 1) of the cell with integer floats ``ix``, ``iy``."""
    f = functions(ix)
    x, y = f.whole(ix), f.whole(iy)
    words = cell_hash(x, y, x ^ y, f.words(seed))
    return tuple(f.real(word >> 8) * UNIT_24 for word in words)


def gradient_noise(x: Any, y: Any, seed: int) -> Any:
    """Return n at (x, y) in cells: mean 0, deviation `DEVIATION`, within -1 to 1."""
    f = functions(x)
    ix, iy = f.floor(x), f.floor(y)
    u, v = x - ix, y - iy
    sides = []
    for dy in (0.0, 1.0):
        row = []
        for dx in (0.0, 1.0):
            angle = cell_words(ix + dx, iy + dy, seed)[0] * TURN
            row.append(f.cos(angle) * (u - dx) + f.sin(angle) * (v - dy))
        sides.append(row[0] + _fade(u) * (row[1] - row[0]))
    return sides[0] + _fade(v) * (sides[1] - sides[0])


def _fade(t: Any) -> Any:
    return t * t * t * (t * (t * 6.0 - 15.0) + 10.0)


def octaves(x: Any, y: Any, size: float, seed: int, shape: Any, stretch: float = 1.0, finest: float = FINEST_CELL) -> Any:
    """Return sum_i 2^-i shape(n(2^i x)) / sum_i 2^-i, for cells of ``size`` texels (``stretch`` times as long along x).

    shape: what each octave is passed through. Octaves with cells under half of ``finest`` texels are left out.
    """
    total: Any = None
    weights, weight, cell, octave = 0.0, 1.0, size, 0
    while total is None or cell > finest / 2:
        share = weight * (1.0 if total is None else min(2 * cell / finest - 1, 1.0))
        value = share * shape(gradient_noise(x / (cell * stretch), y / cell, seed + octave * OCTAVE_STEP))
        total = value if total is None else total + value
        weights, weight, cell, octave = weights + share, weight / 2, cell / 2, octave + 1
    return total / weights


def turbulence(x: Any, y: Any, size: float, seed: int, stretch: float = 1.0) -> Any:
    """Return Perlin's turbulence, the octaves' |n|: 0 to 1, around `ABSOLUTE_MEAN`."""
    f = functions(x)
    return octaves(x, y, size, seed, lambda n: f.maximum(n, -n), stretch)


def fractal(x: Any, y: Any, size: float, seed: int, stretch: float = 1.0, finest: float = FINEST_CELL) -> Any:
    """Return the octaves' n, brought to -1 to 1 at 2.5 deviations: 0 on average."""
    return clip(octaves(x, y, size, seed, lambda n: n, stretch, finest) / (2.5 * DEVIATION), -1.0, 1.0)
