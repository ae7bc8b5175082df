"""A picture of a structure model, at any place of its endless plane."""

from __future__ import annotations

from math import cos, sin

import numpy as np
from numpy.typing import NDArray

from voldetail.errors import InputError
from voldetail.texture.structures.model import StructureModel, Values

LARGEST_SIDE = 16384
"""Pixels; positions stay far within what single precision tells apart."""


def structure(
    model: StructureModel,
    values: Values | None = None,
    size: int | tuple[int, int] = 256,
    rotation: float = 0.0,
    seed: int = 0,
    offset: tuple[float, float] | None = None,
) -> NDArray[np.float32]:
    """Return the structure map s_a (H, W) in [0, 1] of ``model`` (GKHF14 equation 3), row 0 on top.

        pixel at row i, column j:  x = (left + j + 1/2, -(top + i + 1/2)),     s = s_a(R_-rotation x)

    values: the model's parameters, defaults where missing. size: pixels a side, or (rows, columns). rotation: radians,
    counter-clockwise about the plane's origin. offset: (top, left) texels of the first pixel; by default the picture's middle
    is the origin. A part of a larger picture is the picture of that part. Raises InputError for values outside their ranges,
    a size under 1 or over 16384, a rotation or offset that is not finite.
    """
    rows, columns = (size, size) if isinstance(size, int) else size
    if not (1 <= rows <= LARGEST_SIDE and 1 <= columns <= LARGEST_SIDE):
        raise InputError(f"A structure of {columns} x {rows} pixels is not possible; 1 to {LARGEST_SIDE} a side are.")
    top, left = (-rows / 2, -columns / 2) if offset is None else offset
    if not np.isfinite([rotation, top, left]).all():
        raise InputError("The rotation and the offset have to be finite numbers.")
    x = (np.arange(columns) + (left + 0.5))[None, :]
    y = -(np.arange(rows) + (top + 0.5))[:, None]
    c, s = cos(rotation), sin(rotation)
    # Double precision up to here: a pixel has the same position in every picture that it is in.
    turned = np.asarray(c * x + s * y, np.float32), np.asarray(c * y - s * x, np.float32)
    found = model.evaluate(*turned, model.checked(values or {}), seed)
    return np.asarray(found, np.float32)
