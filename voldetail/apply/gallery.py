"""The pictures of a fit's report: what was fitted, and the detail under other lights, views and on other shapes."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import binary_dilation, binary_erosion

from voldetail.apply.onmesh import render
from voldetail.detail import Detail, with_values
from voldetail.image import resize
from voldetail.render.build import build, faces_camera
from voldetail.render.unit_components import components
from voldetail.results import FitResult, Gallery
from voldetail.setup.camera import CameraSetup
from voldetail.setup.lamp import Lamp
from voldetail.setup.light import Light, direction_of
from voldetail.setup.photo import PhotoSetup
from voldetail.setup.setup import Setup
from voldetail.types import Picture

OTHER_LIGHTS = ((0.0, 35.0), (90.0, 35.0), (180.0, 35.0), (270.0, 35.0))
"""Azimuth and elevation of the four other lights, in degrees: low enough to show the relief from every side."""

OVERLAY_SIDE = 512
GRAZING_TILT = -68.0
"""Degrees by which the plane of the grazing view is tipped away from the viewer."""

SHAPE_SIDE = 360

EDGE = 1.5
"""Length of the mesh's edges in pixels: a report's small pictures come in half the time that one pixel would take."""


def gallery(result: FitResult, on_progress: Callable[[str], None] = lambda what: None, mesh: str | Path = "cylinder") -> Gallery:
    """Return the Gallery of a FitResult; ``mesh`` is the kind of proxy or file for its last picture."""
    detail, setup, target = result.detail, result.setup, result.target
    surface = build(setup, target.shape, target.zone)
    surface.update(detail)

    def under(lamp: Lamp) -> Picture:
        parts = components(surface, lamp, subsamples=3, shininess=(detail.reflectance.shininess,))
        return parts.colour(detail.reflectance, result.background)

    on_progress("the fit and four other lights")
    fitted = under(target.lamp)
    lights = tuple(
        (f"light from {side_words(azimuth)}, {up:g}\N{DEGREE SIGN} high", under(Lamp(direction_of(azimuth, up))))
        for azimuth, up in OTHER_LIGHTS
    )
    on_progress("a grazing view")
    side = (SHAPE_SIDE, SHAPE_SIDE)
    lamp = Light(direction=direction_of(160.0, 40.0))
    # The relief keeps the size it has in the photo, where a proxy is 2 across.
    scale = 1.0
    grazing = render(
        detail,
        "plane",
        light=lamp,
        scale=scale,
        size=side,
        rotation=(GRAZING_TILT, 0.0, 0.0),
        edge=EDGE,
        camera=CameraSetup(kind="perspective"),
        background=result.background,
    )
    on_progress("a sphere")
    sphere = render(detail, "sphere", light=lamp, scale=scale, size=side, edge=EDGE, background=result.background)
    on_progress(f"a {Path(mesh).stem}")
    other = render(detail, mesh, light=lamp, scale=scale, size=side, edge=EDGE, background=result.background)
    return Gallery(
        photo=target.pixels,
        mask=target.mask,
        overlay=overlay(setup, target),
        fitted=fitted,
        lights=lights,
        grazing=grazing,
        sphere=sphere,
        mesh=other,
        mesh_name=Path(mesh).stem,
    )


def side_words(azimuth: float) -> str:
    """Return where a light of OTHER_LIGHTS comes from."""
    return {0.0: "the right", 90.0: "above", 180.0: "the left", 270.0: "below"}[azimuth]


def overlay(setup: Setup, target: Any) -> Picture:
    """Return the whole photo, small, with the proxy's outline (orange), the unused part dark and the zone (white)."""
    rows, columns = target.shape
    factor = OVERLAY_SIDE / max(rows, columns)
    size = (max(1, round(rows * factor)), max(1, round(columns * factor)))
    picture = np.array(resize(target.photo.pixels, size))
    outline, inside = _outline(setup, target.shape, size)
    picture[~inside] *= 0.35
    x, y, w, h = (round(v * factor) for v in target.zone)
    window = np.zeros(size, dtype=bool)
    window[y : y + h, x : x + w] = True
    unused = np.zeros(size, dtype=bool)
    part = resize(np.repeat(target.mask[..., None].astype(np.float32), 3, axis=2), (max(1, h), max(1, w)))[..., 0] < 0.5
    part = part[: unused[y : y + h, x : x + w].shape[0], : unused[y : y + h, x : x + w].shape[1]]
    unused[y : y + part.shape[0], x : x + part.shape[1]] = part
    picture[unused] *= 0.35
    picture[binary_dilation(window, iterations=2) & ~window] = (1.0, 1.0, 1.0)
    picture[outline] = (1.0, 0.35, 0.02)
    return picture.astype(np.float32)


def _outline(setup: Setup, shape: tuple[int, int], size: tuple[int, int]) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """Return (edge of the proxy in the photo, where it is) as masks of ``size``; a plane that fills it has no edge."""
    if faces_camera(setup):
        return np.zeros(size, dtype=bool), np.ones(size, dtype=bool)
    photo = PhotoSetup(path=setup.photo.path, resolution=max(size))
    small = setup.model_copy(update={"photo": photo, "mode": "displacement", "look": "surface"})
    surface = build(small, shape, None)
    surface.update(with_values(Detail(), {"relief.amplitude": 0.0, "noise.domain": setup.domain}))
    parts = components(surface, Lamp((0.0, 0.0, 1.0)), subsamples=1, shininess=())
    inside = parts.covered[: size[0], : size[1]] > 0.5
    return binary_dilation(inside, iterations=1) & ~binary_erosion(inside, iterations=1), inside
