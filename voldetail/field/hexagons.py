"""Endless pictures from one: parts of it at random places on a lattice of triangles, blended so that variance and histogram stay.

After Heitz and Neyret, "High-performance by-example noise using a histogram-preserving blending operator" (2018), with the
sharper weights of Mikkelsen, "Practical real-time hex-tiling" (2022).

Symbols
    v_k   the three corners of the triangle of the lattice that a point lies in
    b_k   its barycentric coordinates there, sum 1
    w_k   b_k^4, divided by their sum: the larger the exponent, the less of the plane is a mixture. Looked at on gravel alone
    m_k   where in the picture the corner's part is taken from, hashed
    g_k   the Gaussian score of the picture at m_k + (x - v_k)
    g     sum_k w_k g_k / sqrt(sum_k w_k^2), of the same mean (0) and variance as each g_k
"""

from __future__ import annotations

import math
from typing import Any

import drjit as dr

from voldetail.noise.lattice import UNIT_24, cell_hash

EDGE_SHARE = 0.3
"""Edge of the lattice's triangles over the shorter side of the picture: a part reaches one edge from its corner, and so twice
that has to fit into the picture. Larger parts keep more of what is large, smaller ones repeat less visibly."""


def corners(x: Any, y: Any, edge: Any) -> tuple[list[tuple[Any, Any]], list[Any]]:
    """Return the (column, row) words of the three corners about the points (x, y), and the weights w_k, sum 1.

    edge: of the triangles, in the unit of x and y. The lattice is that of equilateral triangles: its axes are (1, 0) and
    (1/2, sqrt(3)/2) times the edge.
    """
    float_type: Any = type(x)
    int_type, uint_type = dr.int32_array_t(float_type), dr.uint32_array_t(float_type)
    row = y * (2.0 / math.sqrt(3.0)) / edge
    column = x / edge - 0.5 * row
    first, second = dr.floor(column), dr.floor(row)
    u, v = column - first, row - second
    upper = u + v > 1.0
    weights = [dr.select(upper, 1.0 - v, u), dr.select(upper, 1.0 - u, v), dr.abs(1.0 - u - v)]
    i, j = int_type(first), int_type(second)
    places = [(i + 1, j), (i, j + 1), (dr.select(upper, i + 1, i), dr.select(upper, j + 1, j))]
    sharp = [dr.square(dr.square(w)) for w in weights]
    total = 1.0 / (sharp[0] + sharp[1] + sharp[2])
    words = [(dr.reinterpret_array(uint_type, a), dr.reinterpret_array(uint_type, b)) for a, b in places]
    return words, [w * total for w in sharp]


def offset_from(word: tuple[Any, Any], x: Any, y: Any, edge: Any) -> tuple[Any, Any]:
    """Return (x, y) relative to the corner ``word`` of the lattice."""
    float_type: Any = type(x)
    int_type = dr.int32_array_t(float_type)
    i, j = (float_type(dr.reinterpret_array(int_type, w)) for w in word)
    return x - (i + 0.5 * j) * edge, y - j * (0.5 * math.sqrt(3.0)) * edge


def hashed_place(word: tuple[Any, Any], plane: int, seed: Any) -> tuple[Any, Any]:
    """Return two floats, uniform in [0, 1), for the corner ``word`` of the lattice on ``plane`` (0, 1, 2) under ``seed``."""
    uint_type = type(seed)
    a, b, _, _ = cell_hash(word[0], word[1], uint_type(plane), seed)
    float_type: Any = dr.float32_array_t(uint_type)
    return float_type(a >> 8) * UNIT_24, float_type(b >> 8) * UNIT_24
