"""The grids of GKHF14 section 6: lines of free spacing (grid), and rounded cells of free shape (cellular grid).

The paper says: variable spacing, edge sizes and edge softness. Lines and gaps are dark, 0; cells are bright, 1; swapping
the colours is the search's work. All edges are at least a texel wide.
"""

from __future__ import annotations

from typing import Any

from voldetail.texture.structures.arrays import functions, ramp
from voldetail.texture.structures.model import StructureModel, StructureParameter, Values
from voldetail.texture.structures.noise import cell_words

P = StructureParameter

WIDEST_SHIFT = 0.45
"""Share of the spacing by which an irregular line is moved, at most: lines keep their order."""


def centred(x: Any, period: float) -> tuple[Any, Any]:
    """Return (number of the cell, texels from its middle) along one axis."""
    number = functions(x).floor(x / period)
    return number, x - (number + 0.5) * period


def edge(distance: Any, softness: float) -> Any:
    """Return 0 to 1 over a ramp of 1 + ``softness`` texels about distance 0, positive inside."""
    width = 1.0 + softness
    return ramp(distance / width + 0.5)


def _lines(x: Any, period: float, width: float, softness: float, irregular: float, seed: int) -> Any:
    """Lines at whole multiples of ``period``, each moved its own way."""
    f = functions(x)
    near = f.floor(x / period + 0.5)
    lines: Any = None
    # A moved line may be nearest from the next place as well.
    for step in (-1.0, 0.0, 1.0) if irregular else (0.0,):
        line = near + step
        shift = (cell_words(line, 0.0 * line, seed)[0] - 0.5) * (2 * WIDEST_SHIFT * irregular * period)
        distance = x - line * period - shift
        distance = f.maximum(distance, -distance)
        lines = distance if lines is None else f.minimum(lines, distance)
    return edge(lines - 0.5 * width, softness)


def _grid(x: Any, y: Any, values: Values, seed: int) -> Any:
    columns = _lines(
        x, values["column_spacing"], values["column_edge"] * values["column_spacing"],
        values["softness"] * values["column_spacing"], values["irregularity"], seed,
    )  # fmt: skip
    rows = _lines(
        y, values["row_spacing"], values["row_edge"] * values["row_spacing"],
        values["softness"] * values["row_spacing"], values["irregularity"], seed + 1,
    )  # fmt: skip
    return columns * rows


def _cellular(x: Any, y: Any, values: Values, seed: int) -> Any:
    """Cells are rectangles with round corners, of a radius of half their shorter side: discs where width is height."""
    f = functions(x)
    height, width = values["spacing"], values["spacing"] * values["aspect"]
    _, dx = centred(x, width)
    _, dy = centred(y, height)
    gap = values["gap"] * height
    half_x, half_y = 0.5 * (width - gap), 0.5 * (height - gap)
    radius = min(half_x, half_y)
    qx, qy = f.maximum(dx, -dx) - (half_x - radius), f.maximum(dy, -dy) - (half_y - radius)
    outside = f.sqrt(f.maximum(qx, 0.0) ** 2 + f.maximum(qy, 0.0) ** 2)
    distance = radius - outside - f.minimum(f.maximum(qx, qy), 0.0)
    softness = values["softness"] * radius
    return edge(distance - 0.5 * softness, softness)


GRID = StructureModel(
    "grid", "grid",
    (
        P("column_spacing", 6.0, 64.0, 24.0, "log", 21, "Texels from one upright line to the next."),
        P("row_spacing", 6.0, 64.0, 24.0, "log", 21, "Texels from one level line to the next."),
        P("column_edge", 0.0, 0.7, 0.15, "linear", 11, "Width of the upright lines, a share of their spacing."),
        P("row_edge", 0.0, 0.7, 0.15, "linear", 11, "Width of the level lines, a share of their spacing."),
        P("softness", 0.0, 0.5, 0.05, "linear", 11, "Width of the lines' blurred rims, a share of the spacing."),
        P("irregularity", 0.0, 1.0, 0.0, "linear", 6, "How far lines are off their places; 1: nearly half the spacing."),
    ),
    "Dark lines, upright and level, on bright ground.", _grid,
)  # fmt: skip

CELLULAR_GRID = StructureModel(
    "cellular grid", "grid",
    (
        P("spacing", 6.0, 64.0, 20.0, "log", 21, "Texels from one row of cells to the next."),
        P("aspect", 1.0, 4.0, 1.0, "log", 21, "How many times longer cells are along x than high."),
        P("gap", 0.02, 0.7, 0.15, "linear", 21, "Width of the gap between cells, a share of their height."),
        P("softness", 0.0, 1.0, 0.1, "linear", 11, "How far cells fade towards their rims; 1: to their middle."),
    ),
    "Bright round-cornered cells in rows and columns.", _cellular,
)  # fmt: skip
