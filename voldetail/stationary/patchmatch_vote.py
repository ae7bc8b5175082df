"""Pictures that belong to a photo, brought into its tile in the same way as the colours."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from voldetail.errors import InputError
from voldetail.stationary.patchmatch import from_centres
from voldetail.stationary.patchmatch_arrays import LAST_SIGMA, PATCH, RADIUS, vote

LEAST_LENGTH = 1e-6
"""A mean of normals shorter than this has no direction: the normal points at the viewer then."""


def carry(correspondence: NDArray[Any], other: NDArray[Any], *, normals: bool = False) -> NDArray[np.float32]:
    """Make the tile of another picture of the same place: its height, its normals, another photo of it.

    `correspondence` (N, N, 2) is a Tile's: the row and column of each pixel's patch; `other` (H, W) or (H, W, C), of
    the photo's size, of any range. Each pixel is the weighted mean of what the patches over it say, as for the colours,
    and opposite edges meet. With `normals` the C = 3 components (-1 to 1) are brought back to unit length. Returns
    (N, N) or (N, N, C) float32. Raises InputError where the two do not belong together.
    """
    picture = np.asarray(other, np.float32)
    planes = picture[..., None] if picture.ndim == 2 else picture
    if planes.ndim != 3 or planes.size == 0:
        raise InputError(f"The map to be carried along has the shape {picture.shape}; give (height, width) or three axes.")
    where = np.asarray(correspondence)
    if where.ndim != 3 or where.shape[2] != 2 or where.size == 0:
        raise InputError(f"A correspondence of shape {where.shape} is not one of a tile; give (size, size, 2).")
    height, width = planes.shape[:2]
    low, high = where.min(axis=(0, 1)), where.max(axis=(0, 1))
    if low.min() < RADIUS or high[0] > height - PATCH + RADIUS or high[1] > width - PATCH + RADIUS:
        raise InputError(f"The map to be carried along has {width} x {height} pixels and not the photo's; give one of its size.")
    if normals and planes.shape[2] != 3:
        raise InputError(f"A map of normals has three channels, and this one {planes.shape[2]}; leave out what is no normal.")
    tile = vote(from_centres(where, width), planes, LAST_SIGMA)
    if normals:
        length = np.linalg.norm(tile, axis=2, keepdims=True)
        tile = np.where(length > LEAST_LENGTH, tile / np.maximum(length, LEAST_LENGTH), np.array([0, 0, 1], np.float32))
    return np.ascontiguousarray(tile[..., 0] if picture.ndim == 2 else tile, np.float32)
