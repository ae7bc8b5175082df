"""A picture of a texture, made in strips."""

from __future__ import annotations

from typing import Any

import drjit as dr
import numpy as np
from numpy.typing import NDArray

from voldetail.detail.structure_texture import Texture
from voldetail.errors import InputError
from voldetail.texture.synthesis import colour_at

STRIP_PIXELS = 1 << 20
"""Pixels made at once: about 60 MB, whatever the picture's size."""

MOST_PIXELS = 1 << 27


def picture(
    texture: Texture,
    size: tuple[int, int],
    offset: tuple[float, float] = (0.0, 0.0),
    zoom: float = 1.0,
    solid: bool = False,
    *,
    strip_pixels: int = STRIP_PIXELS,
    float_type: Any = None,
) -> NDArray[np.float32]:
    """Return the picture (H, W, 3), linear, row 0 on top, of ``size`` = (columns, rows) pixels.

    offset: texels from the texture's origin to the lower left pixel, right and up. zoom: pixels a texel; below 1 bands are
    clamped as the mean over a pixel's texels wants. solid: a slice z = 0 of the solid texture instead of the 2D one.
    strip_pixels: how many are made at once; the picture is the same for any. float_type: a Dr.Jit array type, by default
    LLVM's, or CUDA's where there is no LLVM. Raises InputError for a size under 1, over 2^27 pixels, or a zoom not over 0.
    """
    columns, rows = size
    if min(columns, rows) < 1 or columns * rows > MOST_PIXELS:
        raise InputError(f"A picture of {columns} x {rows} pixels cannot be made; 1 to {MOST_PIXELS} pixels are allowed.")
    if not (np.isfinite(zoom) and zoom > 0):
        raise InputError(f"The zoom {zoom} is out of range; it is the pixels a texel, a number over 0.")
    pixels = np.empty((rows, columns, 3), np.float32)
    float_type = float_type or default_float()
    footprint = texels_footprint(1.0 / zoom)
    height = max(1, strip_pixels // columns)
    x = ((np.arange(columns) + 0.5) / zoom - 0.5 + offset[0]).astype(np.float32)
    y = ((rows - np.arange(rows) - 0.5) / zoom - 0.5 + offset[1]).astype(np.float32)
    for top in range(0, rows, height):
        part = y[top : top + height]
        points = (float_type(np.tile(x, len(part))), float_type(np.repeat(part, columns)))
        colour = colour_at(texture, (*points, dr.zeros(float_type, dr.width(points[0]))) if solid else points, footprint)
        dr.eval(colour)
        for k in range(3):
            pixels[top : top + height, :, k] = colour[k].numpy().reshape(len(part), columns)
    return pixels


def texels_footprint(side: float) -> float:
    """Return the footprint of a pixel of ``side`` texels that is a mean over texels and not over points: side^2 - 1, its root.

    A row of n points a texel apart has the variance (n^2 - 1) / 12, a line of length f has f^2 / 12.
    """
    return float(np.sqrt(max(side * side - 1.0, 0.0)))


def default_float() -> Any:
    """Return the Dr.Jit array type for pictures: LLVM's where there is one, else CUDA's."""
    import drjit.cuda
    import drjit.llvm

    return drjit.llvm.Float if dr.has_backend(dr.JitBackend.LLVM) else drjit.cuda.Float
