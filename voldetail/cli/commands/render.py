"""`voldetail render`: a detail on a shape, under a light or an environment map."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from voldetail.cli.arguments import size
from voldetail.cli.console import remarks, result
from voldetail.cli.outputs import check_file
from voldetail.cli.shape_options import MESH_HELP, DetailFile, Rotation, Scale, rotation_of, shape_of, tell
from voldetail.cli.threads import use_threads
from voldetail.cli.view_options import Background, Fov, Subsamples, background_of, camera_of
from voldetail.errors import InputError
from voldetail.setup.lights.table import FORMS_PLACED as RENDER_LIGHTS


def render(
    detail: DetailFile,
    shape: Annotated[str, typer.Argument(metavar="MESH", help=MESH_HELP)],
    out: Annotated[Path, typer.Option("--output", "-o", help="The picture: .png, .jpg or .exr (linear).")],
    light: Annotated[str | None, typer.Option(help=f"{RENDER_LIGHTS}. Default: 135,45.")] = None,
    envmap: Annotated[Path | None, typer.Option(help="Light from an environment map (.exr or .hdr) instead.")] = None,
    scale: Scale = 1.0,
    pixels: Annotated[str, typer.Option("--size", help="WIDTHxHEIGHT in pixels.")] = "640x480",
    shading: Annotated[str, typer.Option(help="phong (as fitted) or principled (physically based).")] = "phong",
    rotation: Rotation = None,
    fov: Fov = None,
    samples: Annotated[int, typer.Option(min=1, max=65536, help="Samples a pixel, for --envmap and principled.")] = 64,
    subsamples: Subsamples = 2,
    background: Background = "0",
) -> None:
    """Render a detail on a shape, under a light or an environment map."""
    from voldetail.apply import render as picture_of
    from voldetail.image import check_suffix, save_image
    from voldetail.recover.files import load_any
    from voldetail.render.environment import checked_environment
    from voldetail.setup.light import parse_light

    check_suffix(out)
    check_file(out)
    record = load_any(detail)
    if light is not None and envmap is not None:
        raise InputError("--light and --envmap were both given; choose one.")
    if shading not in ("phong", "principled"):
        raise InputError(f"--shading {shading!r} is not known; use phong or principled.")
    lit = parse_light(light) if light is not None else None
    if lit is not None and lit.row.estimated:
        raise InputError(f"--light auto is estimated from a photo, by fit alone: give it as {RENDER_LIGHTS}.")
    options: dict[str, Any] = {
        "light": lit,
        "envmap": checked_environment(envmap) if envmap is not None else None,
        "scale": scale, "size": size(pixels), "camera": camera_of(fov), "rotation": rotation_of(rotation),
        "subsamples": subsamples, "samples": samples, "shading": shading, "background": background_of(background, record),
    }  # fmt: skip
    shape = shape_of(shape)
    use_threads()
    with remarks().status(f"rendering {shape}") as status:
        options["tell"] = tell
        options["on_progress"] = lambda done, total: status.update(f"rendering {shape}: {done} of {total} blocks of its surface")
        picture = picture_of(record, shape, **options)
    save_image(out, picture)
    rows, columns = picture.shape[:2]
    result({"file": str(out), "columns": columns, "rows": rows}, f"{out}  {columns} x {rows} pixels")
