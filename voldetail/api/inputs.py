"""What callers may give: texts, paths, arrays and records, made what the rest of the package takes."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TypeAlias

import numpy as np
import trimesh
from numpy.typing import ArrayLike

from voldetail.errors import InputError
from voldetail.setup.light import Light, parse_light
from voldetail.setup.shapes import SHAPE_WORDS, simple_kind

LightLike = str | Light | Sequence[float]
"""A text as on the command line, a record, or numbers: (azimuth, elevation) in degrees or (x, y, z) towards the light."""

ShapeLike: TypeAlias = "str | Path | trimesh.Trimesh | tuple[ArrayLike, ArrayLike]"
"""A kind of shape, a mesh file, a trimesh mesh, or (vertices (V, 3), faces (F, 3))."""


def as_light(light: LightLike) -> Light:
    """Return a light as a record.

    >>> as_light("0,90").direction == as_light((0.0, 90.0)).direction
    True
    >>> as_light("point:0,0,2").kind
    'point'

    Raises InputError for what is no light.
    """
    if isinstance(light, Light):
        return light
    if isinstance(light, str):
        return parse_light(light)
    try:
        numbers = [float(v) for v in light]
    except (TypeError, ValueError):
        raise InputError(
            f'The light is a {type(light).__name__}; give a text such as "135,40", (azimuth, elevation), (x, y, z) or a Light.'
        ) from None
    return parse_light(",".join(repr(v) for v in numbers))


@contextmanager
def as_shape(shape: ShapeLike) -> Iterator[str | Path]:
    """Yield a kind of shape or a mesh file for ``shape``; a mesh in memory is written for as long as it is needed.

    So it is read, checked and mended as any file is. Raises InputError for what is no shape.
    """
    if isinstance(shape, str):
        if simple_kind(shape) is None and not Path(shape).suffix:
            raise InputError(f"The shape {shape[:60]!r} is not known: give {SHAPE_WORDS}, a mesh file or a mesh.")
        yield shape
        return
    if isinstance(shape, Path):
        yield shape
        return
    with TemporaryDirectory(prefix="voldetail-") as folder:
        mesh = _mesh_of(shape)
        file = Path(folder) / ("mesh.obj" if _has_uv(mesh) else "mesh.ply")
        mesh.export(file)
        yield file


def _mesh_of(shape: object) -> trimesh.Trimesh:
    if isinstance(shape, trimesh.Trimesh):
        return shape
    if isinstance(shape, tuple) and len(shape) == 2:
        vertices, faces = (np.asarray(part) for part in shape)
        if vertices.ndim == 2 and vertices.shape[1] == 3 and faces.ndim == 2 and faces.shape[1] == 3:
            if faces.dtype.kind in "iu" and (not faces.size or 0 <= faces.min() <= faces.max() < len(vertices)):
                return trimesh.Trimesh(vertices, faces, process=False)
            raise InputError("The faces of the shape have to be whole numbers from 0 to one less than there are vertices.")
        raise InputError(f"The shape has vertices {vertices.shape} and faces {faces.shape}; give (V, 3) and (F, 3).")
    raise InputError(
        f"The shape is a {type(shape).__name__}; give {SHAPE_WORDS}, a mesh file, a trimesh.Trimesh or (vertices, faces)."
    )


def _has_uv(mesh: trimesh.Trimesh) -> bool:
    return getattr(mesh.visual, "uv", None) is not None
