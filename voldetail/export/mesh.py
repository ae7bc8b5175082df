"""`.ply`, `.obj`, `.stl`, `.off`: the displaced shape as triangles, as trimesh writes them."""

from __future__ import annotations

from pathlib import Path

import trimesh

from voldetail.apply.displaced import displaced_mesh
from voldetail.detail.photo_relief import AnyDetail
from voldetail.export.options import ExportOptions
from voldetail.files import atomic


def write(path: Path, detail: AnyDetail, shape: str | Path, options: ExportOptions) -> str:
    """Write the shape with its relief, in scene units; return its size in words. Raises InputError for a volume."""
    vertices, faces = displaced_mesh(detail, shape, edge=2.0 / options.cells, scale=options.scale, rotation=options.rotation)
    mesh = trimesh.Trimesh(vertices, faces, process=False)
    with atomic(path) as temporary:
        mesh.export(temporary, file_type=path.suffix.lower().removeprefix("."))
    return f"{len(vertices)} vertices, {len(faces)} faces"
