"""Triangles by their connections: welding, winding, edges, smooth normals."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.sparse import csgraph

from voldetail.types import Faces, Vertices


def weld(vertices: Vertices) -> tuple[NDArray[np.int64], int]:
    """Return for each vertex (V, 3) the number of its position, and how many positions there are.

    Only exactly equal coordinates share a position: duplicates at seams and in STL files are copies of one
    number.
    """
    if len(vertices) == 0:
        return np.zeros(0, dtype=np.int64), 0
    order = np.lexsort(vertices.T)
    ordered = vertices[order]
    starts = np.ones(len(order), dtype=bool)
    starts[1:] = (ordered[1:] != ordered[:-1]).any(axis=1)
    position = np.empty(len(order), dtype=np.int64)
    position[order] = np.cumsum(starts) - 1
    return position, int(starts.sum())


@dataclass(frozen=True, eq=False)
class Edges:
    """The edges of faces (F, 3): for each of the 3 F face sides its edge's number, and whether it runs upwards."""

    number: NDArray[np.int64]
    upwards: NDArray[np.bool_]
    sides: NDArray[np.int64]  # how many faces meet at each edge

    @property
    def closed(self) -> bool:
        """True if every edge joins exactly two faces that run along it in opposite directions."""
        balance = np.bincount(self.number, weights=self.upwards * 2.0 - 1, minlength=len(self.sides))
        return bool(np.all(self.sides == 2) and np.all(balance == 0))


def edges(faces: Faces) -> Edges:
    """Find the edges of faces (F, 3); face f has the sides f, F + f and 2 F + f."""
    start, end = faces.T.reshape(-1), faces[:, [1, 2, 0]].T.reshape(-1)
    key = np.minimum(start, end) * (int(faces.max(initial=0)) + 1) + np.maximum(start, end)
    _, number, sides = np.unique(key, return_inverse=True, return_counts=True)
    return Edges(number.reshape(-1), start < end, sides)


def consistent_winding(faces: Faces) -> tuple[Faces, int]:
    """Turn faces so that neighbours agree on which side is the front; return the faces and how many were turned.

    Each face is two nodes of a graph, as it is and turned; an edge of two faces joins the nodes that agree. A
    component of that graph is one way to wind a connected part, and the one that turns fewer faces is taken.
    Parts that have no consistent winding (a Moebius strip) stay as they are: there both nodes of a face are
    in one component.
    """
    found = edges(faces)
    order = np.argsort(found.number, kind="stable")
    first = order[np.cumsum(found.sides) - found.sides][found.sides == 2]
    second = order[np.cumsum(found.sides) - 1][found.sides == 2]
    clash = found.upwards[first] == found.upwards[second]
    if not clash.any():
        return faces, 0
    count = len(faces)
    left, right = first % count, second % count
    rows = np.concatenate([left, left + count])
    columns = np.concatenate([right + count * clash, right + count * ~clash])
    graph = sparse.coo_matrix((np.ones(len(rows), dtype=np.int8), (rows, columns)), shape=(2 * count, 2 * count))
    parts, label = csgraph.connected_components(graph, directed=False)
    kept, turned = label[:count], label[count:]
    keeps = np.bincount(kept, minlength=parts)
    # Component c and its mirror image hold the same faces; the one with more faces as they are wins, ties by
    # number.
    turn = (keeps[turned] > keeps[kept]) | ((keeps[turned] == keeps[kept]) & (turned < kept))
    result = faces.copy()
    result[turn] = result[turn][:, ::-1]
    return result, int(turn.sum())


def bodies(faces: Faces, positions: int) -> int:
    """Count the parts of a mesh that share no vertex."""
    used = np.unique(faces)
    graph = sparse.coo_matrix(
        (
            np.ones(2 * len(faces), dtype=np.int8),
            (faces[:, [0, 1]].reshape(-1), faces[:, [1, 2]].reshape(-1)),
        ),
        shape=(positions, positions),
    )
    labels = csgraph.connected_components(graph, directed=False)[1]
    return len(np.unique(labels[used]))


def crosses(vertices: Vertices, faces: Faces) -> Vertices:
    """Return the cross product of two sides of each face: its normal, as long as twice its area."""
    a, b, c = (vertices[faces[:, i]] for i in range(3))
    return np.asarray(np.cross(b - a, c - a))


def signed_volume(vertices: Vertices, faces: Faces) -> float:
    """Return the volume inside a closed mesh, negative if its faces look inwards."""
    a, b, c = (vertices[faces[:, i]] for i in range(3))
    return float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6)


def smooth_normals(vertices: Vertices, faces: Faces) -> Vertices:
    """Return the unit normal of each vertex (V, 3): face normals weighted by the angle at the vertex.

    Thuermer and Wuethrich 1998, "Computing vertex normals from polygonal facets": unlike a plain mean it does
    not depend on how a flat part is cut into triangles. Where the normals of the faces cancel (two faces back
    to back) one of them is taken. Every vertex must belong to a face, and no face be degenerate.
    """
    normal = crosses(vertices, faces)
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    total: NDArray[Any] = np.zeros_like(vertices)
    for corner in range(3):
        here, after, before = (vertices[faces[:, (corner + i) % 3]] for i in range(3))
        u, v = after - here, before - here
        # The angle by atan2 and not arccos, which loses half of its digits in thin triangles.
        angle = np.arctan2(np.linalg.norm(np.cross(u, v), axis=1), np.einsum("ij,ij->i", u, v))
        for axis in range(3):
            total[:, axis] += np.bincount(faces[:, corner], angle * normal[:, axis], minlength=len(vertices))
    length = np.linalg.norm(total, axis=1)
    cancelled = length < 1e-9  # the sum of a few unit vectors: shorter than this it is rounding
    if cancelled.any():
        any_face = np.zeros(len(vertices), dtype=np.int64)
        any_face[faces.reshape(-1)] = np.repeat(np.arange(len(faces)), 3)
        total[cancelled] = normal[any_face[cancelled]]
        length[cancelled] = 1
    return np.asarray(total / length[:, None])
