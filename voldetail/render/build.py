"""From a Setup and a photo's size to a surface that can be looked at; the only place that chooses the way."""

from __future__ import annotations

from dataclasses import replace
from typing import Protocol

import numpy as np

from voldetail.detail import Detail
from voldetail.geometry.primitives.primitive import primitive_of
from voldetail.geometry.proxy import Proxy, make_proxy, seen_part
from voldetail.render.heightfield import HeightField
from voldetail.render.mesh_surface import MeshSurface
from voldetail.render.volume import Volume, fitting_edge
from voldetail.setup.proxy import ProxySetup
from voldetail.setup.setup import Setup
from voldetail.setup.view import View, Zone, view_of

FLAT_MARGIN = 16
"""Pixels by which the mesh of a flat proxy is larger than the window, so that relief outside casts its shadows in."""

SHADOW_REACH = 0.1
"""Scene units beyond the window from which relief on other shapes may cast its shadows in."""


class Surface(Protocol):
    """What `render` needs of a scene."""

    view: View

    def update(self, detail: Detail) -> None: ...
    def samples(self, subsamples: int) -> tuple[object, object, object, object, object]: ...
    def lit(self, points: object, normals: object, direction: object, distance: object) -> object: ...


def build(
    setup: Setup, photo_shape: tuple[int, int], zone: Zone | None, *, fast: bool = True
) -> HeightField | MeshSurface | Volume:
    """Return the surface of ``setup`` seen through ``zone`` of a photo of ``photo_shape`` (rows, columns).

    A plane that faces an orthographic camera becomes a HeightField when ``fast``, a volume a marched one; all else a
    MeshSurface in Mitsuba.
    """
    view = view_of(setup.camera, photo_shape, zone, setup.photo.resolution)
    if setup.mode == "volume":
        return Volume(setup.proxy, view, edge=edge_of(setup, view), whole_plane=faces_camera(setup))
    if faces_camera(setup):
        if fast:
            return HeightField(view, setup.proxy.position)
        return MeshSurface(_covering(view, setup), view, one_sided_sky=True)
    proxy = make_proxy(setup.proxy, view.pixel, setup.domain)
    if not view.perspective:
        margin = max(FLAT_MARGIN * view.pixel, SHADOW_REACH)
        proxy = seen_part(proxy, view, margin, convex=primitive_of(setup.proxy).convex)
    return MeshSurface(proxy, view, one_sided_sky=primitive_of(setup.proxy).slab)


def edge_of(setup: Setup, view: View) -> float:
    """Return the edge of a volume's cells: a pixel or two, or what a fit's thousands of pictures have time for."""
    return fitting_edge(setup.proxy, view, solid=not setup.medium, whole_plane=faces_camera(setup))


def faces_camera(setup: Setup) -> bool:
    """Whether the proxy is a plane seen head-on without perspective, which fills the view."""
    proxy = setup.proxy
    return (
        proxy.row.flat
        and setup.camera.kind == "orthographic"
        and proxy.size is None
        and all(angle == 0 for angle in proxy.rotation)
    )


def _covering(view: View, setup: Setup) -> Proxy:
    """Return a plane that covers the view and its margin, at the proxy's depth; its noise stays the proxy's own."""
    margin = FLAT_MARGIN * view.pixel
    x, y, z = setup.proxy.position
    middle = ((view.left + view.right) / 2, (view.top + view.bottom) / 2, z)
    size = (view.right - view.left + 2 * margin, view.top - view.bottom + 2 * margin, 0.0)
    plane = make_proxy(ProxySetup(kind="plane", size=size, position=middle), view.pixel, setup.domain)
    shift = np.array([middle[0] - x, middle[1] - y, 0.0], dtype=np.float32)
    return replace(plane, domain=plane.domain + shift)
