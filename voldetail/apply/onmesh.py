"""The same detail in another setup: other meshes, other lights."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any, Literal, get_args

import numpy as np
from numpy.typing import NDArray

from voldetail.detail import Detail
from voldetail.errors import InputError
from voldetail.render import components, traced_picture
from voldetail.scene.environment import environment_emitter
from voldetail.scene.lamp import Lamp, lamp_of
from voldetail.scene.lights_text import direction_of
from voldetail.scene.phong import phong_dict, principled_equivalent
from voldetail.scene.proxy import Proxy, make_proxy
from voldetail.scene.setup import CameraSetup, Light, ProxySetup
from voldetail.scene.surface import MeshSurface
from voldetail.scene.traced import emitters_of
from voldetail.scene.view import View, whole_view

Picture = NDArray[np.float32]
Shading = Literal["phong", "principled"]
KINDS: tuple[str, ...] = tuple(k for k in get_args(ProxySetup.model_fields["kind"].annotation) if k != "mesh")

FLAT_MARGIN = 1.0
"""A plane is shown filling the picture; other shapes get the margin of `whole_view`."""

PIXELS_AN_EDGE = 1.0
"""Length of the mesh's edges in pixels: about one, so that relief and shading lose nothing that a picture can show."""


def render(
    detail: Detail, mesh: str | Path = "sphere", *, light: Light | None = None, envmap: Path | None = None,
    scale: float = 1.0, size: tuple[int, int] = (640, 480), camera: CameraSetup | None = None,
    rotation: tuple[float, float, float] = (0.0, 0.0, 0.0), subsamples: int = 2, samples: int = 64,
    shading: Shading = "phong", background: float = 0.0, edge: float = PIXELS_AN_EDGE,
) -> Picture:
    """Return a linear picture (rows, columns, 3) of ``detail`` on ``mesh``: a kind of proxy or a mesh file.

    Under a ``light`` (default: azimuth 135, elevation 45 degrees) the picture is evaluated without noise on
    ``subsamples`` squared samples a pixel, the detail's ambient term being a uniform sky. Under an ``envmap``
    (equirectangular .exr or .hdr) it is path-traced with ``samples`` a pixel. ``scale`` makes the relief larger, cells
    and height alike; ``size`` is columns, rows; ``rotation`` turns the mesh about x, y, z in degrees; ``background`` is
    the radiance where there is no surface; ``edge`` the length of the mesh's edges in pixels.
    Raises InputError for a mesh or environment that cannot be used.
    """
    if envmap is not None and light is not None:
        raise InputError("A light and an environment map were both given: choose one.")
    view = _view(mesh, size, camera)
    light = light or _default_light()
    emitters: dict[str, Any] | None = None
    if envmap is not None:
        emitters = {"environment": environment_emitter(envmap)}
    elif shading == "principled":
        # A sky as bright as the ambient term makes it on a matt surface.
        r = detail.reflectance
        emitters = emitters_of(lamp_of(light), r.ambient / r.diffuse if r.diffuse > 1e-6 else 0.0)
    surface = MeshSurface(
        _proxy(detail, mesh, view, rotation, edge), view, scale=scale, bsdf=_bsdf(detail, shading), emitters=emitters,
        one_sided_sky=str(mesh) == "plane",
    )
    surface.update(detail)
    if emitters is not None:
        return traced_picture(surface, samples, background)
    return _lit(detail, surface, lamp_of(light), subsamples, background)


def relight(
    detail: Detail, mesh: str | Path = "plane", *, azimuths: Sequence[float], elevations: Sequence[float],
    scale: float = 1.0, size: tuple[int, int] = (480, 480), camera: CameraSetup | None = None,
    rotation: tuple[float, float, float] = (0.0, 0.0, 0.0), subsamples: int = 2, background: float = 0.0,
) -> Iterator[tuple[float, float, Picture]]:
    """Yield (azimuth, elevation, picture) for every pair of angles in degrees; the geometry is made once.

    Raises InputError for an elevation that is not above 0, at most 90 degrees.
    """
    for elevation in elevations:
        if not 0 < elevation <= 90:
            raise InputError(f"The elevation {elevation:g} is out of range: it has to be over 0, at most 90 degrees.")
    view = _view(mesh, size, camera)
    surface = MeshSurface(
        _proxy(detail, mesh, view, rotation), view, scale=scale, one_sided_sky=str(mesh) == "plane"
    )
    surface.update(detail)
    for elevation in elevations:
        for azimuth in azimuths:
            lamp = Lamp(direction=direction_of(azimuth, elevation))
            yield azimuth, elevation, _lit(detail, surface, lamp, subsamples, background)


def _default_light() -> Light:
    return Light(direction=direction_of(135.0, 45.0))


def _view(mesh: str | Path, size: tuple[int, int], camera: CameraSetup | None) -> View:
    columns, rows = size
    if not (16 <= columns <= 8192 and 16 <= rows <= 8192):
        raise InputError(f"The size {columns}x{rows} is out of range: each side has to be 16 to 8192 pixels.")
    return whole_view(columns, rows, camera, FLAT_MARGIN if str(mesh) == "plane" else 1.15)


def _proxy(
    detail: Detail, mesh: str | Path, view: View, rotation: tuple[float, float, float], edge: float = PIXELS_AN_EDGE
) -> Proxy:
    kind = str(mesh)
    if kind == "plane" and rotation == (0.0, 0.0, 0.0):
        # Fills the picture and a little more, so that no edge is seen.
        wide = 2.1 * max(view.right, view.top)
        setup = ProxySetup(kind="plane", size=(wide, wide, 0.0))
    elif kind in KINDS:
        setup = ProxySetup(kind=kind, rotation=rotation)  # type: ignore[arg-type]
    else:
        setup = ProxySetup(kind="mesh", mesh=Path(mesh), rotation=rotation)
    return make_proxy(setup, edge * view.pixel, detail.noise.domain)


def _lit(detail: Detail, surface: MeshSurface, lamp: Lamp, subsamples: int, background: float) -> Picture:
    """Return the picture under one light and the detail's own sky, without noise."""
    parts = components(surface, lamp, subsamples=subsamples, shininess=(detail.reflectance.shininess,))
    picture = parts.colour(detail.reflectance)
    return np.asarray(picture + (1.0 - parts.covered[..., None]) * background, dtype=np.float32)


def _bsdf(detail: Detail, shading: Shading) -> dict[str, Any]:
    r = detail.reflectance
    diffuse = [min(r.diffuse * c, 1.0) for c in r.tint]
    if shading == "principled":
        return principled_equivalent(diffuse, r.specular, r.shininess)
    return phong_dict(diffuse, r.specular, r.shininess)
