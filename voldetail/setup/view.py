"""The window through which a scene is seen: which ray belongs to which pixel.

The longest side of the whole photo is 2 scene units wide on the plane through the origin, for both projections; the
zone is a window of it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from voldetail.setup.camera import CameraSetup

Zone = tuple[int, int, int, int]


@dataclass(frozen=True)
class View:
    """A camera on the z axis and a window of its image plane.

    left, right, bottom, top: the window on the plane z = 0, in scene units. columns, rows: its size in pixels.
    distance: from the camera to the origin. perspective: rays through one point, else parallel to -z.
    """

    left: float
    right: float
    bottom: float
    top: float
    columns: int
    rows: int
    distance: float = 4.0
    perspective: bool = False

    @property
    def pixel(self) -> float:
        """Size of a pixel on the plane z = 0, in scene units."""
        return (self.right - self.left) / self.columns

    def coordinates(self, subsamples: int) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
        """Return x and y on the plane z = 0 of a regular grid of ``subsamples`` squared samples a pixel, row by row."""
        columns, rows = self.columns * subsamples, self.rows * subsamples
        x = self.left + (np.arange(columns) + 0.5) * (self.right - self.left) / columns
        y = self.top - (np.arange(rows) + 0.5) * (self.top - self.bottom) / rows
        gx, gy = np.meshgrid(x, y)
        return gx.astype(np.float32).ravel(), gy.astype(np.float32).ravel()


def view_of(camera: CameraSetup, photo_shape: tuple[int, int], zone: Zone | None, resolution: int) -> View:
    """Return the View of ``zone`` (pixels of a photo of ``photo_shape`` rows and columns; None: all of it).

    The longest side of the zone becomes ``resolution`` pixels.
    """
    height, width = photo_shape
    x, y, w, h = zone or (0, 0, width, height)
    unit = 2.0 / max(height, width)
    left, top = (x - width / 2) * unit, (height / 2 - y) * unit
    factor = resolution / max(w, h)
    perspective = camera.kind == "perspective"
    distance = camera.distance_used
    # A camera moved along its axis sees another width at the origin; the window scales with it.
    zoom = distance * math.tan(math.radians(camera.field_of_view) / 2) if perspective else 1.0
    return View(
        left=left * zoom,
        right=(left + w * unit) * zoom,
        bottom=(top - h * unit) * zoom,
        top=top * zoom,
        columns=max(1, round(w * factor)),
        rows=max(1, round(h * factor)),
        distance=distance,
        perspective=perspective,
    )


def whole_view(columns: int, rows: int, camera: CameraSetup | None = None, margin: float = 1.15) -> View:
    """Return a View that shows a proxy 2 across with some margin, for renders that follow no photo."""
    half = margin
    aspect = columns / rows
    wide, high = (half * aspect, half) if aspect >= 1 else (half, half / aspect)
    if camera is None or camera.kind == "orthographic":
        return View(-wide, wide, -high, high, columns, rows)
    return View(-wide, wide, -high, high, columns, rows, camera.distance_used, True)
