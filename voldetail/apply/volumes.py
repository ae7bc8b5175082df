"""A volumetric detail on any closed shape: the surface of solid matter as a mesh, a medium marched or path-traced."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any

from voldetail.detail import Detail
from voldetail.errors import InputError
from voldetail.field.larger_cells import affordable_edge
from voldetail.field.medium import tinted_albedo
from voldetail.field.shell_grid import ShellPlan
from voldetail.field.shell_plan import OverBudgetError
from voldetail.field.tiled_surface import tiled_isosurface
from voldetail.geometry.isosurface import isosurface
from voldetail.geometry.primitives.primitive import primitive_of
from voldetail.render.mesh_surface import VolumeSurface
from voldetail.render.traced_medium import TracedVolume
from voldetail.render.volume import MEDIUM_PIXELS, SOLID_PIXELS, Volume, medium_of, thinnest_edge
from voldetail.setup.lamp import Lamp
from voldetail.setup.proxy import ProxySetup
from voldetail.setup.view import View

BUDGET = 2 << 30
"""Bytes that a volume may take; where cells of the wanted size take more, they become larger."""

MARCHED_BYTES = 80
"""For each cell of a marched grid at the peak, gradients, depths and copies: 1.3 GB for 256 cells a side."""

COARSER = 1.05
NO_LIMIT = 1 << 62

Tell = Callable[[str], None]
Progress = Callable[[int, int], None]


def quiet(sentence: str) -> None:
    """Take no notice of what is told."""


def unseen(done: int, total: int) -> None:
    """Take no notice of how much is done."""


def place(
    detail: Detail,
    proxy: ProxySetup,
    view: View,
    *,
    scale: float = 1.0,
    whole_plane: bool = False,
    edge: float | None = None,
    whole_grid: bool = False,
    tell: Tell = quiet,
) -> Volume:
    """Return ``proxy`` ready for ``detail``, on cells about as large as a pixel or as the memory allows; nothing is baked yet.

    ``whole_grid``: the densities themselves are wanted, and not, of solid matter, the surface alone.
    ``tell`` gets a sentence with the cells, the memory and the time that this will take. Raises InputError for an open mesh.
    """
    solid = detail.medium is None
    wanted = edge or SOLID_PIXELS * view.pixel
    if detail.medium is not None and edge is None:
        # As fine as its edge needs, between half a pixel and what a soft one makes do with.
        needed = detail.medium.thickness * scale / thinnest_edge(1.0, detail.medium.exponent)
        wanted = min(max(needed, 0.5 * view.pixel), MEDIUM_PIXELS * view.pixel)

    def volume_of(edge: float) -> Volume:
        # A medium's own plan does not know what marching it takes on top, which is what is held against the budget below.
        allowed = BUDGET if solid else NO_LIMIT
        tiles = solid and not whole_grid
        return Volume(proxy, view, edge=edge, scale=scale, whole_plane=whole_plane, budget=allowed, tiles=tiles)

    def share(edge: float) -> float:
        try:
            plan = planned(volume_of(edge), detail)
        except OverBudgetError:
            return math.inf
        return 0.0 if solid else plan.cells * MARCHED_BYTES / BUDGET

    used = affordable_edge(wanted, share, least_step=COARSER, trust=1.0)
    volume = volume_of(used)
    plan = planned(volume, detail)
    tell(_sentence(plan, plan.byte_count if solid else plan.cells * MARCHED_BYTES, used / wanted))
    return volume


def planned(volume: Volume, detail: Detail) -> ShellPlan:
    """Return the grid that ``detail`` needs on ``volume``."""
    thickness, amplitude = volume.lengths(detail)
    return volume.plan(thickness, amplitude, detail.medium is None)


def _sentence(plan: ShellPlan, byte_count: int, coarser: float) -> str:
    words = replace(plan, byte_count=byte_count).sentence
    if coarser > 1.0:
        words += f"; cells are {coarser:.2g} times as large as wanted, to stay within {BUDGET / 2**20:.0f} MB"
    return words


def solid_surface(
    detail: Detail,
    volume: Volume,
    *,
    bsdf: dict[str, Any] | None,
    emitters: dict[str, Any] | None = None,
    on_progress: Progress = unseen,
) -> VolumeSurface:
    """Return the surface of the solid ``detail`` on ``volume`` in a Mitsuba scene.

    Where the grid would be too large it is made by tiles, of which ``on_progress`` gets how many are done.
    """
    texture = volume.texture(detail)
    if texture.shell.plan.blocks:
        surface = tiled_isosurface(texture, on_progress=on_progress, budget=BUDGET)
    else:
        surface = isosurface(texture.bake(), texture.level, texture.outward_at, budget=BUDGET)
    one_sided = primitive_of(volume.proxy).slab
    return VolumeSurface(texture, surface, volume.view, one_sided_sky=one_sided, bsdf=bsdf, emitters=emitters)


def traced_medium(
    detail: Detail, volume: Volume, *, lamp: Lamp | None = None, emitters: dict[str, Any] | None = None
) -> TracedVolume:
    """Return the medium ``detail`` on ``volume`` for path tracing, with all orders of scattering.

    Under a ``lamp`` it and the sky are as strong and as tinted as the fit found them; under ``emitters`` of one's own
    (an environment map) the tint is the medium's.
    """
    if detail.medium is None:
        raise InputError("Solid matter is no medium: it has a surface to be traced.")
    reflectance, grid = detail.reflectance, volume.texture(detail).bake()
    medium = medium_of(detail, volume.edge, volume.scale)
    if emitters is not None:
        albedo = tinted_albedo(detail.medium.albedo, detail.medium.asymmetry, reflectance.tint)
        return TracedVolume(grid, medium, volume.view, None, albedo=albedo, emitters=emitters)
    assert lamp is not None
    beam = lamp.scaled(reflectance.diffuse)
    return TracedVolume(
        grid, medium, volume.view, beam, sky=reflectance.ambient, albedo=detail.medium.albedo, tint=reflectance.tint
    )
