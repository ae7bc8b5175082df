"""Plates: each cell of the coarsest octave lies at its own height and leans its own way, with a crack around it.

The kernels of GD10 eq. 2 give every cell the same dome. Dried mud, slate, flagstones, the plates of bark and broken
faces do not: each is a nearly flat piece, and neighbours differ. So the plane of the nearest feature point is added
to the octave, faded to nothing on the border of cells, where it would jump.

Symbols
    N'(x)   N(x) + fade(a) (o u_i + t (1/2 + g_i . (x - P_i)))      P_i the closest feature point
    o, t    height and tilt, in units of a kernel's height (tilt: per cell)
    u_i     hashed, uniform in [0, 1)
    g_i     hashed, uniform on the unit sphere; in 2D its shadow on the plane
    a       min_j e_ij / w, at most 1                               w   bevel, in cells
    e_ij    distance from x to the border with cell j: (|P_j - x|^2 - |P_i - x|^2) / (2 |P_j - P_i|)
    fade    a (2 - a): a sharp crack that meets the plate without an edge

u starts at 0 and tilted planes are lifted by t / 2, half a cell's fall, so that cracks lie below what they part. The
shadow of a point of the sphere is the same on every plane: the slopes within a surface follow one law, even in all
directions, for the solid and the surface domain and however the lattice is turned against the surface.

Why e_ij and not D_2 - D_1: the latter widens a crack towards its ends, and buries a cell whose neighbour's point is near.
No border nearer than w is missed: e_ij >= (D_j - D_1) / 2, so cells farther than D_1 + 2 w cannot matter, and
w is held below (REACH - D_1) / 2, which only positions more than 1.4 cells from every point could notice.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import drjit as dr

from voldetail.noise.lattice import Neighbourhood
from voldetail.noise.numbers import Numbers

REACH = 2.0
"""Cells nearer than this are all in the search table, which has two each way."""

PLATE_SALT = 0x3C6EF35F
"""Multiplies the spare hash word for a plate's numbers, apart from its albedo's and stripes'; odd, else arbitrary."""

LEAST_SQUARE = 1e-12
"""Least squared distance under a root, as in noise.gabor."""


@dataclass(frozen=True)
class PlateShape(Numbers):
    """Numbers of the plates: height o, tilt t, bevel w."""

    cell_height: Any
    cell_tilt: Any
    bevel: Any


def plate(x: tuple[Any, ...], salt: Any, nearest: Any, shape: PlateShape) -> Any:
    """Return what plates add to an octave at ``x`` in cells; ``nearest`` is the table index of the closest point."""
    around = Neighbourhood(x, salt, REACH)
    vector, word = around.vector(nearest)
    distance = dr.sqrt(dr.maximum(_dot(vector, vector), LEAST_SQUARE))
    width = dr.minimum(shape.bevel, 0.5 * (REACH - distance))
    other = _other_side(x, salt, nearest, dr.detach(width))
    beyond, _ = around.vector(other)
    share = dr.select(other == nearest, 1.0, dr.clip(_to_border(vector, beyond) / width, 0.0, 1.0))
    height, direction = plate_numbers(word, around.float_type)
    # `vector` points from x to the feature point; the offset from the point is its negative.
    plane = shape.cell_height * height + shape.cell_tilt * (0.5 - _dot(direction[: len(x)], vector))
    return share * (2.0 - share) * plane


def plate_numbers(word: Any, float_type: Any) -> tuple[Any, tuple[Any, Any, Any]]:
    """Return a plate's u in [0, 1) and its unit vector g, from 12, 10 and 10 bits of its mixed hash word."""
    mixed = (word ^ (word >> 16)) * PLATE_SALT
    mixed = (mixed ^ (mixed >> 15)) * PLATE_SALT
    mixed = mixed ^ (mixed >> 16)
    height = float_type(mixed >> 20) * 2.0**-12
    # The middles of 1024 steps, so that the mean over all of them is zero.
    z = float_type((mixed >> 10) & 0x3FF) * 2.0**-9 - (1.0 - 2.0**-10)
    s, c = dr.sincos(float_type(mixed & 0x3FF) * (2.0 * math.pi * 2.0**-10))
    across = dr.sqrt(1.0 - z * z)
    return height, (across * c, across * s, z)


def _other_side(x: tuple[Any, ...], salt: Any, nearest: Any, width: Any) -> Any:
    """Return the table index of the cell beyond the nearest border within ``width``, or ``nearest`` if there is none."""
    around = Neighbourhood(tuple(dr.detach(v) for v in x), salt, REACH)
    vector, _ = around.vector(nearest)
    distance = dr.sqrt(_dot(vector, vector))

    def body(index: Any, best: Any, other: Any) -> tuple[Any, Any, Any]:
        beyond, _ = around.vector(index)
        border = _to_border(vector, beyond)
        closer = (border < best) & (index != nearest)
        return index + 1, dr.select(closer, border, best), dr.select(closer, index, other)

    _, _, other = dr.while_loop(
        (dr.zeros(type(salt), dr.width(x[0])), width + dr.zeros(around.float_type, dr.width(x[0])), type(salt)(nearest)),
        lambda index, best, other: (index < around.count) & (around.bound(index) < distance + 2.0 * best),
        body,
        label="border of the plate",
    )
    return other


def _to_border(vector: tuple[Any, ...], beyond: tuple[Any, ...]) -> Any:
    """Return e_ij, the distance to the plane midway between the two points; zero where they are one."""
    apart = tuple(b - v for b, v in zip(beyond, vector, strict=True))
    # |b|^2 - |v|^2 = (b - v) . (b + v), without the cancellation of two squares.
    total = _dot(apart, tuple(b + v for b, v in zip(beyond, vector, strict=True)))
    return total / (2.0 * dr.sqrt(dr.maximum(_dot(apart, apart), LEAST_SQUARE)))


def _dot(a: tuple[Any, ...], b: tuple[Any, ...]) -> Any:
    total = a[0] * b[0]
    for p, q in zip(a[1:], b[1:], strict=True):
        total = dr.fma(p, q, total)
    return total
