"""What a decoder hands on: stored numbers, before any meaning of light is given to them."""

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from voldetail.errors import InputError

MAX_PIXELS = 100_000_000  # the largest photo that is decoded: 1.2 GB of float32


@dataclass(frozen=True, eq=False)
class Samples:
    """Stored values of a picture: `values` (H, W) or (H, W, 3), uint8, uint16 or float32; `alpha` (H, W) 0 to 1."""

    values: NDArray[Any]
    alpha: NDArray[np.float32] | None = None
    orientation: int = 1  # EXIF's, 1 to 8, still to be applied
    notes: tuple[str, ...] = field(default=())


def check_pixels(width: int, height: int, what: str, path: Path) -> None:
    """Raise InputError unless a header's size is one that may be decoded."""
    if width < 1 or height < 1:
        raise InputError(f"The {what} {path} says that it has {width} x {height} pixels; save it again.")
    if width * height > MAX_PIXELS:
        raise InputError(
            f"The {what} {path} has {width} x {height} = {width * height / 1e6:.0f} megapixels, more than the "
            f"{MAX_PIXELS // 10**6} allowed; crop or shrink it."
        )


def upright(image: NDArray[Any], orientation: int) -> NDArray[Any]:
    """Turn an image (H, W, ...) as its EXIF orientation (1 to 8; others count as 1) asks, so that row 0 is on top."""
    if 5 <= orientation <= 8:
        image = image.swapaxes(0, 1)
    if orientation in (3, 4, 7, 8):
        image = image[::-1]
    if orientation in (2, 3, 6, 7):
        image = image[:, ::-1]
    return image
