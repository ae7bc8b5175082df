"""What the commands of textures have in common."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

LARGEST_SEED = 2**32 - 1

TextureFile = Annotated[Path, typer.Argument(metavar="TEXTURE", help="A texture file, as texture fit makes it.")]
Seed = Annotated[int | None, typer.Option(min=0, max=LARGEST_SEED, help="The seed of the noise.")]
Size = Annotated[str, typer.Option("--size", help="WIDTHxHEIGHT in pixels.")]
Solid = Annotated[bool, typer.Option("--solid", help="A slice of the solid texture.")]
