"""Stones that lie on each other: one octave in which the highest kernel alone counts, instead of GD10's sum.

The sum of eq. 2 blends what it joins, and cells of nearest points (Worley 1996) fit together like paving. Stones do
neither: each has its own shape and turn, and where two meet, one hides the other. So each feature point carries a
convex body, and the relief is the upper hull of all of them.

Symbols
    N(x)    max(0, max_i 1 - (g_i(x - P_i) / rho_i)^p)     p = 1 pointed, 2 round tops
    g_i     (1 - b) |w|_2 + b C max(|w|_inf, |w|_1 / A),   w = T_i Q_i (x - P_i)
    Q_i     a hashed rotation: no two bodies lie alike
    T_i     diag(1, 1 + (e - 1) u, 1 + (e - 1) u'), hashed: shorter along two of the body's axes
    rho_i   R (1 - s u''), hashed: its size                R     STONE_RADIUS, support in cells
    b, e, s facets, elongation, size spread
    C, A    a ball whose corners were cut: C makes it lie inside the round one, so that g >= |x - P|

N is continuous, being the largest of continuous kernels that reach zero inside the support, and the same to the bit for
any order of evaluation, being a maximum.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import drjit as dr

from voldetail.noise.lattice import Neighbourhood
from voldetail.noise.numbers import Numbers

STONE_RADIUS = {2: 1.8, 3: 1.8}
"""Support in cells, within the two cells each way that the search table covers: wide enough that among stones up to 2.2
times as long as thick, the smallest 0.45 of the largest, the ground shows on less than 3 % of a plane and 2 % in space."""

CUT = 1.5
"""A: where the corners are cut. 1 leaves an octahedron, the number of dimensions the whole cube."""

CORNER = math.hypot(1.0, CUT - 1.0)
"""C: distance of the cut body's corners (1, A - 1, 0) from its middle."""

SHAPE_SALT = 0x2C1B3C6D
"""Multiplies the spare hash word for the numbers that turn and size a body; odd, else arbitrary."""

UNIT_8 = 2.0**-8
"""Turns and sizes are drawn in 256 steps: two words serve all seven numbers of a body."""


@dataclass(frozen=True)
class StoneShape(Numbers):
    """Numbers of the bodies: facets b, elongation e, size spread s."""

    facets: Any
    elongation: Any
    size_spread: Any


def highest_stone(x: tuple[Any, ...], salt: Any, shape: StoneShape, rounded: bool) -> tuple[Any, Any]:
    """Return (N(x), the word of the stone on top) for ``x`` in cells; see the top of this file."""
    radius = STONE_RADIUS[len(x)]
    around = Neighbourhood(x, salt, radius)
    uint_type, float_type = type(salt), around.float_type
    width = dr.width(x[0])

    def reachable(index: Any) -> Any:
        share = around.bound(index) * (1.0 / radius)
        return 1.0 - (dr.square(share) if rounded else share)

    def body(index: Any, best: Any, owner: Any) -> tuple[Any, Any, Any]:
        vector, word = around.vector(index)
        share = _gauge(vector, word, float_type, shape) * (1.0 / radius)
        height = 1.0 - (dr.square(share) if rounded else share)
        higher = height > best
        return index + 1, dr.select(higher, height, best), dr.select(higher, word, owner)

    _, best, owner = dr.while_loop(
        (dr.zeros(uint_type, width), dr.zeros(float_type, width), dr.zeros(uint_type, width)),
        lambda index, best, owner: (index < around.count) & (dr.detach(best) < reachable(index)),
        body,
        max_iterations=around.count,
        label="highest stone",
    )
    return best, owner


def _gauge(vector: tuple[Any, ...], word: Any, float_type: Any, shape: StoneShape) -> Any:
    """Return g_i / (rho_i / R): 0 in the middle of the stone, R on its border."""
    mixed = (word ^ (word >> 15)) * SHAPE_SALT
    mixed = mixed ^ (mixed >> 13)

    def drawn(v: Any, byte: int) -> Any:
        return float_type((v >> (8 * byte)) & 0xFF) * UNIT_8

    size = 1.0 - shape.size_spread * drawn(mixed, 0)
    slender, flat = (1.0 + (shape.elongation - 1.0) * drawn(mixed, byte) for byte in (1, 2))
    if len(vector) == 2:
        s, c = dr.sincos((2.0 * math.pi) * drawn(word, 3))
        x, y = vector
        turned: tuple[Any, ...] = (x * c + y * s, (y * c - x * s) * slender)
    else:
        # 1/2 - 1/512 makes the four parts even about zero.
        x, y, z = _turned(vector, *(drawn(word, byte) - (0.5 - 0.5 * UNIT_8) for byte in range(4)))
        turned = (x, y * slender, z * flat)
    squares = sum(v * v for v in turned)
    sizes = [dr.abs(v) for v in turned]
    largest = sizes[0]
    for other in sizes[1:]:
        largest = dr.maximum(largest, other)
    angular = CORNER * dr.maximum(largest, sum(sizes) * (1.0 / CUT))
    smooth = dr.sqrt(dr.maximum(squares, 1e-12))
    return dr.lerp(smooth, angular, shape.facets) / size


def _turned(vector: tuple[Any, ...], r: Any, i: Any, j: Any, k: Any) -> tuple[Any, Any, Any]:
    """Return ``vector`` turned by the quaternion r + i, j, k of any length but 0."""
    x, y, z = vector
    length = r * r + i * i + j * j + k * k
    # v + 2 (r t + q x t) / |q|^2 with t = q x v: no square root, whose last bits could differ.
    tx, ty, tz = j * z - k * y, k * x - i * z, i * y - j * x
    f = 2.0 / length
    return (x + f * (r * tx + j * tz - k * ty), y + f * (r * ty + k * tx - i * tz), z + f * (r * tz + i * ty - j * tx))
