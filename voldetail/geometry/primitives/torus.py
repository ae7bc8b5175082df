"""A ring about the z axis, which looks at the viewer through its hole.

Symbols
    r   radius of the tube, half the extent's depth          R   of the circle along its middle, half the width less r
    s   distance to the surface, sqrt((sqrt(x^2 + y^2) - R)^2 + z^2) - r: exact, since every meridian is a circle
"""

from __future__ import annotations

import math
from typing import Any

import drjit as dr
import numpy as np
import trimesh

from voldetail.geometry.primitives.primitive import Floats, Primitive, Skeleton
from voldetail.geometry.signed_distance import TINY, Distance
from voldetail.setup.proxy import ProxySetup

AROUND, ALONG = 32, 96
"""Sides of the tube and of the ring that are refined."""


class Torus(Primitive):
    """A torus as wide and high as its extent, its tube as thick as the extent is deep."""

    def __init__(self, proxy: ProxySetup) -> None:
        super().__init__(proxy)
        self.tube = proxy.extent[2] / 2
        self.ring = proxy.extent[0] / 2 - self.tube

    def skeleton(self) -> Skeleton:
        """Return a ring of quads."""
        shape = trimesh.creation.torus(self.ring, self.tube, major_sections=ALONG, minor_sections=AROUND)
        return Skeleton(np.asarray(shape.vertices), np.asarray(shape.vertex_normals), shape.faces.astype(np.int64))

    def _from_middle(self, positions: Floats) -> tuple[Floats, Floats]:
        """Return the closest points of the circle along the middle, and the vectors from there."""
        flat = positions * (1.0, 1.0, 0.0)
        middle = self.ring * flat / np.linalg.norm(flat, axis=1, keepdims=True)
        return middle, positions - middle

    def on_surface(self, positions: Floats, normals: Floats) -> tuple[Floats, Floats]:
        """Return the closest points of the tube."""
        middle, away = self._from_middle(positions)
        away = away / np.linalg.norm(away, axis=1, keepdims=True)
        return middle + self.tube * away, away

    def parameters(self, positions: Floats, uv: Floats | None) -> Floats:
        """Return the ways along the ring, of its middle, and around the tube."""
        radius = np.hypot(positions[:, 0], positions[:, 1])
        along = np.arctan2(positions[:, 1], positions[:, 0]) * self.ring
        return np.stack([along, np.arctan2(positions[:, 2], radius - self.ring) * self.tube], axis=1)

    def area(self) -> float:
        """Return 4 pi^2 R r (Pappus)."""
        return 4 * math.pi**2 * self.ring * self.tube

    def distance(self) -> Distance:
        """Return s and its gradient."""
        ring, tube = self.ring, self.tube

        def distance(p: tuple[Any, ...]) -> tuple[Any, tuple[Any, ...]]:
            x, y, z = p
            float_type: Any = type(x)
            radius = dr.maximum(dr.sqrt(x * x + y * y), TINY)
            beyond = radius - dr.opaque(float_type, ring)
            length = dr.maximum(dr.sqrt(beyond * beyond + z * z), TINY)
            flat = beyond / (length * radius)
            return length - dr.opaque(float_type, tube), (x * flat, y * flat, z / length)

        return distance


PRIMITIVE = Torus
