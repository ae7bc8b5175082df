"""`voldetail texture morph`: from one texture to another."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from voldetail.cli.arguments import size
from voldetail.cli.console import remarks, result
from voldetail.cli.outputs import check_folder, make_folder, remove
from voldetail.cli.texture_options import Size, Solid
from voldetail.cli.threads import use_threads
from voldetail.detail.texture_file import load_example, save_texture
from voldetail.errors import InputError

MOST_STEPS = 200


def morph(
    first: Annotated[Path, typer.Argument(metavar="A", help="The texture file to begin with.")],
    last: Annotated[Path, typer.Argument(metavar="B", help="The texture file to end with.")],
    folder: Annotated[Path, typer.Option("--output", "-o", help="The folder for the pictures and texture files.")],
    steps: Annotated[int, typer.Option(min=2, max=MOST_STEPS, help="Pictures, both ends included.")] = 5,
    pixels: Size = "256x256",
    solid: Solid = False,
    force: Annotated[bool, typer.Option("--force", help="Replace the steps in the folder.")] = False,
) -> None:
    """Go from one texture to another: a picture and a texture file for each step."""
    from voldetail.image import save_png
    from voldetail.texture import morph as between
    from voldetail.texture import picture

    check_folder(folder)
    a, b = load_example(first), load_example(last)
    columns, rows = size(pixels)
    old = sorted([*folder.glob("step_*.png"), *folder.glob("step_*.json")]) if folder.is_dir() else []
    if old and not force:
        raise InputError(f"The folder {folder} has {old[0].name} in it; give another, or --force to replace the steps.")
    make_folder(folder)
    remove(old)
    use_threads()
    with remarks().status("making the pictures"):
        for step in range(steps):
            made = between(a, b, step / (steps - 1))
            save_texture(folder / f"step_{step:03d}.json", made)
            save_png(folder / f"step_{step:03d}.png", picture(made, (columns, rows), solid=solid))
    result({"folder": str(folder), "steps": steps}, f"{folder}  {steps} steps")
