"""Triangles from mesh files that may hold anything; nothing but the named file (and glTF's own buffers) is opened."""

import json
import logging
import re
import struct
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path, PurePosixPath
from typing import Any
from urllib.parse import unquote

import numpy as np
import trimesh
from numpy.typing import NDArray

from voldetail.errors import InputError
from voldetail.files import readable
from voldetail.geometry.density_file import SUFFIX as DENSITY_SUFFIX
from voldetail.geometry.density_file import read_density

MAX_BYTES = 512 * 2**20  # of a file: five million faces as text
MAX_FACES = 5_000_000  # about 2 GB while they are read
SUFFIXES = (".obj", ".ply", ".stl", ".off", ".glb", ".gltf", DENSITY_SUFFIX)
OBJECT_LEVEL = 0.5
"""Where the surface of an object that is stored as a density lies."""

_BINARY_STL_HEADER = 84
_HEADER_BYTES = 1 << 16


@dataclass(frozen=True, eq=False)
class Triangles:
    """What a file holds: vertices (V, 3), faces (F, 3), texture coordinates (V, 2) or None, and all bytes read."""

    vertices: NDArray[np.float64]
    faces: NDArray[np.int64]
    uv: NDArray[np.float64] | None
    data: tuple[bytes, ...]


def read_triangles(path: Path) -> Triangles:
    """Read an OBJ, PLY, STL, OFF or glTF file by its suffix; the parts of a scene are put together in world space.

    Of a density (.vol) the surface at half its greatest possible value is taken, closed where it meets its box.
    Raises InputError for another suffix, for a file too large, and for one that cannot be read.
    """
    suffix = path.suffix.lower()
    if suffix not in SUFFIXES:  # before anything is opened: trimesh knows formats that run code or other programs
        raise InputError(f"The mesh {path} has the suffix {suffix or 'none'}; use one of {', '.join(SUFFIXES)}.")
    if suffix == DENSITY_SUFFIX:
        return _surface_of_density(path)
    readable(path, "mesh", MAX_BYTES)
    try:
        data = path.read_bytes()
        _check_faces(_announced_faces(data, suffix), path)
        buffers = _buffers(data, suffix, path)
        logging.getLogger("trimesh").setLevel(logging.CRITICAL)  # what it says of damaged files is not for our user
        with np.errstate(all="ignore"):
            # From memory, with a resolver that holds the buffers and nothing else: no material, no picture,
            # no net.
            scene = trimesh.load_scene(BytesIO(data), file_type=suffix[1:], resolver=buffers, process=False, skip_materials=True)
            vertices, faces, uv = _together(scene, path)
    except InputError:
        raise
    except Exception as error:  # the loaders raise nearly every kind of exception on damaged files
        reason = " ".join(str(error).split())[:160] or type(error).__name__
        raise InputError(f"The mesh {path} is damaged or no {suffix} file ({reason}); export it again.") from error
    return Triangles(vertices, faces, uv, (data, *buffers.values()))


def _surface_of_density(path: Path) -> Triangles:
    from voldetail.geometry.isosurface import march  # only here: it brings scikit-image, and the suffixes are wanted at once

    density, lower, upper = read_density(path)
    if not density.max() > OBJECT_LEVEL:
        raise InputError(
            f"The density file {path} holds nothing above {density.max():.3g}, and its surface is where it is {OBJECT_LEVEL};"
            " scale it to 1."
        )
    steps, faces = march(np.pad(density, 1), OBJECT_LEVEL)
    edge = (np.asarray(upper) - np.asarray(lower)) / np.asarray(density.shape[::-1])
    _check_faces(len(faces), path)
    return Triangles((steps - 0.5) * edge + np.asarray(lower), faces, None, (path.read_bytes(),))


def _check_faces(count: int, path: Path) -> None:
    if count > MAX_FACES:
        raise InputError(f"The mesh {path} has {count} faces, more than the {MAX_FACES} allowed; simplify it.")


def _announced_faces(data: bytes, suffix: str) -> int:
    """Return how many faces a file's header speaks of, 0 if it does not say."""
    if suffix == ".ply":
        found = re.search(rb"^element\s+face\s+(\d{1,18})", data[:_HEADER_BYTES], re.MULTILINE)
        return int(found[1]) if found else 0
    if suffix == ".stl" and len(data) >= _BINARY_STL_HEADER and data.lstrip()[:5].lower() != b"solid":
        return int(struct.unpack_from("<I", data, _BINARY_STL_HEADER - 4)[0])
    if suffix == ".off":
        found = re.match(rb"\s*OFF\s+(?:#[^\n]*\s+)*\d+\s+(\d{1,18})", data[:_HEADER_BYTES])
        return int(found[1]) if found else 0
    if suffix in (".glb", ".gltf"):
        # An accessor without a buffer is as many zeros as it asks for, so the largest count bounds the
        # memory.
        accessors = _gltf_tree(data, suffix).get("accessors", [])
        return max((int(accessor.get("count", 0)) for accessor in accessors), default=0) // 3
    return 0


def _gltf_tree(data: bytes, suffix: str) -> dict[str, Any]:
    if suffix == ".glb":
        length, kind = struct.unpack_from("<I4s", data, 12)
        data = data[20 : 20 + length] if kind == b"JSON" else b""
    tree = json.loads(data)
    return dict(tree)  # raises for JSON that is no object


def _buffers(data: bytes, suffix: str, path: Path) -> dict[str, bytes]:
    """Read the buffers that a .gltf file names, if they lie in its own folder or below it."""
    found: dict[str, bytes] = {}
    if suffix != ".gltf":
        return found
    for buffer in _gltf_tree(data, suffix).get("buffers", []):
        uri = buffer.get("uri", "")
        if not uri or uri.startswith("data:"):
            continue
        name = PurePosixPath(unquote(uri))
        place = path.parent / name
        if "://" in uri or name.is_absolute() or not place.resolve().is_relative_to(path.parent.resolve()):
            raise InputError(f"The mesh {path} refers to {uri!r} outside its own folder; save it as .glb instead.")
        try:
            found[uri] = readable(place, "buffer", MAX_BYTES).read_bytes()
        except InputError as error:
            raise InputError(f"The mesh {path} cannot be used without the file that it refers to: {error}") from None
    return found


def _together(scene: Any, path: Path) -> tuple[NDArray[np.float64], NDArray[np.int64], NDArray[np.float64] | None]:
    """Put the parts of a scene into one list of triangles, each where its node puts it."""
    placed = [(scene.geometry[name], matrix) for matrix, name in map(scene.graph.get, scene.graph.nodes_geometry)]
    placed = [(part, matrix) for part, matrix in placed if len(getattr(part, "faces", ())) > 0]
    _check_faces(sum(len(part.faces) for part, _ in placed), path)  # a small file may place one part many times
    vertices, faces, uvs = [np.zeros((0, 3))], [np.zeros((0, 3), dtype=np.int64)], []
    offset = 0
    for part, matrix in placed:
        corners = np.asarray(part.faces, dtype=np.int64)
        points = np.asarray(part.vertices, dtype=np.float64)
        if corners.min() < 0 or corners.max() >= len(points):
            raise InputError(f"The mesh {path} has a face with a vertex that does not exist; export it again.")
        if np.linalg.det(matrix[:3, :3]) < 0:
            corners = corners[:, ::-1]  # a mirrored part keeps its outside outside
        uv = getattr(getattr(part, "visual", None), "uv", None)
        fits = uv is not None and np.shape(uv) == (len(points), 2)
        uvs.append(np.asarray(uv, dtype=np.float64) if fits else None)
        vertices.append(points @ matrix[:3, :3].T + matrix[:3, 3])
        faces.append(corners + offset)
        offset += len(points)
    complete = [uv for uv in uvs if uv is not None]
    uv_all = np.concatenate(complete) if complete and len(complete) == len(uvs) else None
    return np.concatenate(vertices), np.concatenate(faces), uv_all
