"""Which part of a photo is recovered: a picture of its own, whose longest side is 2 scene units."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from voldetail.errors import InputError
from voldetail.image import Photo, resize, resize_mask, used_of
from voldetail.setup.lamp import Lamp
from voldetail.setup.view import View, Zone


def box_of(used: NDArray[np.bool_]) -> Zone:
    """Return the box of what is used: x, y, width, height."""
    rows, columns = np.flatnonzero(used.any(axis=1)), np.flatnonzero(used.any(axis=0))
    return int(columns[0]), int(rows[0]), int(columns[-1] - columns[0]) + 1, int(rows[-1] - rows[0]) + 1


def lamp_about(lamp: Lamp, view: View) -> Lamp:
    """Return ``lamp`` as it stands to the middle of ``view`` taken for 2 scene units: a zone is a picture of its own."""
    if lamp.position is None:
        return lamp
    scale = 2.0 / max(view.right - view.left, view.top - view.bottom)
    x, y, z = lamp.position
    middle = 0.5 * (view.left + view.right), 0.5 * (view.bottom + view.top)
    return Lamp(
        position=((x - middle[0]) * scale, (y - middle[1]) * scale, z * scale), strength=lamp.strength,
        at_camera=lamp.at_camera, axis=lamp.axis, cone=lamp.cone,
    )  # fmt: skip


def about_middle(view: View) -> View:
    """Return the view of a picture of ``view``'s pixels whose longest side is 2 scene units."""
    unit = 1.0 / max(view.columns, view.rows)
    return View(-view.columns * unit, view.columns * unit, -view.rows * unit, view.rows * unit, view.columns, view.rows)


def cut(photo: Photo, zone: Zone, size: tuple[int, int]) -> tuple[NDArray[np.float32], NDArray[np.bool_]]:
    """Return the zone of the photo and of what is used of it, at ``size``."""
    x, y, w, h = zone
    rows, columns = photo.pixels.shape[:2]
    if x + w > columns or y + h > rows:
        raise InputError(
            f"The zone {x},{y},{w},{h} reaches outside the photo of {columns} x {rows} pixels: x + width and y + height must stay"
            " within it."
        )
    part = slice(y, y + h), slice(x, x + w)
    used = used_of(photo)[part]
    if (h, w) == size:
        pixels, inside = np.ascontiguousarray(photo.pixels[part]), np.ascontiguousarray(used)
    else:
        pixels, inside = resize(photo.pixels[part], size), resize_mask(used, size)
    if not inside.any():
        raise InputError("The mask leaves nothing of the zone: use a larger mask or another --zone.")
    return pixels, inside
