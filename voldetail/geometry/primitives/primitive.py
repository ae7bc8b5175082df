"""What every kind of shape tells of itself, and the one way to get it."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from importlib import import_module
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from voldetail.geometry.meshes import Mesh
from voldetail.geometry.signed_distance import Distance
from voldetail.setup.proxy import ProxySetup
from voldetail.setup.shapes import SHAPES
from voldetail.types import Floats


@dataclass(frozen=True, eq=False)
class Skeleton:
    """A shape as few triangles: positions (V, 3), normals (V, 3), faces (F, 3); uv (V, 2) where it has any; notes of a file."""

    positions: Floats
    normals: Floats
    faces: NDArray[np.int64]
    uv: Floats | None = None
    notes: tuple[str, ...] = ()


class Primitive(ABC):
    """A kind of shape of the extents of ``proxy``, in its own frame, its middle at the origin.

    convex: whether a face that looks away is never seen past another. slab: whether it is the top of matter that fills all
    below it. exact: whether `distance` is known in closed form; else it is that of a mesh.
    """

    convex: ClassVar[bool] = False
    slab: ClassVar[bool] = False
    exact: ClassVar[bool] = True

    def __init__(self, proxy: ProxySetup) -> None:
        self.proxy, self.extent = proxy, proxy.extent
        self.half: Floats = np.asarray(proxy.extent) / 2

    @abstractmethod
    def skeleton(self) -> Skeleton:
        """Return the shape as triangles whose edges are still long."""

    @abstractmethod
    def area(self) -> float:
        """Return the area of the surface in square scene units, or somewhat more."""

    def distance(self) -> Distance:
        """Return the signed distance in closed form. Raises TypeError for a shape that has none (see ``exact``)."""
        raise TypeError(f"the distance to a {self.proxy.kind} has no closed form")

    def on_surface(self, positions: Floats, normals: Floats) -> tuple[Floats, Floats]:
        """Return the midpoints of edges put back on a curved shape, and the exact normals there, of any length."""
        return positions, normals

    def parameters(self, positions: Floats, uv: Floats | None) -> Floats:
        """Return two coordinates (V, 2) of the surface, in scene units: (x, y) where a shape knows no better."""
        return positions[:, :2]

    def thinnest(self) -> float | None:
        """Return how thick the shape is where it is thinnest, None where that is not known before distances are."""
        return min(self.extent)

    def mesh(self) -> Mesh | None:
        """Return the closed mesh that the shape is read from, None where it is not. Raises InputError for an open one."""
        return None

    def hull(self, depth: float, above: float) -> tuple[Floats, float]:
        """Return points (N, 3) whose bounds, however they are turned, hold the shape, and the room a shell needs about them.

        depth, above: how far a slab reaches below its top, and what is needed over it.
        """
        return box_corners(-self.half, self.half), above


def box_corners(low: Floats, high: Floats) -> Floats:
    """Return the eight corners (8, 3) of a box."""
    return np.array([[(low, high)[bit >> axis & 1][axis] for axis in range(3)] for bit in range(8)])


def primitive_of(proxy: ProxySetup) -> Primitive:
    """Return the shape of ``proxy``: an instance of the class PRIMITIVE in the module that has the kind's name.

    Raises ValueError for a kind that the table (setup.shapes) does not have.
    """
    if proxy.kind not in SHAPES:
        raise ValueError(f"there is no kind of shape {proxy.kind!r}; known are {', '.join(SHAPES)}")
    module = import_module(f"voldetail.geometry.primitives.{proxy.kind}")
    shape: Primitive = module.PRIMITIVE(proxy)
    return shape
