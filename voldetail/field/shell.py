"""The density of an object about its surface: what a hypertexture shifts (GD10 section 6; Perlin & Hoffert 1989).

Symbols
    P       a point in scene units          s(P)    its signed distance to the proxy, negative inside
    n(P)    the gradient of s, a unit vector that points outwards; the gradient of d points the other way, G = -n
    T       thickness of the shell, in scene units
    d(P)    1 - S(s / T + 1/2) with S(u) = 3 u^2 - 2 u^3, u clamped to [0, 1] (smoothstep)
    A       the furthest that a hypertexture will shift, in scene units

The shell lies half within the surface and half outside: d is 1 from T/2 below it, 1/2 on it, 0 from T/2 above it, with a
continuous slope. So the surface d = 1/2 is the proxy, and relief rises from there as displacement's does. GD10's points are
shifted along the gradient of d, which is zero outside the shell: there the shell has to be at least as thick as the shift.
Here the direction is n, which goes on outside: T decides only how soft matter is (a cloud's T is its size, a stone's a pixel
or two) and the box leaves room for A above the shell.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import drjit as dr
import numpy as np
from numpy.typing import NDArray

from voldetail.backend import mitsuba
from voldetail.errors import InputError
from voldetail.field.shell_grid import ShellPlan
from voldetail.geometry import signed_distance
from voldetail.geometry.density_grid import DensityGrid, split
from voldetail.geometry.mesh_distance import mesh_distance
from voldetail.geometry.primitives.primitive import primitive_of
from voldetail.geometry.proxy import rotation_matrix

TILE = 1 << 20
"""Cubes that are worked on at a time."""

Points = tuple[Any, ...]


@dataclass(frozen=True, eq=False)
class Shell:
    """The density of an object, at any point and on the grid of its plan.

    distance: s and n from a point in the object's own frame. turn: from that frame to the scene's axes.
    """

    plan: ShellPlan
    distance: signed_distance.Distance
    turn: NDArray[np.float64]

    def own(self, points: Points) -> Points:
        """Return the points of the scene in the object's own frame, in which the noise lives."""
        float_type: Any = type(points[0])
        if self.plan.proxy.rotation == (0.0, 0.0, 0.0):
            return tuple(v - dr.opaque(float_type, p) for v, p in zip(points, self.plan.proxy.position, strict=True))
        turn = [[dr.opaque(float_type, float(v)) for v in row] for row in self.turn]
        moved = [v - dr.opaque(float_type, p) for v, p in zip(points, self.plan.proxy.position, strict=True)]
        return tuple(sum(turn[row][axis] * moved[row] for row in range(3)) for axis in range(3))

    def to_scene(self, vector: Points) -> Points:
        """Return a direction of the object's own frame in the scene's axes."""
        if self.plan.proxy.rotation == (0.0, 0.0, 0.0):
            return vector
        float_type: Any = type(vector[0])
        turn = [[dr.opaque(float_type, float(v)) for v in row] for row in self.turn]
        return tuple(sum(turn[row][axis] * vector[axis] for axis in range(3)) for row in range(3))

    def profile(self, height: Any) -> Any:
        """Return d at a signed distance of ``height``."""
        float_type: Any = type(height)
        u = dr.clip(height * dr.opaque(float_type, 1.0 / self.plan.thickness) + 0.5, 0.0, 1.0)
        return 1.0 - u * u * (3.0 - 2.0 * u)

    def slope(self, height: Any) -> Any:
        """Return the derivative of `profile`, never above 0."""
        inverse = dr.opaque(type(height), 1.0 / self.plan.thickness)
        u = dr.clip(height * inverse + 0.5, 0.0, 1.0)
        return -6.0 * u * (1.0 - u) * inverse

    def within(self, own: Points) -> Any:
        """Return where a point in the object's own frame belongs to it at all: a slab ends at its sides and its bottom."""
        if not primitive_of(self.plan.proxy).slab:
            return True
        float_type: Any = type(own[0])
        w, h = (dr.opaque(float_type, v / 2) for v in self.plan.proxy.extent[:2])
        return (dr.abs(own[0]) <= w) & (dr.abs(own[1]) <= h) & (own[2] >= dr.opaque(float_type, -self.plan.depth))

    def middles(self, index: Any) -> Points:
        """Return the middles of the cubes with the numbers ``index`` (x fastest), in scene units."""
        return self.middles_of(split(index, self.plan.shape))

    def middles_of(self, cells: Points) -> Points:
        """Return the middles of ``cells`` (column x, row y, slice z of the whole grid, or beside it), in scene units."""
        float_type: Any = mitsuba().Float
        edge = dr.opaque(float_type, self.plan.edge)
        # From the numbers in the whole grid: a block's middles are those of the grid to the bit.
        return tuple(
            dr.fma(float_type(cell) + 0.5, edge, dr.opaque(float_type, float(low)))
            for cell, low in zip(cells, self.plan.lower, strict=True)
        )

    def in_box(self, cells: Points) -> Any:
        """Return which of ``cells`` the plan's grid has."""
        inside = True
        for cell, count in zip(cells, reversed(self.plan.shape), strict=True):
            inside &= (cell >= 0) & (cell < dr.opaque(type(cell), count))
        return inside

    def tiles(self) -> list[Any]:
        """Return the numbers of the cubes, TILE at a time, not yet evaluated."""
        uint_type: Any = mitsuba().UInt32
        count = self.plan.cells
        return [dr.arange(uint_type, min(TILE, count - start)) + dr.opaque(uint_type, start) for start in range(0, count, TILE)]

    def density_at(self, points: Points) -> Any:
        """Return d at ``points`` of the scene."""
        own = self.own(points)
        return dr.select(self.within(own), self.profile(self.distance(own)[0]), 0.0)

    def grid(self, density: Any) -> DensityGrid:
        """Return ``density`` on the cubes of the plan as a record."""
        return DensityGrid(density, self.plan.shape, self.plan.lower, self.plan.edge)

    def bake(self) -> DensityGrid:
        """Return d on the cubes of the plan. Raises InputError where the plan is for tiles alone."""
        self.plan.check_dense()
        density = dr.zeros(mitsuba().Float, self.plan.cells)
        for index in self.tiles():
            dr.scatter(density, self.density_at(self.middles(index)), index)
            dr.eval(density)
        return self.grid(density)


def make_shell(plan: ShellPlan) -> Shell:
    """Return the shell of ``plan``; for a mesh this computes its distances on the grid, for the other shapes nothing yet.

    Raises InputError where the shell is thicker than the object, so that nothing of it would have density 1.
    """
    proxy = plan.proxy
    turn = rotation_matrix(proxy.rotation)
    shape = primitive_of(proxy)
    if shape.exact:
        return Shell(plan, shape.distance(), turn)
    return Shell(plan, _nowhere if plan.blocks else _mesh(plan, turn), turn)


def on_block(shell: Shell, first: tuple[int, int, int], values: NDArray[np.float32]) -> Shell:
    """Return ``shell`` with the distances ``values`` (nz, ny, nx) about a part of its grid from cube ``first`` (z, y, x) on."""
    plan, mi = shell.plan, mitsuba()
    x, y, z = (low + start * plan.edge for low, start in zip(plan.lower, reversed(first), strict=True))
    nz, ny, nx = values.shape
    in_scene = signed_distance.gridded(mi.Float(values.ravel()), (nz, ny, nx), (x, y, z), plan.edge)
    return replace(shell, distance=signed_distance.moved(in_scene, shell.turn, plan.proxy.position))


def _nowhere(points: Points) -> tuple[Any, Points]:
    raise InputError("The distances to a mesh on a grid this fine are known block by block only: make its surface by tiles.")


def _mesh(plan: ShellPlan, turn: NDArray[np.float64]) -> signed_distance.Distance:
    """Return the interpolated distance to the mesh, in the mesh's own frame."""
    assert plan.mesh is not None
    vertices = plan.mesh.vertices @ turn.T + np.asarray(plan.proxy.position)
    # Two cubes more, for the differences that give n at the edge of the band.
    inner = plan.thickness / 2 + 2 * plan.edge
    values = mesh_distance(vertices, plan.mesh.faces, plan.lower, plan.shape, plan.edge, (inner, inner + plan.amplitude))
    check_depth(plan, -float(values.min()))
    mi = mitsuba()
    in_scene = signed_distance.gridded(mi.Float(values.ravel()), plan.shape, plan.lower, plan.edge)
    return signed_distance.moved(in_scene, turn, plan.proxy.position)


def check_depth(plan: ShellPlan, deepest: float) -> None:
    """Refuse a shell that leaves nothing solid in a mesh whose deepest point is ``deepest`` scene units below its surface."""
    if deepest < plan.thickness / 2:
        raise InputError(
            f"The shell is {plan.thickness:g} scene units thick, but the mesh {plan.proxy.mesh} nowhere reaches half of that"
            f" inside (its deepest point on the grid is {max(deepest, 0.0):.3g} below the surface), so nothing of it would be"
            f" solid: use a thickness under {2 * max(deepest, 0.0):.3g}, or a finer grid."
        )
