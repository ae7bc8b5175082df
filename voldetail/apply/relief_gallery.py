"""The pictures of a photo's own relief: its maps, other lights, a grazing view, shapes, its tile."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np

from voldetail.apply.gallery import EDGE, GRAZING_TILT, OTHER_LIGHTS, side_words
from voldetail.apply.onmesh import render
from voldetail.detail.photo_relief import MappedDetail
from voldetail.detail.relief_maps import normals_of
from voldetail.image import resize, to_linear
from voldetail.render.heightfield import HeightField
from voldetail.render.unit_components import components
from voldetail.results.relief_gallery import ReliefGallery
from voldetail.setup.camera import CameraSetup
from voldetail.setup.lamp import Lamp
from voldetail.setup.light import Light, direction_of
from voldetail.setup.view import View
from voldetail.types import Picture

LONGEST = 480
"""Pixels of the longest side of the flat pictures."""

SHAPE_SIDE = 300

TONES = (1.0, 99.0)
"""Percentiles of height that are drawn black and white."""


def relief_gallery(
    detail: MappedDetail,
    photo: Picture,
    again: Picture,
    *,
    tile: MappedDetail | None = None,
    mesh: str | Path = "cylinder",
    on_progress: Callable[[str], None] = lambda what: None,
) -> ReliefGallery:
    """Return the pictures of ``detail``, recovered from ``photo`` (H, W, 3), which its maps make again as ``again``."""
    small = LONGEST / max(photo.shape[:2])
    size = (max(16, round(photo.shape[0] * small)), max(16, round(photo.shape[1] * small))) if small < 1 else photo.shape[:2]
    size = (size[0], size[1])
    on_progress("other lights")
    lights = under_lights(detail, size)
    lamp = Light(direction=direction_of(150.0, 40.0))
    side = (SHAPE_SIDE, SHAPE_SIDE)
    shapes = []
    for name, shape, options in (
        ("Seen at a grazing angle", "plane", {"rotation": (GRAZING_TILT, 0.0, 0.0), "camera": CameraSetup(kind="perspective")}),
        ("On a sphere", "sphere", {}),
        (f"On another shape: {Path(mesh).stem}", mesh, {}),
    ):
        on_progress(name[:1].lower() + name[1:])
        shapes.append((name, render(detail, shape, light=lamp, size=side, edge=EDGE, **options)))  # type: ignore[arg-type]
    repeated = None
    if tile is not None:
        on_progress("the tile, twice each way")
        repeated = _twice(tile)
    return ReliefGallery(
        photo=resize(photo, size), again=resize(again, size), height=resize(height_picture(detail), size),
        normal=resize(normal_picture(detail), size), albedo=resize(detail.albedo, size), lights=lights, shapes=tuple(shapes),
        tile=repeated,
    )  # fmt: skip


def under_lights(detail: MappedDetail, size: tuple[int, int]) -> tuple[tuple[str, Picture], ...]:
    """Return captions and pictures of ``size`` (rows, columns) of the photo's plane, lit from four sides."""
    unit = 1.0 / max(size)
    field = HeightField(View(-size[1] * unit, size[1] * unit, -size[0] * unit, size[0] * unit, size[1], size[0]))
    field.update(detail)  # type: ignore[arg-type]
    out = []
    for azimuth, elevation in OTHER_LIGHTS:
        lamp = Lamp(direction_of(azimuth, elevation))
        parts = components(field, lamp, subsamples=2, shininess=(detail.reflectance.shininess,))
        out.append((f"Light from {side_words(azimuth)}, {elevation:g}\N{DEGREE SIGN} high", parts.colour(detail.reflectance)))
    return tuple(out)


def _twice(tile: MappedDetail) -> Picture:
    """Return two by two of a tile, from above, under a light from the upper left."""
    half = 2.0 * max(tile.record.columns, tile.record.rows) / tile.record.texels_per_unit / 2.0
    field = HeightField(View(-half, half, -half, half, LONGEST, LONGEST))
    field.update(tile)  # type: ignore[arg-type]
    lamp = Lamp(direction_of(150.0, 40.0))
    return components(field, lamp, subsamples=2, shininess=(tile.reflectance.shininess,)).colour(tile.reflectance)


def height_picture(detail: MappedDetail) -> Picture:
    """Return height as grey, as a screen shows it evenly: linear light (H, W, 3)."""
    low, high = np.percentile(detail.height, TONES)
    grey = np.clip((detail.height - low) / max(float(high - low), 1e-6), 0.0, 1.0)
    return np.repeat(to_linear(grey)[..., None], 3, axis=2).astype(np.float32)


def normal_picture(detail: MappedDetail) -> Picture:
    """Return normals in the colours that they have in a file."""
    record = detail.record
    normals = normals_of(detail.height * np.float32(record.relief.amplitude), record.texels_per_unit, periodic=record.periodic)
    return np.asarray(to_linear(0.5 * (normals + 1.0)), np.float32)
