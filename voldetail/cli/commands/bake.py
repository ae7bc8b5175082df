"""`voldetail bake`: a detail on a shape for other programs: a grid of densities, or the displaced mesh."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from voldetail.cli.console import remarks, result
from voldetail.cli.outputs import check_file
from voldetail.cli.shape_options import MESH_HELP, DetailFile, Rotation, Scale, rotation_of, shape_of, tell
from voldetail.cli.threads import use_threads


def bake(
    detail: DetailFile,
    shape: Annotated[str, typer.Argument(metavar="MESH", help=MESH_HELP)],
    out: Annotated[
        Path,
        typer.Option(
            "--output", "-o", help="The file: .vol (a grid volume as Mitsuba reads it), or of relief .ply, .obj, .stl, .off."
        ),
    ],
    cells: Annotated[int, typer.Option(help="Cells along the shape's longest side, 16 to 1024.")] = 128,
    scale: Scale = 1.0,
    rotation: Rotation = None,
) -> None:
    """Bake a volumetric detail on a closed shape to a grid of densities from 0 to 1, or relief to a displaced mesh."""
    from voldetail.export import ExportOptions, export
    from voldetail.recover.files import load_any

    check_file(out)
    record, shape = load_any(detail), shape_of(shape)
    options = ExportOptions(cells=cells, scale=scale, rotation=rotation_of(rotation), tell=tell)
    use_threads()
    with remarks().status(f"baking {shape}"):
        words = export(record, shape, out, options)
    result({"file": str(out), "what": words}, f"{out}  {words}")
