"""The simple shapes that stand for the photographed object, tessellated to about a pixel."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from voldetail.geometry.primitives.primitive import primitive_of
from voldetail.geometry.tessellate import MAXIMUM_FACES, split_long_edges
from voldetail.setup.proxy import ProxySetup
from voldetail.setup.view import View

SOLID = "solid"

AWAY = -0.7
"""z of a normal below which a face of a convex shape faces away, whatever relief (slopes up to 45 degrees) is on it."""


@dataclass(frozen=True)
class Proxy:
    """A triangle mesh before displacement.

    positions (V, 3) and unit normals (V, 3) in scene units; faces (F, 3); domain (V, 3): where the noise is evaluated,
    for solid noise the position in the object's own frame, for surface noise its two parameters in scene units (and 0).
    own_normals (V, 3): before the object was turned. notes: what had to be mended in a mesh file.
    """

    positions: NDArray[np.float32]
    normals: NDArray[np.float32]
    faces: NDArray[np.uint32]
    domain: NDArray[np.float32]
    own_normals: NDArray[np.float32]
    notes: tuple[str, ...] = ()


def make_proxy(setup: ProxySetup, edge: float, domain: str = "solid", limit: int = MAXIMUM_FACES) -> Proxy:
    """Return the proxy of ``setup`` with edges of at most ``edge`` scene units (as far as ``limit`` faces allow).

    Raises InputError for a mesh that cannot be used.
    """
    shape = primitive_of(setup)
    bare = shape.skeleton()
    columns = [bare.positions, bare.normals] + ([bare.uv] if bare.uv is not None else [])
    table, faces = split_long_edges(np.concatenate(columns, axis=1), bare.faces, edge, limit)
    positions, normals = shape.on_surface(table[:, :3], table[:, 3:6])
    length = np.linalg.norm(normals, axis=1, keepdims=True)
    normals = normals / np.where(length > 0, length, 1.0)
    coordinates = positions
    if domain != SOLID:
        coordinates = np.zeros_like(positions)
        coordinates[:, :2] = shape.parameters(positions, table[:, 6:8] if bare.uv is not None else None)
    turn = rotation_matrix(setup.rotation)
    return Proxy(
        positions=(positions @ turn.T + np.asarray(setup.position)).astype(np.float32),
        normals=(normals @ turn.T).astype(np.float32),
        faces=faces.astype(np.uint32),
        domain=coordinates.astype(np.float32),
        own_normals=normals.astype(np.float32),
        notes=bare.notes,
    )


def rotation_matrix(degrees: tuple[float, float, float]) -> NDArray[np.float64]:
    """Return the matrix that turns about x, then y, then z."""
    ax, ay, az = (math.radians(v) for v in degrees)
    cx, sx, cy, sy, cz, sz = math.cos(ax), math.sin(ax), math.cos(ay), math.sin(ay), math.cos(az), math.sin(az)
    about_x = np.array([[1, 0, 0], [0, cx, -sx], [0, sx, cx]])
    about_y = np.array([[cy, 0, sy], [0, 1, 0], [-sy, 0, cy]])
    about_z = np.array([[cz, -sz, 0], [sz, cz, 0], [0, 0, 1]])
    return np.asarray(about_z @ about_y @ about_x)


def seen_part(proxy: Proxy, view: View, margin: float, *, convex: bool) -> Proxy:
    """Return ``proxy`` without the faces that a parallel ``view`` cannot see: more than ``margin`` beside its window.

    Of a ``convex`` shape those that face away go too. What is left shows the same and casts the same shadows, but for
    those that come from further away than the margin.
    """
    x, y = proxy.positions[:, 0], proxy.positions[:, 1]
    near = (x >= view.left - margin) & (x <= view.right + margin) & (y >= view.bottom - margin) & (y <= view.top + margin)
    if convex:
        near &= proxy.normals[:, 2] > AWAY
    faces = proxy.faces[near[proxy.faces].any(axis=1)]
    if len(faces) in (0, len(proxy.faces)):
        return proxy
    used, compact = np.unique(faces, return_inverse=True)
    return replace(
        proxy,
        positions=proxy.positions[used],
        normals=proxy.normals[used],
        domain=proxy.domain[used],
        own_normals=proxy.own_normals[used],
        faces=compact.reshape(-1, 3).astype(np.uint32),
    )
