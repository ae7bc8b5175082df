"""The simple shapes that stand for the photographed object, tessellated to about a pixel."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
import trimesh
from numpy.typing import NDArray

from voldetail.geometry.meshes import load_mesh, normalise
from voldetail.geometry.tessellate import MAXIMUM_FACES, split_long_edges
from voldetail.setup.setup import ProxySetup
from voldetail.setup.view import View

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
    notes: tuple[str, ...] = ()
    uv: NDArray[np.float64] | None = None
    if setup.kind == "mesh":
        assert setup.mesh is not None
        mesh = normalise(load_mesh(setup.mesh), max(setup.extent))
        notes, uv = mesh.notes, mesh.uv
        positions, normals, faces = mesh.vertices, mesh.normals, mesh.faces.astype(np.int64)
    else:
        positions, normals, faces = _shape(setup.kind, setup.extent)
    columns = [positions, normals] + ([uv * 2.0] if uv is not None else [])
    table, faces = split_long_edges(np.concatenate(columns, axis=1), faces, edge, limit)
    positions, normals = _reproject(setup.kind, setup.extent, table[:, :3], table[:, 3:6])
    coordinates = _domain(setup, positions, table[:, 6:8] if uv is not None else None, domain)
    turn = rotation_matrix(setup.rotation)
    return Proxy(
        positions=(positions @ turn.T + np.asarray(setup.position)).astype(np.float32),
        normals=(normals @ turn.T).astype(np.float32),
        faces=faces.astype(np.uint32), domain=coordinates.astype(np.float32), own_normals=normals.astype(np.float32),
        notes=notes,
    )


def _shape(
    kind: str, extent: tuple[float, float, float]
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.int64]]:
    if kind == "plane":
        w, h = extent[0] / 2, extent[1] / 2
        positions = np.array([[-w, -h, 0.0], [w, -h, 0.0], [w, h, 0.0], [-w, h, 0.0]])
        return positions, np.tile([0.0, 0.0, 1.0], (4, 1)), np.array([[0, 1, 2], [0, 2, 3]])
    if kind in ("sphere", "ellipsoid"):
        shape = trimesh.creation.icosphere(subdivisions=3, radius=1.0)
        scaled = shape.vertices * (np.asarray(extent) / 2)
        return scaled, np.asarray(shape.vertices), shape.faces.astype(np.int64)
    if kind == "cylinder":
        shape = trimesh.creation.cylinder(radius=1.0, height=2.0, sections=96)
        # trimesh's axis is z; ours is y, the usual way a trunk or a column stands in a photo.
        turned = shape.vertices[:, [0, 2, 1]] * np.array([1.0, 1.0, -1.0])
        shape = trimesh.Trimesh(turned * (np.asarray(extent) / 2), shape.faces, process=False)
        return shape.vertices, shape.vertex_normals, shape.faces.astype(np.int64)
    shape = trimesh.creation.box(extents=extent)
    return np.asarray(shape.vertices), np.asarray(shape.vertex_normals), shape.faces.astype(np.int64)


def _reproject(
    kind: str, extent: tuple[float, float, float], positions: NDArray[np.float64], normals: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Put the midpoints of curved shapes back on the shape, and give all their exact unit normals."""
    half = np.asarray(extent) / 2
    if kind in ("sphere", "ellipsoid"):
        unit = positions / half
        unit = unit / np.linalg.norm(unit, axis=1, keepdims=True)
        positions, normals = unit * half, unit / half
    elif kind == "cylinder":
        radial = positions[:, [0, 2]] / half[[0, 2]]
        radius = np.linalg.norm(radial, axis=1)
        # Only the side is curved: points on its chords lie between cos(pi / 96) and 1 away from the axis.
        side = (radius > math.cos(math.pi / 96) * 0.999) & (np.abs(positions[:, 1]) < half[1] * (1 - 1e-9))
        positions = positions.copy()
        normals = normals.copy()
        positions[np.ix_(side, [0, 2])] = radial[side] / radius[side, None] * half[[0, 2]]
        normals[side] = 0.0
        normals[np.ix_(side, [0, 2])] = radial[side] / radius[side, None] / half[[0, 2]]
        cap = ~side & (radius < math.cos(math.pi / 96) * 0.999)
        normals[cap] = np.sign(positions[cap]) * (0.0, 1.0, 0.0)
    elif kind == "box":
        # A midpoint's mean would lean to the corners all over the sides; the mean of the sides belongs to the edges.
        normals = np.sign(positions) * (np.abs(positions) >= half * (1 - 1e-9))
    length = np.linalg.norm(normals, axis=1, keepdims=True)
    return positions, normals / np.where(length > 0, length, 1.0)


def _domain(
    setup: ProxySetup, positions: NDArray[np.float64], uv: NDArray[np.float64] | None, domain: str
) -> NDArray[np.float64]:
    if domain == "solid":
        return positions
    flat = np.zeros_like(positions)
    if uv is not None:
        flat[:, :2] = uv
    elif setup.kind == "cylinder":
        flat[:, 0] = np.arctan2(positions[:, 0], positions[:, 2]) * setup.extent[0] / 2
        flat[:, 1] = positions[:, 1]
    else:
        flat[:, :2] = positions[:, :2]
    return flat


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
        proxy, positions=proxy.positions[used], normals=proxy.normals[used], domain=proxy.domain[used],
        own_normals=proxy.own_normals[used], faces=compact.reshape(-1, 3).astype(np.uint32),
    )
