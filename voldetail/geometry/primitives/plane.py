"""A rectangle that faces +z, and the top of a slab."""

from __future__ import annotations

import numpy as np

from voldetail.geometry import signed_distance
from voldetail.geometry.primitives.primitive import Floats, Primitive, Skeleton, box_corners


class Plane(Primitive):
    """The plane z = 0, as wide and as high as its extent."""

    slab = True

    def skeleton(self) -> Skeleton:
        """Return two triangles."""
        w, h, _ = self.half
        positions = np.array([[-w, -h, 0.0], [w, -h, 0.0], [w, h, 0.0], [-w, h, 0.0]])
        return Skeleton(positions, np.tile([0.0, 0.0, 1.0], (4, 1)), np.array([[0, 1, 2], [0, 2, 3]]))

    def area(self) -> float:
        """Return width times height."""
        return self.extent[0] * self.extent[1]

    def distance(self) -> signed_distance.Distance:
        """Return z, with all that is below inside."""
        return signed_distance.plane()

    def thinnest(self) -> float | None:
        """Return None: what is below it has no end."""
        return None

    def hull(self, depth: float, above: float) -> tuple[Floats, float]:
        """Return the box of the slab and of the room above it; beside it there is nothing."""
        w, h, _ = self.half
        return box_corners(np.array([-w, -h, -depth]), np.array([w, h, above])), 0.0


PRIMITIVE = Plane
