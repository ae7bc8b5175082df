"""Exact signed distances to the simple shapes, and to a grid of them, on Dr.Jit arrays; negative inside.

Symbols
    p       a point in the shape's own frame, whose origin is the shape's centre
    s(p)    distance from p to the surface, negative inside      n(p)    its gradient, a unit vector that points outwards
    e_i     semi-axes of an ellipsoid      q    the point of its surface closest to p

Where a point is equally close to two parts of the surface n jumps; one of the two directions is returned there.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import drjit as dr
import numpy as np
from numpy.typing import NDArray

from voldetail.backend import mitsuba
from voldetail.geometry.lookup import Lookup

Distance = Callable[[tuple[Any, ...]], tuple[Any, tuple[Any, ...]]]
"""From a point (x, y, z) in the shape's own frame to (s, n)."""

NEWTON_STEPS = 24
"""Of the root in `_ellipse`: in double precision 8 do for points about the surface; flat shapes (20 : 1) need 20."""

TINY = 1e-12
"""Least length that is divided by."""


def plane() -> Distance:
    """Return the distance to the plane z = 0, with all that is below it inside."""

    def distance(p: tuple[Any, ...]) -> tuple[Any, tuple[Any, ...]]:
        zero = dr.zeros(type(p[2]), dr.width(p[2]))
        return p[2] + zero, (zero, zero, zero + 1.0)

    return distance


def ellipsoid(half: tuple[float, float, float]) -> Distance:
    """Return the distance to an ellipsoid with semi-axes ``half``; a sphere where they are equal."""
    if half[0] == half[1] == half[2]:

        def sphere(p: tuple[Any, ...]) -> tuple[Any, tuple[Any, ...]]:
            length = _length(p)
            inverse = 1.0 / dr.maximum(length, TINY)
            return length - dr.opaque(type(length), half[0]), tuple(v * inverse for v in p)

        return sphere
    return lambda p: _ellipse(p, half)


def box(half: tuple[float, float, float]) -> Distance:
    """Return the distance to a box that reaches ``half`` to each side."""
    return lambda p: _join([_pair(v, h) for v, h in zip(p, half, strict=True)])


def cylinder(half: tuple[float, float, float]) -> Distance:
    """Return the distance to a cylinder about the y axis: ``half`` are its radii along x and z and half its height."""

    def distance(p: tuple[Any, ...]) -> tuple[Any, tuple[Any, ...]]:
        flat, radii = (p[0], p[2]), (half[0], half[2])
        if radii[0] == radii[1]:
            length = _length(flat)
            inverse = 1.0 / dr.maximum(length, TINY)
            side: tuple[Any, tuple[Any, ...]] = length - dr.opaque(type(length), radii[0]), tuple(v * inverse for v in flat)
        else:
            side = _ellipse(flat, radii)
        s, (nx, nz, ny) = _join([side, _pair(p[1], half[1])])
        return s, (nx, ny, nz)

    return distance


def gridded(values: Any, shape: tuple[int, int, int], lower: tuple[float, float, float], edge: float) -> Distance:
    """Return the trilinear interpolation of ``values`` (nz ny nx, x fastest) at the middles of cubes from ``lower``.

    n is the normalised central difference over two cubes: that of the interpolation itself would jump between cubes.
    Outside the middles the nearest value holds.
    """

    lookup = Lookup(values, 1, shape, lower, edge)

    def at(p: tuple[Any, ...]) -> Any:
        return lookup.at(mitsuba().Point3f(*p))

    def distance(p: tuple[Any, ...]) -> tuple[Any, tuple[Any, ...]]:
        step = dr.opaque(type(p[0]), edge)
        slopes = []
        for axis in range(3):
            ahead, behind = (tuple(v + sign * step if i == axis else v for i, v in enumerate(p)) for sign in (1.0, -1.0))
            slopes.append(at(ahead) - at(behind))
        inverse = 1.0 / dr.maximum(_length(tuple(slopes)), TINY)
        return at(p), tuple(v * inverse for v in slopes)

    return distance


def moved(distance: Distance, turn: NDArray[np.float64], position: tuple[float, float, float]) -> Distance:
    """Return ``distance``, given in the scene, for points of a frame that is turned by ``turn``, then moved by ``position``."""

    def of_own(p: tuple[Any, ...]) -> tuple[Any, tuple[Any, ...]]:
        float_type: Any = type(p[0])
        rows = [[dr.opaque(float_type, float(v)) for v in row] for row in turn]
        placed = tuple(
            sum(row[axis] * p[axis] for axis in range(3)) + dr.opaque(float_type, offset)
            for row, offset in zip(rows, position, strict=True)
        )
        s, n = distance(placed)
        return s, tuple(sum(rows[row][axis] * n[row] for row in range(3)) for axis in range(3))

    return of_own


def _pair(v: Any, half: float) -> tuple[Any, tuple[Any, ...]]:
    """Return the distance to the two planes at +-``half`` of an axis."""
    return dr.abs(v) - dr.opaque(type(v), half), (dr.copysign(type(v)(1.0), v),)


def _join(parts: list[tuple[Any, tuple[Any, ...]]]) -> tuple[Any, tuple[Any, ...]]:
    """Return the distance to the body that lies within all ``parts``, each of coordinates of its own (a product of bodies).

    Outside several of them the closest point is on an edge, sqrt(sum of max(s_i, 0)^2) away; inside all of them it is on
    the closest surface.
    """
    over = [dr.maximum(s, 0.0) for s, _ in parts]
    outside = _length(tuple(over))
    inside = parts[0][0]
    for s, _ in parts[1:]:
        inside = dr.maximum(inside, s)
    out = inside > 0.0
    inverse = 1.0 / dr.maximum(outside, TINY)
    direction: list[Any] = []
    taken: Any = out
    for (s, n), o in zip(parts, over, strict=True):
        # Of equally close sides the first: n stays a unit vector.
        mine = ~taken & (s == inside)
        taken = taken | mine
        direction += [v * dr.select(out, o * inverse, dr.select(mine, 1.0, 0.0)) for v in n]
    return dr.select(out, outside, inside), tuple(direction)


def _ellipse(p: tuple[Any, ...], half: tuple[float, ...]) -> tuple[Any, tuple[Any, ...]]:
    """Return the distance to an ellipse or ellipsoid (Eberly 2013, "Distance from a point to an ellipse, an ellipsoid").

    The closest point is q_i = e_i^2 p_i / (t + e_i^2) with F(t) = sum (e_i p_i / (t + e_i^2))^2 - 1 = 0 at the largest root.
    F falls and is convex beyond t_0 = max(e_i |p_i| - e_i^2), where it is not negative: from there Newton's steps grow
    towards the root and never pass it.
    """
    float_type: Any = type(p[0])
    # Double: t + e^2 cancels close to the axes.
    double: Any = dr.float64_array_t(float_type)
    axes = [dr.opaque(double, e) for e in half]
    y = [dr.maximum(dr.abs(double(dr.detach(v))), 1e-9 * e) for v, e in zip(p, axes, strict=True)]
    t = axes[0] * y[0] - dr.square(axes[0])
    for e, v in zip(axes[1:], y[1:], strict=True):
        t = dr.maximum(t, e * v - dr.square(e))

    def step(count: Any, t: Any) -> tuple[Any, Any]:
        value, slope = double(-1.0), double(0.0)
        for e, v in zip(axes, y, strict=True):
            inverse = 1.0 / (t + dr.square(e))
            square = dr.square(e * v * inverse)
            value, slope = value + square, slope - 2.0 * square * inverse
        return count + 1, t - value / slope

    uint_type = dr.uint32_array_t(float_type)
    _, t = dr.while_loop(
        (dr.zeros(uint_type, dr.width(t)), t), lambda count, t: count < NEWTON_STEPS, step, label="closest point"
    )
    normal = [v / (t + dr.square(e)) for e, v in zip(axes, y, strict=True)]
    inverse = 1.0 / dr.maximum(_length(tuple(normal)), 1e-300)
    normal = [v * inverse for v in normal]
    # Along the normal, and not as a length: the sign comes with it.
    s = sum(n * (v - dr.square(e) * v / (t + dr.square(e))) for n, v, e in zip(normal, y, axes, strict=True))
    return float_type(s), tuple(dr.copysign(float_type(n), v) for n, v in zip(normal, p, strict=True))


def _length(vector: tuple[Any, ...]) -> Any:
    squared = vector[0] * vector[0]
    for v in vector[1:]:
        squared = dr.fma(v, v, squared)
    return dr.sqrt(squared)
