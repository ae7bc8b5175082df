"""Meshes that have an inside, for volumes."""

from __future__ import annotations

from functools import lru_cache
from pathlib import Path

from voldetail.errors import InputError
from voldetail.geometry.meshes import Mesh, load_mesh, normalise
from voldetail.setup.proxy import ProxySetup


def closed_mesh(proxy: ProxySetup) -> Mesh:
    """Return the mesh of ``proxy``, read once for as long as its file stays the same. Raises InputError for an open one."""
    assert proxy.mesh is not None
    return _read_closed(proxy.mesh, max(proxy.extent), _changed(proxy.mesh))


def _changed(path: Path) -> int:
    """Return when a file was last written, 0 where it cannot be told."""
    try:
        return path.stat().st_mtime_ns
    except OSError:
        return 0


@lru_cache(maxsize=2)  # planned for several sizes of cells, and then once more for what was chosen
def _read_closed(path: Path, size: float, changed: int) -> Mesh:
    mesh = normalise(load_mesh(path), size)
    if not mesh.watertight:
        raise InputError(
            f"The mesh {path} is not closed, so it has no inside to fill: close its holes (in Blender: Mesh > Clean Up"
            " > Fill Holes, and give a sheet a thickness with the Solidify modifier), or put the detail on it as displacement."
        )
    return mesh
