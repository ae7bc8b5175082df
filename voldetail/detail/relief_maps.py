"""What the numbers in the maps of a photo's relief mean, between pictures and arrays."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

HEIGHT, NORMAL, ALBEDO, ROUGHNESS = "height.exr", "normal.png", "albedo.png", "roughness.png"
"""File names beside `relief.json`."""

RELIEF_FILES = ("relief.json", HEIGHT, NORMAL, ALBEDO, ROUGHNESS)
"""All files of a relief."""


def normals_of(height: NDArray[np.float32], texels_per_unit: float, *, periodic: bool = False) -> NDArray[np.float32]:
    """Return unit normals (H, W, 3), x right, y up, z to the viewer, of heights (H, W) in scene units.

    Central differences, n = (-dh/dx, -dh/dy, 1) / |.|; at the edges of what is no tile one-sided ones.
    """
    if periodic:
        right, left = np.roll(height, -1, axis=1), np.roll(height, 1, axis=1)
        below, above = np.roll(height, -1, axis=0), np.roll(height, 1, axis=0)
        p, q = (right - left) * (0.5 * texels_per_unit), (above - below) * (0.5 * texels_per_unit)
    else:
        down, right_ward = np.gradient(np.asarray(height, np.float64))
        p, q = np.asarray(right_ward) * texels_per_unit, np.asarray(down) * -texels_per_unit
    length = np.asarray(np.sqrt(p * p + q * q + 1.0))
    return np.stack([-p / length, -q / length, 1.0 / length], axis=-1).astype(np.float32)
