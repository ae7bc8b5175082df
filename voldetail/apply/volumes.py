"""A volumetric detail on any closed shape: the surface of solid matter as a mesh, a medium marched or path-traced."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from voldetail.detail import Detail
from voldetail.errors import InputError
from voldetail.scene.isosurface import isosurface
from voldetail.scene.lamp import Lamp
from voldetail.scene.setup import ProxySetup
from voldetail.scene.shell_plan import ShellPlan
from voldetail.scene.surface import VolumeSurface
from voldetail.scene.traced_medium import TracedVolume
from voldetail.scene.view import View
from voldetail.scene.volume import MEDIUM_PIXELS, SOLID_PIXELS, Volume, medium_of

BUDGET = 2 << 30
"""Bytes that a volume may take; where cells of the wanted size take more, they become larger."""

MARCHED_BYTES = 80
SOLID_BYTES = 32
"""For each cell, at the peak: gradients, depths and copies of a marched grid (1.3 GB for 256 cells a side), and those of the
iso-surface."""

COARSER = 1.05

Tell = Callable[[str], None]


def quiet(sentence: str) -> None:
    """Take no notice of what is told."""


def place(
    detail: Detail, proxy: ProxySetup, view: View, *, scale: float = 1.0, whole_plane: bool = False, edge: float | None = None,
    tell: Tell = quiet,
) -> Volume:
    """Return ``proxy`` ready for ``detail``, on cells about as large as a pixel or as the memory allows; nothing is baked yet.

    ``tell`` gets a sentence with the cells, the memory and the time that this will take. Raises InputError for an open mesh.
    """
    solid = detail.medium is None
    wanted = edge or (SOLID_PIXELS if solid else MEDIUM_PIXELS) * view.pixel
    each, used = SOLID_BYTES if solid else MARCHED_BYTES, wanted
    while True:
        volume = Volume(proxy, view, edge=used, scale=scale, whole_plane=whole_plane, budget=1 << 62)
        plan = planned(volume, detail)
        if plan.cells * each <= BUDGET:
            break
        used *= max(COARSER, (plan.cells * each / BUDGET) ** (1 / 3))
    tell(_sentence(plan, plan.cells * each, used / wanted))
    volume.budget = BUDGET
    return volume


def planned(volume: Volume, detail: Detail) -> ShellPlan:
    """Return the grid that ``detail`` needs on ``volume``."""
    thickness, amplitude = volume.lengths(detail)
    return volume.plan(thickness, amplitude, detail.medium is None)


def _sentence(plan: ShellPlan, byte_count: int, coarser: float) -> str:
    nz, ny, nx = plan.shape
    words = f"{nx} x {ny} x {nz} cells, up to {byte_count / 2**20:.0f} MB, about {max(plan.seconds, 1.0):.0f} s to fill them"
    if coarser > 1.0:
        words += f"; they are {coarser:.2g} times as large as wanted, to stay within {BUDGET / 2**20:.0f} MB"
    return words


def solid_surface(
    detail: Detail, volume: Volume, *, bsdf: dict[str, Any] | None, emitters: dict[str, Any] | None = None
) -> VolumeSurface:
    """Return the surface of the solid ``detail`` on ``volume`` in a Mitsuba scene."""
    texture = volume.texture(detail)
    surface = isosurface(texture.bake(), texture.level, texture.outward_at, budget=BUDGET)
    one_sided = volume.proxy.kind == "plane"
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
    most = max(reflectance.tint)
    tint = tuple(detail.medium.albedo * c / most for c in reflectance.tint)
    if emitters is not None:
        return TracedVolume(grid, medium, volume.view, None, albedo=(tint[0], tint[1], tint[2]), emitters=emitters)
    assert lamp is not None
    beam = Lamp(lamp.direction, lamp.position, lamp.strength * reflectance.diffuse, lamp.at_camera)
    return TracedVolume(
        grid, medium, volume.view, beam, sky=reflectance.ambient, albedo=detail.medium.albedo, tint=reflectance.tint
    )
