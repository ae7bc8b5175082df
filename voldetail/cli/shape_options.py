"""What the commands that put a detail on a shape have in common."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from voldetail.cli.arguments import mesh, numbers
from voldetail.cli.console import remarks
from voldetail.setup.shapes import SHAPE_WORDS, SIMPLE_KINDS

DETAIL_HELP = "A detail file, as fit makes it, or a relief.json of relief, or its folder."
MESH_HELP = f"{SHAPE_WORDS}, or a mesh or density (.vol) file."

DetailFile = Annotated[Path, typer.Argument(help=DETAIL_HELP)]
Scale = Annotated[float, typer.Option(min=1e-3, max=1e3, help="How many times larger the relief is than in the photo.")]
Rotation = Annotated[str | None, typer.Option(help="The shape's turns about x, y, z in degrees, e.g. -60,0,0.")]


def rotation_of(text: str | None) -> tuple[float, float, float]:
    """Return the turns in degrees that ``text`` names."""
    if text is None:
        return (0.0, 0.0, 0.0)
    x, y, z = numbers(text, 3, "--rotation", "X,Y,Z in degrees")
    return (x, y, z)


def shape_of(text: str) -> str:
    """Return ``text`` if it is a kind of proxy or a file that can be opened."""
    from voldetail.geometry.mesh_files import SUFFIXES

    return mesh(text, SIMPLE_KINDS, SUFFIXES)


def tell(sentence: str) -> None:
    """Say what a volume will take before it is made."""
    remarks().print(sentence, markup=False, soft_wrap=True)
