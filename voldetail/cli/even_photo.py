"""The photo whose evenness a command is about."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

PhotoName = Annotated[str, typer.Argument(help="A photo of a texture, or skimage:gravel, :grass, :brick.")]
MaskFile = Annotated[Path | None, typer.Option(help="A picture of the photo's size: white is used.")]


def read_even(photo: str, mask: Path | None) -> tuple[NDArray[np.float32], NDArray[np.bool_]]:
    """The photo (H, W, 3), linear, and what of it may be used (H, W)."""
    from voldetail.image import load_masked, used_of

    loaded = load_masked(photo, mask)
    return loaded.pixels, used_of(loaded)
