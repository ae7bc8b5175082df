"""`voldetail bake`: a volumetric detail on a shape as a grid of densities, for other programs."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from voldetail.cli.console import output, remarks
from voldetail.cli.outputs import check_file
from voldetail.cli.shape_options import MESH_HELP, DetailFile, Rotation, Scale, rotation_of, shape_of, tell
from voldetail.cli.threads import use_threads
from voldetail.detail import load_detail
from voldetail.errors import InputError


def bake(
    context: typer.Context,
    detail: DetailFile,
    shape: Annotated[str, typer.Argument(metavar="MESH", help=MESH_HELP)],
    out: Annotated[Path, typer.Option("--output", "-o", help="The density file: .vol, a grid volume as Mitsuba reads it.")],
    cells: Annotated[int, typer.Option(help="Cells along the shape's longest side, 16 to 1024.")] = 128,
    scale: Scale = 1.0,
    rotation: Rotation = None,
) -> None:
    """Bake a volumetric detail on a closed shape to a grid of densities from 0 to 1."""
    from voldetail.apply import bake as grid_of
    from voldetail.geometry.density_file import SUFFIX, write_density

    if out.suffix.lower() != SUFFIX:
        raise InputError(f"The density file {out} has the suffix {out.suffix or 'none'}; give it the suffix {SUFFIX}.")
    check_file(out)
    record, shape, turned = load_detail(detail), shape_of(shape), rotation_of(rotation)
    use_threads(context.obj)
    with remarks().status(f"baking {shape}"):
        grid = grid_of(record, shape, cells=cells, scale=scale, rotation=turned, tell=tell)
        write_density(out, grid)
    nz, ny, nx = grid.shape
    output().print(f"{out}  {nx} x {ny} x {nz} cells of {grid.edge:.4g} scene units", markup=False, soft_wrap=True)
