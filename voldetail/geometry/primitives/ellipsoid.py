"""An ellipsoid about the origin."""

from __future__ import annotations

import math

import numpy as np
import trimesh

from voldetail.geometry import signed_distance
from voldetail.geometry.primitives.primitive import Floats, Primitive, Skeleton


class Ellipsoid(Primitive):
    """An ellipsoid with the semi-axes of half its extent; a sphere where they are equal."""

    convex = True

    def skeleton(self) -> Skeleton:
        """Return an icosphere, stretched."""
        shape = trimesh.creation.icosphere(subdivisions=3, radius=1.0)
        return Skeleton(shape.vertices * self.half, np.asarray(shape.vertices), shape.faces.astype(np.int64))

    def on_surface(self, positions: Floats, normals: Floats) -> tuple[Floats, Floats]:
        """Return the points of the ellipsoid in the same direction, as the unit sphere has it, and its gradient there."""
        unit = positions / self.half
        unit = unit / np.linalg.norm(unit, axis=1, keepdims=True)
        return unit * self.half, unit / self.half

    def area(self) -> float:
        """Return that of the sphere with the mean square of the pairs' products, which is no smaller."""
        w, h, d = self.extent
        return math.pi * math.sqrt(((w * h) ** 2 + (h * d) ** 2 + (d * w) ** 2) / 3)

    def distance(self) -> signed_distance.Distance:
        """Return the distance to the closest point of the ellipsoid."""
        return signed_distance.ellipsoid((float(self.half[0]), float(self.half[1]), float(self.half[2])))


PRIMITIVE = Ellipsoid
