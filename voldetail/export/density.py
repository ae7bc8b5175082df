"""`.vol`: the densities of a volume on a shape, as Mitsuba's `gridvolume` reads them."""

from __future__ import annotations

from pathlib import Path

from voldetail.apply.bake import bake
from voldetail.detail.photo_relief import AnyDetail, MappedDetail
from voldetail.errors import InputError
from voldetail.export.options import ExportOptions
from voldetail.geometry.density_file import write_density


def write(path: Path, detail: AnyDetail, shape: str | Path, options: ExportOptions) -> str:
    """Write the grid of densities from 0 to 1; return its size in words. Raises InputError for a detail that displaces."""
    if isinstance(detail, MappedDetail):
        raise InputError("A photo's relief is a surface and has no density; export it as a mesh, .ply or .obj.")
    grid = bake(
        detail, shape, cells=options.cells, scale=options.scale, rotation=options.rotation, tell=options.tell,
    )  # fmt: skip
    write_density(path, grid)
    nz, ny, nx = grid.shape
    return f"{nx} x {ny} x {nz} cells of {grid.edge:.4g} scene units"
