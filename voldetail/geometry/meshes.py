"""Meshes that detail can be put on: checked, welded, oriented, with smooth normals."""

import hashlib
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from voldetail.errors import InputError
from voldetail.geometry.mesh_files import Triangles, read_triangles
from voldetail.geometry.topology import (
    bodies,
    consistent_winding,
    crosses,
    edges,
    signed_volume,
    smooth_normals,
    weld,
)

# Of the longest side squared: thinner triangles vanish in the renderer's 32-bit floats and give NaN normals.
_DEGENERATE_AREA = 1e-14
_LARGEST = 1e30  # of a coordinate: beyond it areas and the renderer's 32-bit floats overflow


@dataclass(frozen=True, eq=False)
class Mesh:
    """A triangle mesh with smooth outward normals.

    `vertices` (V, 3) and unit `normals` (V, 3) float64, `faces` (F, 3) int64, counter-clockwise from outside;
    `uv` (V, 2) or None. With `uv`, the vertices along seams are doubled, but doubles have the same position
    and the same normal, so that displacement opens no gap. `watertight` if every edge joins two faces;
    `notes` say what was repaired or is odd; `sha256` of the file.
    """

    vertices: NDArray[np.float64]
    faces: NDArray[np.int64]
    normals: NDArray[np.float64]
    uv: NDArray[np.float64] | None = None
    watertight: bool = False
    notes: tuple[str, ...] = field(default=())
    sha256: str = ""


def load_mesh(path: str | Path) -> Mesh:
    """Read a mesh from an OBJ, PLY, STL, OFF or glTF file of at most 5 million faces.

    Degenerate and repeated faces are dropped, faces that disagree with their neighbours turned, and a closed
    mesh that is inside out turned as a whole, each with a note. Raises InputError for a file that cannot be
    read, and for a mesh with no face, with NaN or infinite vertices, or with degenerate faces only.
    """
    path = Path(path)
    read = read_triangles(path)
    digest = hashlib.sha256()
    for data in read.data:
        digest.update(data)
    _check(read, path)
    return _build(read, path, digest.hexdigest())


def normalise(mesh: Mesh, size: float = 2.0) -> Mesh:
    """Return the mesh with the middle of its bounding box at the origin and its longest side `size` scene units."""
    low, high = mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)
    vertices = (mesh.vertices - (low + high) / 2) * (size / float((high - low).max()))
    return replace(mesh, vertices=vertices)


def _check(read: Triangles, path: Path) -> None:
    if len(read.faces) == 0:
        raise InputError(f"The mesh {path} has no faces; export it with its surface, not points or lines alone.")
    wrong = ~np.isfinite(read.vertices).all(axis=1)
    if wrong.any():
        raise InputError(
            f"The mesh {path} has {np.count_nonzero(wrong)} vertices that are NaN or infinite, the first is number "
            f"{int(np.argmax(wrong)) + 1}; repair it."
        )
    if np.abs(read.vertices).max() > _LARGEST:
        raise InputError(f"The mesh {path} has coordinates beyond {_LARGEST:g}; scale it down.")


def _build(read: Triangles, path: Path, digest: str) -> Mesh:
    notes = []
    # -0 and 0 are one position; a unit box keeps areas clear of overflow and underflow.
    low, high = read.vertices.min(axis=0), read.vertices.max(axis=0)
    longest = float((high - low).max())
    unit = (read.vertices - low) / (longest if longest > 0 else 1.0)
    position, count = weld(unit + 0.0)
    points = np.empty((count, 3))
    points[position] = unit

    area = np.linalg.norm(crosses(unit, read.faces), axis=1) / 2
    sound = area > _DEGENERATE_AREA
    dropped = len(sound) - int(np.count_nonzero(sound))
    if dropped == len(sound):
        raise InputError(f"All {dropped} faces of the mesh {path} are degenerate (without area); export it again.")
    if dropped:
        notes.append(f"{dropped} degenerate faces dropped")
    faces = read.faces[sound]
    # Two-sided modelling: the second copy would cancel the normals of the first.
    first = np.unique(np.sort(position[faces], axis=1), axis=0, return_index=True)[1]
    if len(first) < len(faces):
        notes.append(f"{len(faces) - len(first)} faces that repeat another dropped")
        faces = faces[np.sort(first)]

    turned_faces, turned = consistent_winding(position[faces])
    if turned:
        notes.append(f"{turned} faces turned to agree with their neighbours")
    flip = (turned_faces != position[faces]).any(axis=1)
    faces[flip] = faces[flip][:, ::-1]
    welded = position[faces]

    found = edges(welded)
    watertight = found.closed
    crowded = int(np.count_nonzero(found.sides > 2))
    if crowded:
        notes.append(f"{crowded} edges shared by more than two faces (non-manifold)")
    if watertight and signed_volume(points, welded) < 0:
        notes.append("inside out (negative volume), turned")
        faces, welded = faces[:, ::-1], welded[:, ::-1]
    parts = bodies(welded, count)
    if parts > 1:
        notes.append(f"{parts} separate bodies")

    # Without texture coordinates one vertex a position is enough; with them the seams need two.
    label = position if read.uv is None else np.arange(len(unit))
    used, faces = np.unique(label[faces], return_inverse=True)
    source = np.zeros(int(label.max()) + 1, dtype=np.int64)
    source[label] = np.arange(len(label))
    rows = source[used]
    used_positions, compact = np.unique(welded, return_inverse=True)
    normals = np.zeros((count, 3))
    normals[used_positions] = smooth_normals(points[used_positions], compact.reshape(-1, 3))
    return Mesh(
        vertices=np.ascontiguousarray(read.vertices[rows]),
        faces=np.ascontiguousarray(faces.reshape(-1, 3).astype(np.int64)),
        normals=np.ascontiguousarray(normals[position[rows]]),
        uv=None if read.uv is None else np.ascontiguousarray(read.uv[rows]),
        watertight=watertight,
        notes=tuple(notes),
        sha256=digest,
    )
