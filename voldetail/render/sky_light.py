"""The uniform sky inside a density: how much of it each place sees, to first order in direction.

    V(w) = a + b . w,    a = mean_k T_k,    b = 3 mean_k T_k w_k

T_k: transmittance towards the sky in direction w_k, one of the twelve corners of an icosahedron (they integrate
polynomials to degree 5 exactly, so a and b are the first two orders of spherical harmonics). A surface with normal n
then sees the cosine-weighted share  a + 2/3 b . n  (Ramamoorthi & Hanrahan 2001: the factors 1 and 2/3): 1 on a
bare plane, where a = 1/2 and b = 3/4 n, and 1 where nothing is in the way. A medium with mean cosine g seen from
direction v scatters  a - g b . v.

Made on a coarse copy of the grid: what hides the sky is soft, and no random direction is taken, so there is no grain.
"""

from __future__ import annotations

import math
import operator
from typing import Any

import drjit as dr
import numpy as np

from voldetail.backend import mitsuba
from voldetail.geometry.density_grid import DensityGrid, middles
from voldetail.geometry.lookup import Lookup, folded
from voldetail.render.optical_depth import LightDepth
from voldetail.setup.lamp import Lamp

COARSE = 32
"""Cells along the longest side of the coarse copy: the twelve sweeps then take 24 to 32 ms, for a grid of 64 cubed as for
one of 128, on which the one for the light takes 40."""

TURN = 0.4
"""Angle in radians by which the icosahedron is turned about z. Of those tried, the one whose directions lie furthest from
the planes of the box's faces, where a flat surface would half hide them: 9 degrees."""


class SkyLight:
    """Shares a and b of the sky over a grid's box, for one extinction; ``one_sided``: no sky below z = 0's plane."""

    def __init__(self, grid: DensityGrid, extinction: Any, one_sided: bool) -> None:
        mi = mitsuba()
        coarse = coarsened(grid, max(1, round(max(grid.shape) / COARSE)))
        centre = centres(coarse)
        total = [dr.zeros(mi.Float, dr.width(centre)) for _ in range(4)]
        directions = icosahedron()
        for direction in directions:
            if one_sided and direction[2] < 0:
                continue
            depth = LightDepth(coarse, Lamp(direction=direction)).at(centre)
            passed = dr.exp(-extinction * depth) * (1.0 / len(directions))
            weights = (*(3.0 * v for v in direction), 1.0)
            total = [t + passed * dr.opaque(mi.Float, w) for t, w in zip(total, weights, strict=True)]
            dr.eval(total)
        packed = dr.ravel(mi.Vector4f(*total))
        dr.eval(packed)
        self.edge = dr.opaque(mi.Float, coarse.edge)
        self._lookup = Lookup(packed, 4, coarse.shape, coarse.lower, coarse.edge)

    def on_surface(self, point: Any, normal: Any, active: Any = True) -> Any:
        """Return the cosine-weighted share of the sky about ``normal`` at ``point``; with normal 0 the even mean."""
        b, a = self._shares(point, active)
        return dr.clip(a + (2.0 / 3.0) * dr.dot(b, normal), 0.0, 1.0)

    def scattered(self, point: Any, towards_viewer: Any, asymmetry: Any, active: Any = True) -> Any:
        """Return the share of the sky that a medium of mean cosine ``asymmetry`` turns towards the viewer."""
        b, a = self._shares(point, active)
        return dr.maximum(a - asymmetry * dr.dot(b, towards_viewer), 0.0)

    def _shares(self, point: Any, active: Any) -> tuple[Any, Any]:
        found = self._lookup.at(point, active)
        return mitsuba().Vector3f(found.x, found.y, found.z), found.w


def coarsened(grid: DensityGrid, factor: int) -> DensityGrid:
    """Return the means over ``factor`` cubed cells; the last ones may reach beyond the box, where the density is 0."""
    if factor == 1:
        return grid
    total, shape = folded(grid.density, grid.shape, factor, range(factor), operator.add)
    return DensityGrid(total * (1.0 / factor**3), shape, grid.lower, grid.edge * factor)


def centres(grid: DensityGrid) -> Any:
    """Return the middles of the cells, x fastest."""
    mi = mitsuba()
    index = dr.arange(mi.UInt32, dr.width(grid.density))
    centre = mi.Point3f(*middles(index, grid.shape, grid.lower, grid.edge))
    dr.eval(centre)
    return centre


def icosahedron() -> list[tuple[float, float, float]]:
    """Return the corners of an icosahedron as unit vectors, an axis of threefold symmetry along z.

    So the six in front of the plane z = 0, all that a relief on it sees, lean to no side.
    """
    golden = (1.0 + math.sqrt(5.0)) / 2.0
    corners = [np.roll([0.0, one, other * golden], turn) for turn in range(3) for one in (1.0, -1.0) for other in (1.0, -1.0)]
    along = np.array([[1.0, -1.0, 0.0], [1.0, 1.0, -2.0], [1.0, 1.0, 1.0]])  # the last is the axis
    x, y, z = (along / np.linalg.norm(along, axis=1, keepdims=True)) @ np.array(corners).T / math.hypot(1.0, golden)
    c, s = math.cos(TURN), math.sin(TURN)
    return [(float(u), float(v), float(w)) for u, v, w in zip(c * x - s * y, s * x + c * y, z, strict=True)]
