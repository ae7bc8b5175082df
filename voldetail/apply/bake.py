"""A volumetric detail on a shape as the grid of densities itself, for other programs."""

from __future__ import annotations

import math
from pathlib import Path

from voldetail.apply.onmesh import proxy_of
from voldetail.apply.volumes import Tell, place, quiet
from voldetail.detail import Detail
from voldetail.errors import InputError
from voldetail.geometry.density_grid import DensityGrid
from voldetail.setup.view import whole_view

LEAST_SIDE, MOST_SIDE = 16, 1024


def bake(
    detail: Detail,
    mesh: str | Path = "sphere",
    *,
    cells: int = 128,
    scale: float = 1.0,
    rotation: tuple[float, float, float] = (0.0, 0.0, 0.0),
    tell: Tell = quiet,
) -> DensityGrid:
    """Return the densities of the volume ``detail`` on ``mesh``, ``cells`` to the 2 scene units that a shape is long.

    th(d(P')) of GD10 section 6, 0 to 1; a medium's extinction is its own number times that, a solid's surface lies at 0.5.
    Cells are larger where they would take more than 2 GB, as ``tell`` is told. Raises InputError for a detail that displaces,
    an open mesh, and a number of cells that is not 16 to 1024.
    """
    if detail.mode != "volume":
        raise InputError('The detail displaces a surface and has no density; give one of the mode "volume".')
    if not LEAST_SIDE <= cells <= MOST_SIDE:
        raise InputError(f"The number of cells is {cells}, but has to be {LEAST_SIDE} to {MOST_SIDE}.")
    proxy = proxy_of(mesh, rotation)
    # Seen from so far that nothing of it is beside the window: only what is seen is baked.
    wide = 2.0 + detail.relief.amplitude * scale
    view = whole_view(math.ceil(cells * wide), math.ceil(cells * wide), None, wide)
    volume = place(detail, proxy, view, scale=scale, edge=2.0 / cells, whole_grid=True, tell=tell)
    return volume.texture(detail).bake()
