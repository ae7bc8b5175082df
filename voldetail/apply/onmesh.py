"""The same detail in another setup: other meshes, other lights."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any, Literal

from voldetail.apply.volumes import Progress, Tell, place, quiet, solid_surface, traced_medium, unseen
from voldetail.detail.photo_relief import AnyDetail, MappedDetail, domain_of, placed
from voldetail.errors import InputError
from voldetail.field.albedo import patterned
from voldetail.geometry.proxy import make_proxy
from voldetail.render.environment import environment_emitter
from voldetail.render.mesh_surface import MeshSurface, TracedMesh
from voldetail.render.plugins.phong import Diffuse, phong_dict, principled_equivalent, vertex_diffuse
from voldetail.render.traced import emitters_of
from voldetail.render.unit_components import components, traced_picture
from voldetail.render.volume import Volume
from voldetail.setup.camera import CameraSetup
from voldetail.setup.lamp import Lamp
from voldetail.setup.light import Light, direction_of, lamp_of
from voldetail.setup.proxy import ProxySetup
from voldetail.setup.shapes import SHAPES, simple_kind
from voldetail.setup.view import View, whole_view
from voldetail.types import Picture

Colour = tuple[float, float, float]
Shading = Literal["phong", "principled"]

FLAT_MARGIN = 1.0
"""A plane is shown filling the picture."""

MARGIN, SPARE = 1.15, 1.05
"""Half of the picture's shorter side about a shape that is 2 across, and the factor about a volume that rises from it."""

PIXELS_AN_EDGE = 1.0
"""Length of the mesh's edges in pixels: about one, so that relief and shading lose nothing that a picture can show."""


def render(
    detail: AnyDetail,
    mesh: str | Path = "sphere",
    *,
    light: Light | None = None,
    envmap: Path | None = None,
    scale: float = 1.0,
    size: tuple[int, int] = (640, 480),
    camera: CameraSetup | None = None,
    rotation: tuple[float, float, float] = (0.0, 0.0, 0.0),
    subsamples: int = 2,
    samples: int = 64,
    shading: Shading = "phong",
    background: float | Colour = 0.0,
    edge: float = PIXELS_AN_EDGE,
    tell: Tell = quiet,
    on_progress: Progress = unseen,
) -> Picture:
    """Return a linear picture (rows, columns, 3) of ``detail`` on ``mesh``: a kind of proxy or a mesh file.

    Under a ``light`` (default: azimuth 135, elevation 45 degrees) the picture is evaluated without noise on
    ``subsamples`` squared samples a pixel, the detail's ambient term being a uniform sky. Under an ``envmap``
    (equirectangular .exr or .hdr) it is path-traced with ``samples`` a pixel. ``scale`` makes the relief larger, cells
    and height alike; ``size`` is columns, rows; ``rotation`` turns the mesh about x, y, z in degrees; ``background`` is
    the radiance where there is no surface, one number or a colour; ``edge`` the length of the mesh's edges in pixels.

    A volume needs a closed mesh; its solid surface is seen as any other, a medium is marched under a light with the shading
    "phong" and path-traced with all its scattering else. ``tell`` then gets a sentence with the memory and time it takes,
    ``on_progress`` how many of a large surface's blocks are done, and of how many.
    Raises InputError for a mesh or environment that cannot be used.
    """
    if envmap is not None and light is not None:
        raise InputError("A light and an environment map were both given: choose one.")
    if light is not None and light.behind and detail.medium is None:
        raise InputError(f"The light cannot be used: {light.behind}.")
    view = _view(detail, scale, mesh, size, camera)
    lamp = lamp_of(light or _default_light())
    proxy, whole = _proxy(mesh, view, rotation)
    emitters: dict[str, Any] | None = None
    if envmap is not None:
        emitters = {"environment": environment_emitter(envmap)}
    if detail.medium is not None:
        # A medium is soft: finer cells than a volume's own would show nothing more.
        volume = place(detail, proxy, view, scale=scale, whole_plane=whole, tell=tell)
        if emitters is None and shading == "phong":
            volume.update(detail)
            return _lit(detail, volume, lamp, subsamples, background)
        return traced_picture(traced_medium(detail, volume, lamp=lamp, emitters=emitters), samples, background)
    if emitters is None and shading == "principled":
        # A sky as bright as the ambient term makes it on a matt surface.
        r = detail.reflectance
        emitters = emitters_of(lamp, r.ambient / r.diffuse if r.diffuse > 1e-6 else 0.0)
    surface = _surface(detail, view, proxy, whole, scale, edge, tell, _bsdf(detail, shading), emitters, on_progress)
    if emitters is not None:
        return traced_picture(surface, samples, background)
    return _lit(detail, surface, lamp, subsamples, background)


def relight(
    detail: AnyDetail,
    mesh: str | Path = "plane",
    *,
    azimuths: Sequence[float],
    elevations: Sequence[float],
    scale: float = 1.0,
    size: tuple[int, int] = (480, 480),
    camera: CameraSetup | None = None,
    rotation: tuple[float, float, float] = (0.0, 0.0, 0.0),
    subsamples: int = 2,
    background: float | Colour = 0.0,
    tell: Tell = quiet,
) -> Iterator[tuple[float, float, Picture]]:
    """Yield (azimuth, elevation, picture) for every pair of angles in degrees; the geometry is made once.

    Raises InputError for an elevation that is not above 0, at most 90 degrees; -90 to 90 for a medium.
    """
    for elevation in elevations:
        if not (0 < elevation <= 90 or (detail.medium is not None and abs(elevation) <= 90)):
            raise InputError(f"The elevation {elevation:g} is out of range: it has to be over 0, at most 90 degrees.")
    view = _view(detail, scale, mesh, size, camera)
    proxy, whole = _proxy(mesh, view, rotation)
    surface: TracedMesh | Volume
    if detail.medium is not None:
        surface = place(detail, proxy, view, scale=scale, whole_plane=whole, tell=tell)
        surface.update(detail)
    else:
        surface = _surface(detail, view, proxy, whole, scale, PIXELS_AN_EDGE, tell)
    for elevation in elevations:
        for azimuth in azimuths:
            lamp = Lamp(direction=direction_of(azimuth, elevation))
            yield azimuth, elevation, _lit(detail, surface, lamp, subsamples, background)


def _default_light() -> Light:
    return Light(direction=direction_of(135.0, 45.0))


def _flat(mesh: str | Path) -> bool:
    kind = simple_kind(str(mesh))
    return kind is not None and SHAPES[kind].flat


def _view(detail: AnyDetail, scale: float, mesh: str | Path, size: tuple[int, int], camera: CameraSetup | None) -> View:
    columns, rows = size
    if not (16 <= columns <= 8192 and 16 <= rows <= 8192):
        raise InputError(f"The size {columns}x{rows} is out of range: each side has to be 16 to 8192 pixels.")
    if _flat(mesh):
        # A photo's relief is seen as the photo was: its longest side is 2 units, where a plane's picture has its shortest so.
        whole = min(size) / max(size) if isinstance(detail, MappedDetail) else FLAT_MARGIN
        return whole_view(columns, rows, camera, whole)
    rises = 0.0
    if detail.mode == "volume":
        # What is seen of a cloud begins about where its density is half.
        soft = 0.0 if detail.medium is None else detail.medium.thickness / 4
        rises = (detail.relief.amplitude + soft) * scale
    return whole_view(columns, rows, camera, max(MARGIN, (1.0 + rises) * SPARE))


def _proxy(mesh: str | Path, view: View, rotation: tuple[float, float, float]) -> tuple[ProxySetup, bool]:
    """Return the proxy and whether it is the plane that fills the picture and a little more, so that no edge is seen."""
    proxy = proxy_of(mesh, rotation)
    if proxy.row.flat and rotation == (0.0, 0.0, 0.0):
        wide = 2.1 * max(view.right, view.top)
        return proxy.model_copy(update={"size": (wide, wide, 0.0)}), True
    return proxy, False


def on_shape(detail: AnyDetail, proxy: ProxySetup) -> AnyDetail:
    """Return ``detail`` as it goes onto a shape, see `placed`."""
    if not isinstance(detail, MappedDetail):
        return detail
    return placed(detail, flat=proxy.row.flat)


def proxy_of(mesh: str | Path, rotation: tuple[float, float, float]) -> ProxySetup:
    """Return the proxy for a kind of shape or a mesh file."""
    kind = simple_kind(str(mesh))
    if kind is None:
        return ProxySetup(kind="mesh", mesh=Path(mesh), rotation=rotation)
    return ProxySetup(kind=kind, rotation=rotation)


def _surface(
    detail: AnyDetail,
    view: View,
    proxy: ProxySetup,
    whole_plane: bool,
    scale: float,
    edge: float,
    tell: Tell,
    bsdf: dict[str, Any] | None = None,
    emitters: dict[str, Any] | None = None,
    on_progress: Progress = unseen,
) -> TracedMesh:
    """Return the surface of ``detail``: the displaced proxy, or that of solid matter."""
    if detail.mode == "volume":
        # Under perspective a plane's window is not all that is seen of it.
        filling = whole_plane and not view.perspective
        volume = place(detail, proxy, view, scale=scale, whole_plane=filling, edge=edge * view.pixel, tell=tell)
        return solid_surface(detail, volume, bsdf=bsdf, emitters=emitters, on_progress=on_progress)
    detail = on_shape(detail, proxy)
    made = make_proxy(proxy, edge * view.pixel, domain_of(detail))
    surface = MeshSurface(made, view, scale=scale, bsdf=bsdf, emitters=emitters, one_sided_sky=proxy.row.flat)
    surface.update(detail)
    return surface


def _lit(detail: AnyDetail, surface: TracedMesh | Volume, lamp: Lamp, subsamples: int, background: float | Colour) -> Picture:
    """Return the picture under one light and the detail's own sky, without noise."""
    parts = components(surface, lamp, subsamples=subsamples, shininess=(detail.reflectance.shininess,))
    return parts.colour(detail.reflectance, background)


def _bsdf(detail: AnyDetail, shading: Shading) -> dict[str, Any]:
    r = detail.reflectance
    diffuse: Diffuse = [min(r.diffuse * c, 1.0) for c in r.tint]
    if patterned(detail):
        diffuse = vertex_diffuse()
    if shading == "principled":
        return principled_equivalent(diffuse, r.specular, r.shininess)
    return phong_dict(diffuse, r.specular, r.shininess)
