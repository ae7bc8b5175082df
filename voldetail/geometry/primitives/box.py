"""A box about the origin."""

from __future__ import annotations

import numpy as np
import trimesh

from voldetail.geometry import signed_distance
from voldetail.geometry.primitives.primitive import Floats, Primitive, Skeleton

ON_SIDE = 1 - 1e-9
"""Share of the half extent from which a point is on a side, against rounding."""


class Box(Primitive):
    """A box of its extent, whose normals are rounded over at the edges alone."""

    convex = True

    def skeleton(self) -> Skeleton:
        """Return twelve triangles."""
        shape = trimesh.creation.box(extents=self.extent)
        return Skeleton(np.asarray(shape.vertices), np.asarray(shape.vertex_normals), shape.faces.astype(np.int64))

    def on_surface(self, positions: Floats, normals: Floats) -> tuple[Floats, Floats]:
        """Return the normal of the side, or the mean of the sides that meet.

        A midpoint's own mean would lean to the corners all over the sides.
        """
        return positions, np.sign(positions) * (np.abs(positions) >= self.half * ON_SIDE)

    def area(self) -> float:
        """Return that of the six sides."""
        w, h, d = self.extent
        return 2 * (w * h + h * d + d * w)

    def distance(self) -> signed_distance.Distance:
        """Return the distance to the box."""
        return signed_distance.box((float(self.half[0]), float(self.half[1]), float(self.half[2])))


PRIMITIVE = Box
