"""A volumetric detail about a proxy, as the fit sees it: baked to a grid and marched.

The proxy's density is shifted by the relief (field.hypertexture). A solid detail is opaque within about a cell and shaded
on its gradient; a medium scatters (field.medium). The plane that fills a photo becomes a slab of solid matter, or a sheet:
matter on both sides of the plane z = 0, between which the background may show.
"""

from __future__ import annotations

import math
from dataclasses import replace
from functools import lru_cache

from voldetail.detail import Detail
from voldetail.field.hypertexture import Hypertexture
from voldetail.field.larger_cells import affordable_edge
from voldetail.field.medium import Medium
from voldetail.field.shell import Shell, make_shell
from voldetail.field.shell_grid import ShellPlan
from voldetail.field.shell_plan import LEAST_CELLS, plan_shell
from voldetail.geometry.primitives.primitive import primitive_of
from voldetail.render.marched import MarchedVolume
from voldetail.setup.proxy import ProxySetup
from voldetail.setup.view import View

SOLID_CELLS = 3.0
"""Thickness of solid matter's shell in cells: thinner, the grid shows through; thicker, small relief is rounded off."""

SOLID_DEPTH = 1.5
"""Optical depth of a cell of solid matter: a surface within two cells, whose densities a pixel's ray still tells apart."""

MARGIN = 16
"""Cells beyond the window that a view keeps of a volume, which cast shadows into it; as for a displaced plane."""

SHEET = 1e-3
"""Thickness in scene units of a sheet's own body: as good as none."""

RAMP_CELLS, CELL_DEPTH = 2.0, 1.5
"""Cells that a medium's edge takes at least, and optical depth of one cell at most; else the cells are seen, as steps."""

SOLID_PIXELS, MEDIUM_PIXELS = 1.0, 2.0
"""Edge of a cell in pixels: a surface's outlines are as sharp as the pixels, a medium's density is soft."""

FIT_SECONDS = 0.15
"""Estimated time that baking a detail may take in a fit; larger scenes get coarser cells."""

FIT_STEP = 1.1
"""Factor by which cells of a fit become larger at a time."""

SOLID_RISE, MEDIUM_RISE = 0.04, 0.1
"""Amplitude for that estimate, which is not to change with the detail, as a share of the window's longest side."""

SOFT = 1.5
"""Thickness of a medium's shell for it, in amplitudes."""

MESH_STEP = 1.25
"""A mesh's distances are computed for a shell up to this factor thicker and higher than needed, and kept for as long as
they serve."""


class Volume(MarchedVolume):
    """``proxy`` under a volumetric detail, seen through ``view``; `update` bakes, `march` looks.

    edge: of a cell in scene units. scale: how many times larger the detail is. whole_plane: the proxy is the plane that
    fills the view. tiles: only the surface is wanted, which a grid too large for ``budget`` bytes gives tile by tile. Raises
    InputError for an open mesh, OverBudgetError for what takes more.
    """

    def __init__(
        self,
        proxy: ProxySetup,
        view: View,
        *,
        edge: float | None = None,
        scale: float = 1.0,
        whole_plane: bool = False,
        budget: int | None = None,
        tiles: bool = False,
    ) -> None:
        super().__init__(view)
        self.proxy, self.edge, self.scale, self.whole_plane = proxy, edge or view.pixel, scale, whole_plane
        self.budget, self.tiles = budget, tiles
        self._kept: Shell | None = None

    def update(self, detail: Detail) -> None:
        """Bake ``detail`` and make it ready to be looked at."""
        self.one_sided_sky = primitive_of(self.proxy).slab and detail.medium is None
        self.fill(self.texture(detail).bake(), medium_of(detail, self.edge, self.scale))

    def texture(self, detail: Detail) -> Hypertexture:
        """Return the density of ``detail``, with the plan of its grid."""
        exponent = 1.0 if detail.medium is None else detail.medium.exponent
        return Hypertexture(self._shell(*self.lengths(detail), detail.medium is None), detail, exponent, self.scale)

    def lengths(self, detail: Detail) -> tuple[float, float]:
        """Return the thickness of the shell and the amplitude of ``detail`` here, in scene units."""
        medium, amplitude = detail.medium, detail.relief.amplitude * self.scale
        if medium is None:
            return SOLID_CELLS * self.edge, amplitude
        # A shell that is thinner than the cells can show is as thin as they can.
        return max(medium.thickness * self.scale, thinnest_edge(self.edge, medium.exponent)), amplitude

    def _shell(self, thickness: float, amplitude: float, solid: bool) -> Shell:
        wanted, kept = (thickness, amplitude), self._kept
        if kept is not None:
            planned = kept.plan
            if thickness <= planned.thickness and thickness / 2 + amplitude <= planned.thickness / 2 + planned.amplitude:
                # The distances serve; how thick the shell about them is, and how high relief may be, is free.
                return replace(kept, plan=replace(planned, thickness=thickness, amplitude=amplitude))
            thickness, amplitude = (
                MESH_STEP * max(v, w) for v, w in ((thickness, planned.thickness), (amplitude, planned.amplitude))
            )
        shell = make_shell(self.plan(thickness, amplitude, solid))
        if not primitive_of(self.proxy).exact:
            self._kept = shell
            return replace(shell, plan=replace(shell.plan, thickness=wanted[0], amplitude=wanted[1]))
        return shell

    def plan(self, thickness: float, amplitude: float, solid: bool) -> ShellPlan:
        """Return the grid for a shell of ``thickness`` with room for ``amplitude``, and what it takes."""
        margin = MARGIN * self.edge if solid else thickness / 2 + amplitude + self.edge
        plan = plan_shell(self._placed(margin, solid), self.edge, thickness, amplitude, self.budget, self.tiles, solid=solid)
        return plan if self.view.perspective else windowed(plan, self.view, margin)

    def _placed(self, margin: float, solid: bool) -> ProxySetup:
        """Return the proxy; the plane that fills the view as large as that and ``margin``, as a sheet where not solid."""
        if not self.whole_plane:
            if solid or not primitive_of(self.proxy).slab:
                return self.proxy
            return self.proxy.model_copy(update={"kind": "box", "size": (*self.proxy.extent[:2], SHEET)})
        view, (x, y, _) = self.view, self.proxy.position
        furthest = max(abs(view.left - x), abs(view.right - x)), max(abs(view.bottom - y), abs(view.top - y))
        reach = [2.0 * (far + margin) for far in furthest]
        if solid:
            return self.proxy.model_copy(update={"size": (reach[0], reach[1], 0.0)})
        return self.proxy.model_copy(update={"kind": "box", "size": (reach[0] + 2 * margin, reach[1] + 2 * margin, SHEET)})


@lru_cache(maxsize=8)  # asked by both objectives and the space, and a mesh is read for each try
def fitting_edge(proxy: ProxySetup, view: View, *, solid: bool, whole_plane: bool) -> float:
    """Return the edge of cells for a fit: SOLID_PIXELS or MEDIUM_PIXELS, more where baking would take over FIT_SECONDS."""
    edge = (SOLID_PIXELS if solid else MEDIUM_PIXELS) * view.pixel
    amplitude = (SOLID_RISE if solid else MEDIUM_RISE) * max(view.rows, view.columns) * view.pixel

    def share(edge: float) -> float:
        volume = Volume(proxy, view, edge=edge, whole_plane=whole_plane, budget=1 << 62)
        thickness = SOLID_CELLS * edge if solid else SOFT * amplitude
        return volume.plan(thickness, amplitude, solid).seconds / FIT_SECONDS

    return affordable_edge(edge, share, least_step=FIT_STEP, trust=0.0)


def medium_of(detail: Detail, edge: float, scale: float = 1.0) -> Medium:
    """Return what the matter of ``detail`` does to light, on cells of ``edge``; lengths grow with ``scale``.

    No cell is deeper than CELL_DEPTH: what is denser than a grid can show is as dense as it can.
    """
    medium = detail.medium
    if medium is None:
        return Medium(SOLID_DEPTH / edge)
    return Medium(min(medium.extinction / scale, CELL_DEPTH / edge), medium.asymmetry, medium.albedo)


def thinnest_edge(edge: float, exponent: float) -> float:
    """Return the least thickness of a medium's shell that cells of ``edge`` show; the power d_h sharpens its edge."""
    return max(RAMP_CELLS * (1.0 + exponent / 2.0), LEAST_CELLS) * edge


def windowed(plan: ShellPlan, view: View, margin: float) -> ShellPlan:
    """Return ``plan`` without the cells that lie more than ``margin`` beside the window of a parallel ``view``."""
    (x, y, z), (nz, ny, nx) = plan.lower, plan.shape
    starts, counts = [], []
    for low, count, least, most in ((x, nx, view.left, view.right), (y, ny, view.bottom, view.top)):
        start = max(0, math.floor((least - margin - low) / plan.edge))
        stop = min(count, math.ceil((most + margin - low) / plan.edge))
        starts.append(low + min(start, count - 1) * plan.edge)
        counts.append(max(stop - start, 1))
    share = counts[0] * counts[1] / (nx * ny)
    return replace(
        plan,
        lower=(starts[0], starts[1], z),
        shape=(nz, counts[1], counts[0]),
        byte_count=int(plan.byte_count * share),
        seconds=plan.seconds * share,
        blocks=math.ceil(plan.blocks * share),
    )
