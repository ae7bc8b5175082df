"""How large a grid about an object is, and what it costs, stated before anything is computed."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from voldetail.errors import InputError
from voldetail.field.larger_cells import affordable_edge
from voldetail.field.shell_blocks import near_blocks
from voldetail.field.shell_grid import SIDE, ShellPlan
from voldetail.geometry import isosurface
from voldetail.geometry.meshes import Mesh
from voldetail.geometry.primitives.primitive import primitive_of
from voldetail.geometry.proxy import rotation_matrix
from voldetail.setup.proxy import ProxySetup

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

ADVICE_STEP, ADVICE_TRUST = 1.02, 0.9
"""Steps in which an edge is looked for that fits: what does not shrink with cells makes the third root too small a step, and too
small is wanted, since the least edge is asked for."""

SECONDS_A_BLOCK = {"simple": 0.03, "mesh": 0.1}
SECONDS_A_TILED_VERTEX = 2e-6
"""As above."""


class OverBudgetError(InputError):
    """A grid takes more memory than it may."""


def plan_shell(
    proxy: ProxySetup,
    edge: float,
    thickness: float,
    amplitude: float = 0.0,
    budget: int | None = None,
    tiles: bool = False,
    *,
    solid: bool = True,
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
    mesh = primitive_of(proxy).mesh()
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
    thinnest = primitive_of(proxy).thinnest()
    if thinnest is not None and thickness >= thinnest:
        raise InputError(
            f"The shell is {thickness:g} scene units thick, as much as the {proxy.kind} itself at its thinnest"
            f" ({thinnest:g}), so nothing of it would be solid: use a smaller thickness."
        )


def _layout(
    proxy: ProxySetup, mesh: Mesh | None, edge: float, thickness: float, amplitude: float, tiles: bool = False
) -> ShellPlan:
    above = amplitude + thickness / 2 + edge
    depth = max(proxy.extent[2], thickness / 2 + SLAB_CELLS * edge)
    shape = primitive_of(proxy)
    corners, margin = shape.hull(depth, above)
    placed = corners @ rotation_matrix(proxy.rotation).T + np.asarray(proxy.position)
    low, high = placed.min(axis=0) - margin, placed.max(axis=0) + margin
    counts = np.maximum(np.ceil((high - low) / edge * (1 - 1e-6)), 1.0)
    # What rounding up added is shared by both sides: all middles of a plane that is not turned are within its slab.
    lower = (low + high - counts * edge) / 2
    counts = np.minimum(counts, 1e9)  # an edge of 1e-300 is refused for its memory, not for an overflow
    cells = float(counts.prod())
    kind = "simple" if mesh is None else "mesh"
    area = shape.area()
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


def _vertices(plan: ShellPlan) -> float:
    """Return about how many vertices the surface will have, as long as its relief is no steeper than most."""
    shape = primitive_of(plan.proxy)
    area = shape.area()
    if shape.slab:  # its bottom and the sides where the box cuts it
        area = 2 * area + 2 * (plan.depth + plan.amplitude) * (plan.proxy.extent[0] + plan.proxy.extent[1])
    return area / plan.edge / plan.edge * VERTICES_A_SQUARE


def _fitting_edge(plan: ShellPlan, budget: int, tiles: bool) -> float:
    """Return the least edge, rounded up to three digits, with which the plan fits the budget; infinity where none does."""

    def share(edge: float) -> float:
        return _layout(plan.proxy, plan.mesh, edge, plan.thickness, plan.amplitude, tiles).byte_count / max(budget, 1)

    edge = affordable_edge(plan.edge, share, least_step=ADVICE_STEP, trust=ADVICE_TRUST)
    if math.isinf(edge):
        return edge
    digits = 10.0 ** (math.floor(math.log10(edge)) - 2)
    return math.ceil(edge / digits) * digits
