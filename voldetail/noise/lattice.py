"""Feature points in a jittered lattice, and the exact nearest ones.

Each cell of the unit lattice holds one feature point, uniform in the cell, drawn from an integer hash of the
cell's indices and a salt. Integers wrap the same way everywhere, so the points are bit-identical for any
thread count, machine or order of evaluation.

Symbols (GD10 section 4)
    x      position in cells, 2 or 3 coordinates
    P_i    i-th closest feature point to x
    D      Euclidean distance

Which cells can hold the four closest points? Let x lie in its own cell and call, along each axis, 1 the
neighbour on the nearer side and -1 the one on the farther side. Wherever x lies, four cells around it lie
wholly within 1.84 (2D) or 1.88 (3D) and hold a point each, so only cells nearer than that matter; per axis
those are 0, 1, -1, 2 and -2, whose distance from x is at least 0, 0, 1/2, 1 and 3/2. Visiting the cells in
the order of that bound and stopping as soon as the wanted rank is nearer than the bound of the next cell is
therefore exact, with no cell to miss.
"""

from __future__ import annotations

import itertools
import math
from functools import cache
from typing import Any

import drjit as dr
import numpy as np
from numpy.typing import NDArray

RANKS = 4
"""Points kept by the search: k' <= 3 plus the one after it, which tells where the set changes."""

AXIS_BOUND = {0: 0.0, 1: 0.0, -1: 0.5, 2: 1.0, -2: 1.5}
"""Least distance along one axis to a cell at each offset towards the nearer (+) or farther (-) side."""

FOURTH_POINT_RADIUS = {2: 1.84, 3: 1.88}
"""No position is farther than this from its fourth feature point, in cells. The worst places are (0.7, 0.7)
in the cell in 2D, 1.3 sqrt(2) = 1.8385, and the centre of a face in 3D, sqrt(3.5) = 1.8708."""

FAR = 1e9
"""A distance, or its square, beyond any that occurs."""

# The permuted congruential mix of Jarzynski and Olano, "Hash Functions for GPU Rendering", JCGT 9(3), 2020:
# its pcg4d.
PCG_MULTIPLIER = 1664525
PCG_INCREMENT = 1013904223
UNIT_24 = 2.0**-24
UNIT_16 = 2.0**-16


@cache
def search_table(dims: int, radius: float) -> tuple[NDArray[np.int32], NDArray[np.float32]]:
    """Return the cells within ``radius`` of some position as (offsets (N, 3), bounds (N,)), nearest first.

    Offsets are relative to the position's own cell, counted towards the nearer side of each axis.
    """
    rows = []
    for offset in itertools.product(AXIS_BOUND, repeat=dims):
        bound = math.sqrt(sum(AXIS_BOUND[o] ** 2 for o in offset))
        if bound < radius:
            rows.append((bound, tuple(offset) + (0,) * (3 - dims)))
    rows.sort(key=lambda row: (row[0], row[1]))
    offsets = np.array([row[1] for row in rows], dtype=np.int32)
    bounds = np.array([row[0] for row in rows], dtype=np.float32)
    return offsets, bounds


def cell_hash(ix: Any, iy: Any, iz: Any, salt: Any) -> tuple[Any, Any, Any, Any]:
    """Return four well-mixed 32-bit words for the cell (ix, iy, iz) under ``salt`` (all UInt arrays)."""
    a, b, c, d = (v * PCG_MULTIPLIER + PCG_INCREMENT for v in (ix, iy, iz, salt))
    a, b, c, d = _mix(a, b, c, d)
    a, b, c, d = a ^ (a >> 16), b ^ (b >> 16), c ^ (c >> 16), d ^ (d >> 16)
    return _mix(a, b, c, d)


def _mix(a: Any, b: Any, c: Any, d: Any) -> tuple[Any, Any, Any, Any]:
    a = a + b * d
    b = b + c * a
    c = c + a * b
    d = d + b * c
    return a, b, c, d


def unit(word: Any, float_type: Any) -> Any:
    """Return the upper 24 bits of a hash word as a number in [0, 1), exact in single precision."""
    return float_type(word >> 8) * UNIT_24


def feature_point(cell: tuple[Any, Any, Any], salt: Any, dims: int, float_type: Any) -> tuple[tuple[Any, ...], Any]:
    """Return (position inside the cell as ``dims`` numbers in [0, 1), spare hash word) for integer cells."""
    ix, iy, iz = (dr.reinterpret_array(type(salt), v) for v in cell)
    a, b, c, d = cell_hash(ix, iy, iz, salt)
    jitter = (unit(a, float_type), unit(b, float_type), unit(c, float_type))
    return jitter[:dims], d


class Neighbourhood:
    """Positions split into own cell, remainder and nearer side, and the cells around in a table's order."""

    def __init__(self, x: tuple[Any, ...], salt: Any, radius: float) -> None:
        self.dims = len(x)
        self.float_type: Any = type(x[0])
        self.int_type: Any = dr.int32_array_t(self.float_type)
        floors = [dr.floor(dr.detach(v)) for v in x]
        self.own = [self.int_type(f) for f in floors]
        self.rest = [v - f for v, f in zip(x, floors, strict=True)]
        self.side = [dr.select(dr.detach(r) < 0.5, self.int_type(-1), self.int_type(1)) for r in self.rest]
        self.salt = salt
        offsets, bounds = search_table(self.dims, radius)
        self.count = len(bounds)
        self._offsets = [self.int_type(np.ascontiguousarray(offsets[:, a])) for a in range(self.dims)]
        # One entry more, beyond any distance, so that the loop may look one cell ahead.
        self._bounds = self.float_type(np.append(bounds, np.float32(FAR)))

    def bound(self, index: Any) -> Any:
        """Least distance from the position to table entry ``index`` and all after it."""
        return dr.gather(self.float_type, self._bounds, index)

    def vector(self, index: Any, active: Any = True) -> tuple[tuple[Any, ...], Any]:
        """Return (feature point minus position, spare hash word) for table entry ``index``."""
        cell = []
        shift = []
        for axis in range(self.dims):
            offset = dr.gather(self.int_type, self._offsets[axis], index, active) * self.side[axis]
            cell.append(self.own[axis] + offset)
            shift.append(self.float_type(offset))
        while len(cell) < 3:
            cell.append(dr.zeros(self.int_type))
        jitter, word = feature_point((cell[0], cell[1], cell[2]), self.salt, self.dims, self.float_type)
        return tuple(s + j - r for s, j, r in zip(shift, jitter, self.rest, strict=True)), word


def nearest_points(x: tuple[Any, ...], salt: Any, needed: Any = RANKS) -> tuple[list[Any], list[Any], Neighbourhood]:
    """Return the four closest feature points to ``x``: (distances, table indices, their Neighbourhood).

    ``needed`` (1 to 4) is how many of the four must be exact; fewer is faster. Distances are ordered;
    identities are found without gradients, since which point is nearest has none.
    """
    around = Neighbourhood(tuple(dr.detach(v) for v in x), salt, FOURTH_POINT_RADIUS[len(x)])
    float_type, uint_type = around.float_type, type(salt)
    needed = uint_type(needed)
    width = dr.width(x[0])
    state = (
        dr.zeros(uint_type, width),
        *(dr.full(float_type, FAR, width) for _ in range(RANKS)),
        *(dr.zeros(uint_type, width) for _ in range(RANKS)),
    )

    def wanted(d: tuple[Any, ...]) -> Any:
        return dr.select(needed == 1, d[0], dr.select(needed == 2, d[1], dr.select(needed == 3, d[2], d[3])))

    def condition(index: Any, *best: Any) -> Any:
        bound = around.bound(index)
        return (index < around.count) & (dr.square(bound) < wanted(best[:RANKS]))

    def body(index: Any, *best: Any) -> tuple[Any, ...]:
        vector, _ = around.vector(index)
        distance = vector[0] * vector[0]
        for component in vector[1:]:
            distance = dr.fma(component, component, distance)
        squares, indices = list(best[:RANKS]), list(best[RANKS:])
        candidate, candidate_index = distance, index
        for rank in range(RANKS):
            square, known = squares[rank], indices[rank]
            closer = candidate < square
            squares[rank], candidate = (
                dr.select(closer, candidate, square),
                dr.select(closer, square, candidate),
            )
            indices[rank] = dr.select(closer, candidate_index, known)
            candidate_index = dr.select(closer, known, candidate_index)
        return (index + 1, *squares, *indices)

    result = dr.while_loop(state, condition, body, label="nearest feature points")
    squares, indices = list(result[1 : 1 + RANKS]), list(result[1 + RANKS :])
    return [dr.sqrt(s) for s in squares], indices, around
