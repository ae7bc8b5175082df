"""Signed distances from the middles of a grid's cubes to a closed mesh, exact within a band about its surface.

Which side a middle is on comes from the winding number along the column through it (how often the surface is entered less
how often it is left below): whole numbers that no closest point's normal can get wrong at a sharp edge, and bodies that
overlap count as one. How far it is comes from the closest of the mesh's own triangles, cut to a few cubes' size: a tree of
their middles (scipy's cKDTree) proposes CANDIDATES, the distance to each is exact. trimesh's own `signed_distance` needs
another package (rtree).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import drjit as dr
import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from voldetail.backend import mitsuba
from voldetail.geometry.tessellate import split_long_edges

SPLIT = 3.0
"""Longest edge of the triangles in the tree, in cubes. Of 1, the tree takes four times as long on points far from the
surface, to which many triangles are about as close; larger ones need more candidates."""

CANDIDATES = 10
"""Triangles that are tried for a middle. The worst error measured with 10 is 0.0002 cubes, with 6 it is 0.02."""

CHUNK = 1 << 18
"""Middles, or pairs of a face and a column, that are worked on at a time: about 100 MB."""

FACES = 20_000_000
"""Above this triangles stay larger: a gigabyte; no grid of less than 10 GB comes near it."""

COARSE = 4
"""Cubes along a side of the blocks by which what is far from the surface is left out."""

SHIFT = (3.1830988e-5, 2.7182818e-5)
"""Of an edge, by which the columns stand beside the middles: no column goes through a vertex of a mesh on round numbers."""

Grid = tuple[int, int, int]


@dataclass(frozen=True, eq=False)
class SmallTriangles:
    """A mesh cut to triangles of a few cubes' size, in cubes from the grid's first middle.

    corners (F, 3, 3). table: the same for Dr.Jit, corner by corner. tree: of their middles. slack: the furthest that a point
    of a triangle is from its middle.
    """

    corners: NDArray[np.float64]
    table: list[Any]
    tree: cKDTree
    slack: float


def small_triangles(points: NDArray[np.float64], faces: NDArray[np.int64], longest: float = SPLIT) -> SmallTriangles:
    """Return the mesh with ``points`` (V, 3), in cubes, cut to edges of at most ``longest`` cubes."""
    fine, small = split_long_edges(points, faces, longest, limit=FACES)
    corners = fine[small]
    slack = float(np.linalg.norm(corners - corners.mean(axis=1, keepdims=True), axis=2).max())
    # Unbalanced, with large leaves: a quarter of the time on points that lie on a surface.
    tree = cKDTree(corners.mean(axis=1), leafsize=32, balanced_tree=False, compact_nodes=False)
    return SmallTriangles(corners, _table(corners), tree, slack)


def mesh_distance(
    vertices: NDArray[np.float64],
    faces: NDArray[np.int64],
    lower: tuple[float, float, float],
    shape: Grid,
    edge: float,
    reach: tuple[float, float],
) -> NDArray[np.float32]:
    """Return the signed distances (nz, ny, nx) from the middles of the cubes from ``lower`` to a closed mesh.

    They are clamped to -reach[0] and reach[1]: the band inside and the band outside in which they are exact.
    """
    # In cubes from the first middle, all that follows is free of units.
    points = (vertices - np.asarray(lower)) / edge - 0.5
    inside = winding_numbers(points, faces, shape) > 0
    return signed_distances(small_triangles(points, faces), inside, (reach[0] / edge, reach[1] / edge)) * np.float32(edge)


def signed_distances(
    triangles: SmallTriangles, inside: NDArray[np.bool_], reach: tuple[float, float], first: Grid = (0, 0, 0)
) -> NDArray[np.float32]:
    """Return the distances, in cubes, of a part of the grid that begins with cube ``first`` (z, y, x), clamped to ``reach``.

    inside (nz, ny, nx): which middles of the part are. A middle's distance is the same, to the bit, in every part that has it.
    """
    shape: Grid = (inside.shape[0], inside.shape[1], inside.shape[2])
    near = _near_blocks(triangles.tree, shape, max(reach) + triangles.slack, first)
    distance = np.empty(shape, dtype=np.float32)
    for side, width in ((inside, reach[0]), (~inside, reach[1])):
        # Inside the band is narrow, and far from the surface, where many triangles are about as close, the tree is slow.
        distance[side] = width
        cells = _by_block(np.flatnonzero(near & side), shape)
        for start in range(0, len(cells), CHUNK):
            part = cells[start : start + CHUNK]
            z, y, x = np.unravel_index(part, shape)
            points = np.stack([x, y, z], axis=1).astype(np.float64) + first[::-1]
            distance.reshape(-1)[part] = _unsigned(points, triangles, width)
    distance[inside] *= -1.0
    return distance


def _by_block(cells: NDArray[np.int64], shape: Grid) -> NDArray[np.int64]:
    """Return ``cells`` block by block: neighbours in space ask the same part of the tree, which then is in the cache."""
    z, y, x = (axis // 8 for axis in np.unravel_index(cells, shape))
    return cells[np.argsort((z * shape[1] + y) * shape[2] + x, kind="stable")]


def _near_blocks(tree: cKDTree, shape: Grid, band: float, first: Grid) -> NDArray[np.bool_]:
    """Return which cubes lie in blocks with a cube that may be within ``band`` of the tree's points, as (nz, ny, nx)."""
    blocks = [-(-count // COARSE) for count in shape]
    axes = [np.arange(count) * COARSE + (COARSE - 1) / 2 + start for count, start in zip(blocks, first, strict=True)]
    z, y, x = np.meshgrid(*axes, indexing="ij")
    corner = np.sqrt(3.0) * (COARSE - 1) / 2  # from a block's middle to the furthest of its cubes'
    found, _ = tree.query(np.stack([x, y, z], axis=-1).reshape(-1, 3), distance_upper_bound=band + corner, workers=-1)
    near: NDArray[np.bool_] = np.isfinite(found).reshape(blocks)
    for axis in range(3):
        near = np.repeat(near, COARSE, axis=axis)
    return np.asarray(near[: shape[0], : shape[1], : shape[2]])


def _unsigned(points: NDArray[np.float64], triangles: SmallTriangles, band: float) -> NDArray[np.float64]:
    """Return the distances, in cubes, of ``points`` (N, 3), clamped to ``band``."""
    many = len(triangles.corners)
    count = min(CANDIDATES, many)
    found, index = triangles.tree.query(points, k=count, distance_upper_bound=band + triangles.slack, workers=-1)
    # Where fewer are within the bound, scipy gives the number of points.
    squared = _squared(points, triangles.table, np.minimum(index.reshape(-1, count), many - 1))
    squared[~np.isfinite(found.reshape(-1, count))] = np.inf
    return np.minimum(np.sqrt(squared.min(axis=1)), band)


def squared_distances(points: NDArray[np.float64], corners: NDArray[np.float64], index: NDArray[np.int64]) -> NDArray[np.float32]:
    """Return the squared distances (N, K) from ``points`` (N, 3) to the triangles ``corners[index]``, index (N, K)."""
    return _squared(points, _table(corners), index)


def _table(corners: NDArray[np.float64]) -> list[Any]:
    mi = mitsuba()
    return [mi.Float(np.ascontiguousarray(corners[:, corner, axis])) for corner in range(3) for axis in range(3)]


def _squared(points: NDArray[np.float64], table: list[Any], index: NDArray[np.int64]) -> NDArray[np.float32]:
    """As `squared_distances`, from the triangles' ``table``.

    Above the triangle that to its plane, elsewhere that to the closest of its sides. By Dr.Jit: trimesh's `closest_point`
    gives the same in ten times as long.
    """
    mi = mitsuba()
    count = dr.opaque(mi.UInt32, index.shape[1])
    pair = mi.UInt32(index.ravel().astype(np.uint32))
    row = dr.arange(mi.UInt32, index.size) // count
    p = mi.Vector3f(*(dr.gather(mi.Float, mi.Float(np.ascontiguousarray(points[:, axis])), row) for axis in range(3)))
    vertex = [mi.Vector3f(*(dr.gather(mi.Float, table[3 * corner + axis], pair) for axis in range(3))) for corner in range(3)]
    sides = [vertex[(corner + 1) % 3] - vertex[corner] for corner in range(3)]
    normal = dr.cross(sides[0], sides[1])
    above, nearest = mi.Bool(True), mi.Float(dr.inf)
    for start, side in zip(vertex, sides, strict=True):
        offset = p - start
        along = dr.clip(dr.dot(offset, side) / dr.squared_norm(side), 0.0, 1.0)
        nearest = dr.minimum(nearest, dr.squared_norm(offset - along * side))
        above &= dr.dot(dr.cross(normal, side), offset) >= 0.0
    plane = dr.square(dr.dot(normal, p - vertex[0])) / dr.squared_norm(normal)
    return np.asarray(dr.select(above, plane, nearest).numpy()).reshape(index.shape)


def winding_numbers(
    points: NDArray[np.float64], faces: NDArray[np.int64], shape: Grid, first: Grid = (0, 0, 0)
) -> NDArray[np.int16]:
    """Return how often the mesh winds about the whole-numbered points (nz, ny, nx) from ``first`` (z, y, x) on.

    ``points`` are in units of the grid, and the columns' numbers those of the whole grid, so that parts of it agree.

    Each face counts at the columns that cross it, downwards-facing ones +1 and upwards-facing ones -1 for all that is above.
    A column beside an edge is on the same side for both faces there, since both compute the same number for it.
    """
    nz, ny, nx = shape
    steps = np.zeros((nz + 1, ny, nx), dtype=np.int16)
    x, y, z = points[faces].transpose(2, 0, 1) - np.array([*SHIFT, 0.0])[:, None, None]
    first_x, last_x = _range(x, first[2], nx)
    first_y, last_y = _range(y, first[1], ny)
    wide, high = np.maximum(last_x - first_x + 1, 0), np.maximum(last_y - first_y + 1, 0)
    pairs = wide * high
    ends = np.cumsum(pairs)
    start = 0
    while start < len(faces):
        done = ends[start - 1] if start else 0
        stop = max(start + 1, int(np.searchsorted(ends, done + CHUNK, side="right")))
        face = np.repeat(np.arange(start, stop), pairs[start:stop])
        number = np.arange(len(face)) - (ends[face] - pairs[face] - done)
        column, row = first_x[face] + number % np.maximum(wide[face], 1), first_y[face] + number // np.maximum(wide[face], 1)
        _cross(steps, x[face], y[face], z[face], column, row, first)
        start = stop
    return np.cumsum(steps, axis=0, dtype=np.int16)[:nz]


def _range(values: NDArray[np.float64], start: int, count: int) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return the first and the last whole number between the corners of each face, within ``count`` from ``start``."""
    first = np.clip(np.ceil(values.min(axis=1)), start, start + count).astype(np.int64)
    return first, np.clip(np.floor(values.max(axis=1)), start - 1, start + count - 1).astype(np.int64)


def _cross(
    steps: NDArray[np.int16],
    x: NDArray[np.float64],
    y: NDArray[np.float64],
    z: NDArray[np.float64],
    column: NDArray[np.int64],
    row: NDArray[np.int64],
    first: Grid,
) -> None:
    """Add to ``steps`` the crossings of columns with faces, pair by pair."""
    weights = np.empty_like(x)
    for corner in range(3):
        a, b = (corner + 1) % 3, (corner + 2) % 3
        # The area on the other side, always from the end with the lower coordinates: the neighbour's is its exact negative,
        # and a column on the edge itself is on the same side for both.
        swap = (x[:, a] > x[:, b]) | ((x[:, a] == x[:, b]) & (y[:, a] > y[:, b]))
        ax, bx = np.where(swap, x[:, b], x[:, a]), np.where(swap, x[:, a], x[:, b])
        ay, by = np.where(swap, y[:, b], y[:, a]), np.where(swap, y[:, a], y[:, b])
        area = (ax - column) * (by - row) - (bx - column) * (ay - row)
        area = np.where(area == 0.0, 1e-300, area)
        weights[:, corner] = np.where(swap, -area, area)
    up: NDArray[np.bool_] = np.all(weights > 0, axis=1)
    down: NDArray[np.bool_] = np.all(weights < 0, axis=1)
    hit = up | down
    height = (weights[hit] * z[hit]).sum(axis=1) / weights[hit].sum(axis=1)
    layer = np.clip(np.ceil(height) - first[0], 0, len(steps) - 1).astype(np.int64)
    np.add.at(steps, (layer, row[hit] - first[1], column[hit] - first[2]), np.where(down[hit], 1, -1).astype(np.int16))
