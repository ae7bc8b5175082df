"""`voldetail texture render`: a picture of a texture, or of a shape that it colours."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from voldetail.cli.arguments import numbers, size
from voldetail.cli.console import remarks, result
from voldetail.cli.outputs import check_file
from voldetail.cli.shape_options import MESH_HELP, shape_of
from voldetail.cli.texture_options import Size, Solid, TextureFile
from voldetail.cli.threads import use_threads
from voldetail.detail.texture_file import load_texture
from voldetail.errors import InputError
from voldetail.records.refusal import shown


def render(
    texture: TextureFile,
    out: Annotated[Path, typer.Option("--output", "-o", help="The picture: .png, .jpg or .exr (linear).")],
    pixels: Size = "512x512",
    offset: Annotated[str, typer.Option(help="X,Y in texels, right and up.")] = "0,0",
    zoom: Annotated[float, typer.Option(min=1e-3, max=1e3, help="Pixels a texel of the photo.")] = 1.0,
    solid: Solid = False,
    shape: Annotated[str | None, typer.Option("--on", metavar="MESH", help="Show it on a shape: " + MESH_HELP)] = None,
    texels: Annotated[
        float | None,
        typer.Option(min=1e-2, max=1e4, help="Texels a scene unit, with --on; a shape is 2 long. Default: the photo spans it."),
    ] = None,
) -> None:
    """Make a picture of a texture, of any size, or of a shape that is coloured by it."""
    from voldetail.apply import painted
    from voldetail.apply import render as picture_of
    from voldetail.image import check_suffix, save_image
    from voldetail.texture import picture

    check_suffix(out)
    check_file(out)
    record = load_texture(texture)
    columns, rows = size(pixels)
    x, y = numbers(offset, 2, "--offset", "X,Y in texels")
    if max(abs(x), abs(y)) > 1e6:
        raise InputError(f"--offset {shown(offset)} is too far; allowed: -1000000 to 1000000 texels.")
    if shape is None and texels is not None:
        raise InputError("--texels is for a shape; give --on as well, or --zoom instead.")
    shape = None if shape is None else shape_of(shape)
    use_threads()
    with remarks().status("making the picture"):
        if shape is None:
            made = picture(record, (columns, rows), (x, y), zoom, solid)
        else:
            made = picture_of(painted(record, texels), shape, size=(columns, rows))
        save_image(out, made)
    result({"file": str(out), "columns": columns, "rows": rows}, f"{out}  {columns} x {rows} pixels")
