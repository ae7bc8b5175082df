"""How large a grid about an object is, and what it costs, stated before anything is computed."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from voldetail.errors import InputError
from voldetail.field.shell_blocks import SIDE, block_counts, near_blocks
from voldetail.geometry import isosurface
from voldetail.geometry.closed_mesh import closed_mesh
from voldetail.geometry.meshes import Mesh
from voldetail.geometry.proxy import rotation_matrix
from voldetail.geometry.topology import crosses
from voldetail.setup.setup import ProxySetup

DEFAULT_BUDGET = 1 << 30
"""Bytes: a cube of 630 cells a side for the simple shapes, of 430 for meshes, beside the rest of the program."""

LEAST_CELLS = 2
"""Cells across the shell below which it would be lost between two middles."""

SLAB_CELLS = 3
"""Cells of full density below a plane's shell."""

BYTES_A_CELL = {"simple": 4.0, "mesh": 13.0}
"""Kept and passing: a float of density; for a mesh also one of distance, the winding numbers and their sum."""

BYTES_A_FACET = 200.0
"""For each face of a mesh, and each square of an edge's side of its surface: the triangles it is cut into, and their tree."""

BYTES_AT_LEAST = 2.0e8
"""For what one tile needs while it is computed, and the kernels."""

SECONDS_A_CELL = {"simple": 1.5e-8, "mesh": 6e-8}
SECONDS_A_BAND_CELL = {"simple": 5e-7, "mesh": 5e-6}
"""On two cores, with noise of two octaves; measured. Of the order of, and no promise."""

VERTICES_A_SQUARE = 3.0
"""Vertices of a relief for each square of an edge's side of the bare surface. Without relief there are 1.5; on a sphere of 256
cells, with noise of scale 4 and amplitudes of 0.1 and 0.2, 1.8 and 2.6; of scale 16, as steep as few are, 3.6 and 7."""

BYTES_A_TILED_VERTEX = 200.0
"""At the peak, from 0.3 to 2.3 million vertices; BYTES_AT_LEAST holds what one block needs."""

BYTES_A_BLOCK = 100.0
"""Of all the grid's, while those are found that the surface can reach."""

SECONDS_A_BLOCK = {"simple": 0.03, "mesh": 0.1}
SECONDS_A_TILED_VERTEX = 2e-6
"""As above."""


class OverBudgetError(InputError):
    """A grid takes more memory than it may."""


@dataclass(frozen=True, eq=False)
class ShellPlan:
    """The grid of a shell, and what it will take.

    edge, thickness, amplitude in scene units; shape (nz, ny, nx) and lower as those of a DensityGrid; depth: how far a
    plane's slab reaches down. byte_count: memory at the most. seconds: about how long density and noise take. mesh: the
    checked mesh in its own frame, None for the simple shapes. blocks: how many blocks of SIDE cells a side the surface can
    reach, where the grid as a whole is too large (then bytes and seconds are those of `tiled_isosurface`); 0 for a dense one.
    """

    proxy: ProxySetup
    edge: float
    thickness: float
    amplitude: float
    shape: tuple[int, int, int]
    lower: tuple[float, float, float]
    depth: float
    byte_count: int
    seconds: float
    mesh: Mesh | None = None
    blocks: int = 0

    @property
    def cells(self) -> int:
        """How many cubes the grid has."""
        return math.prod(self.shape)

    @property
    def sentence(self) -> str:
        """The plan in words, for the user to read before it is carried out."""
        nz, ny, nx = self.shape
        tiles = f" in at most {self.blocks} of {math.prod(block_counts(self.shape))} blocks," if self.blocks else ""
        return (
            f"{nx} x {ny} x {nz} cells of {self.edge:.3g} scene units,{tiles} {self.byte_count / 2**20:.0f} MB,"
            f" about {max(self.seconds, 1.0):.0f} s"
        )

    def check_dense(self) -> None:
        """Refuse to fill the whole grid where it was planned for tiles."""
        if self.blocks:
            raise InputError(
                f"A grid of {self.sentence.split(',')[0]} was planned for its surface by tiles alone: plan it without tiles to"
                " fill it."
            )


def plan_shell(
    proxy: ProxySetup, edge: float, thickness: float, amplitude: float = 0.0, budget: int | None = None, tiles: bool = False,
    *, solid: bool = True,
) -> ShellPlan:
    """Return the grid of cubes of ``edge`` about ``proxy`` with a shell of ``thickness`` and room to shift by ``amplitude``.

    A good ``edge`` is a pixel of the picture; a good ``thickness`` for solid matter three edges. Raises InputError for a
    length that is not over 0, a shell thinner than LEAST_CELLS edges or, if the object shall be ``solid`` inside, thicker
    than it, an open mesh, and a grid that takes more than ``budget`` bytes (DEFAULT_BUDGET).

    With ``tiles``, for who wants the surface and not the grid, ``budget`` (that of `isosurface`) is for both together: where
    they take more the plan is one for `tiled_isosurface`, and is refused only where that takes more too.
    """
    if budget is None:
        budget = isosurface.DEFAULT_BUDGET if tiles else DEFAULT_BUDGET
    for name, value in (("cell's edge", edge), ("shell's thickness", thickness)):
        if not (math.isfinite(value) and value > 0):
            raise InputError(f"The {name} is {value:g}; it has to be a length over 0 scene units.")
    if not (math.isfinite(amplitude) and amplitude >= 0):
        raise InputError(f"The amplitude is {amplitude:g}; it has to be 0 scene units or more.")
    if thickness < LEAST_CELLS * edge * (1 - 1e-9):
        raise InputError(
            f"The shell is {thickness:g} scene units thick, less than {LEAST_CELLS} cells of {edge:g}: it would fall between"
            f" them; use a thickness of at least {LEAST_CELLS * edge:.3g} or an edge of at most {thickness / LEAST_CELLS:.3g}."
        )
    mesh = closed_mesh(proxy) if proxy.kind == "mesh" else None
    if solid:
        _check_inside(proxy, thickness)
    plan = _layout(proxy, mesh, edge, thickness, amplitude)
    if tiles:
        marched = isosurface.BYTES_A_CELL * plan.cells + isosurface.BYTES_A_VERTEX * _vertices(plan)
        if plan.byte_count + marched <= budget:
            return plan
        plan = _layout(proxy, mesh, edge, thickness, amplitude, tiles)
    if plan.byte_count > budget:
        fitting = _fitting_edge(plan, budget, tiles)
        advice = f"use an edge of at least {fitting:.3g}"
        if fitting * LEAST_CELLS > thickness:
            advice += f" (and a thickness of at least {fitting * LEAST_CELLS:.3g})"
        if math.isinf(fitting):
            advice = f"the program alone takes {BYTES_AT_LEAST / 2**20:.0f} MB, so allow more"
        raise OverBudgetError(
            f"A grid of {plan.sentence.split(',')[0]} needs {plan.byte_count / 2**20:.0f} MB{' by tiles' if tiles else ''}, more"
            f" than the {budget / 2**20:.0f} MB allowed: {advice}, or allow {math.ceil(plan.byte_count / 2**20)} MB."
        )
    if not tiles:
        return plan
    blocks = len(near_blocks(plan))
    return replace(plan, blocks=blocks, seconds=plan.seconds + blocks * SECONDS_A_BLOCK["mesh" if mesh else "simple"])


def _check_inside(proxy: ProxySetup, thickness: float) -> None:
    """Refuse a shell that leaves nothing solid in a simple shape; for a mesh this is known once its distances are."""
    if proxy.kind not in ("plane", "mesh") and thickness >= min(proxy.extent):
        raise InputError(
            f"The shell is {thickness:g} scene units thick, as much as the {proxy.kind} itself at its thinnest"
            f" ({min(proxy.extent):g}), so nothing of it would be solid: use a smaller thickness."
        )


def _layout(
    proxy: ProxySetup, mesh: Mesh | None, edge: float, thickness: float, amplitude: float, tiles: bool = False
) -> ShellPlan:
    above = amplitude + thickness / 2 + edge
    depth = max(proxy.extent[2], thickness / 2 + SLAB_CELLS * edge)
    if mesh is not None:
        corners = mesh.vertices
    else:
        half = np.asarray(proxy.extent) / 2
        # A plane's box holds its slab, and the room above it; the others leave room on all sides.
        low, high = (np.array([*-half[:2], -depth]), np.array([*half[:2], above])) if proxy.kind == "plane" else (-half, half)
        corners = np.array([[(low, high)[bit >> axis & 1][axis] for axis in range(3)] for bit in range(8)])
    placed = corners @ rotation_matrix(proxy.rotation).T + np.asarray(proxy.position)
    margin = 0.0 if proxy.kind == "plane" else above
    low, high = placed.min(axis=0) - margin, placed.max(axis=0) + margin
    counts = np.maximum(np.ceil((high - low) / edge * (1 - 1e-6)), 1.0)
    # What rounding up added is shared by both sides: all middles of a plane that is not turned are within its slab.
    lower = (low + high - counts * edge) / 2
    counts = np.minimum(counts, 1e9)  # an edge of 1e-300 is refused for its memory, not for an overflow
    cells = float(counts.prod())
    kind = "simple" if mesh is None else "mesh"
    area = _area(proxy, mesh)
    band = min(area * (thickness + amplitude) / edge / edge / edge, cells)
    nx, ny, nz = (int(count) for count in counts)
    byte_count, seconds = cells * BYTES_A_CELL[kind], cells * SECONDS_A_CELL[kind]
    plan = ShellPlan(
        proxy, edge, thickness, amplitude, (nz, ny, nx), (float(lower[0]), float(lower[1]), float(lower[2])), depth, 0, 0.0, mesh
    )
    if tiles:
        byte_count = _vertices(plan) * BYTES_A_TILED_VERTEX + float((counts / SIDE + 1).prod()) * BYTES_A_BLOCK
        seconds = _vertices(plan) * SECONDS_A_TILED_VERTEX
    if mesh is not None:
        byte_count += BYTES_A_FACET * (len(mesh.faces) + area / edge / edge)
    return replace(
        plan, byte_count=int(min(byte_count + BYTES_AT_LEAST, 1e18)), seconds=seconds + band * SECONDS_A_BAND_CELL[kind]
    )


def _area(proxy: ProxySetup, mesh: Mesh | None) -> float:
    """Return the area of the proxy's surface in square scene units, or somewhat more."""
    if mesh is not None:
        return 0.5 * float(np.linalg.norm(crosses(mesh.vertices, mesh.faces), axis=1).sum())
    w, h, d = proxy.extent
    if proxy.kind == "plane":
        return w * h
    if proxy.kind == "cylinder":  # its rim at most that of the circle with the mean square radius
        return math.pi * (w * d / 2 + h * math.sqrt((w * w + d * d) / 2))
    if proxy.kind in ("sphere", "ellipsoid"):  # at most that of the sphere with the mean square of the pairs' products
        return math.pi * math.sqrt(((w * h) ** 2 + (h * d) ** 2 + (d * w) ** 2) / 3)
    return 2 * (w * h + h * d + d * w)


def _vertices(plan: ShellPlan) -> float:
    """Return about how many vertices the surface will have, as long as its relief is no steeper than most."""
    area = _area(plan.proxy, plan.mesh)
    if plan.proxy.kind == "plane":  # its bottom and the sides where the box cuts it
        area = 2 * area + 2 * (plan.depth + plan.amplitude) * (plan.proxy.extent[0] + plan.proxy.extent[1])
    return area / plan.edge / plan.edge * VERTICES_A_SQUARE


def _fitting_edge(plan: ShellPlan, budget: int, tiles: bool) -> float:
    """Return the least edge, rounded up to three digits, with which the plan fits the budget; infinity where none does."""
    edge, byte_count = plan.edge, plan.byte_count
    while edge < 1e6:
        # Cells go with the third power; what does not shrink makes this too small rather than too large.
        edge *= max(1.02, (byte_count / max(budget, 1)) ** (1 / 3) * 0.9)
        byte_count = _layout(plan.proxy, plan.mesh, edge, plan.thickness, plan.amplitude, tiles).byte_count
        if byte_count <= budget:
            digits = 10.0 ** (math.floor(math.log10(edge)) - 2)
            return math.ceil(edge / digits) * digits
    return math.inf
