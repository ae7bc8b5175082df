"""The wood and ring models of GKHF14 section 6: woodlines, woodstreaks, and rings.

The paper gives woodlines two parameters, woodstreaks one, rings up to seven (lines of variable width, turbulent). What they
are is chosen here; the grain runs along x.
"""

from __future__ import annotations

from typing import Any

from voldetail.texture.structures.arrays import clip, functions
from voldetail.texture.structures.grids import edge
from voldetail.texture.structures.model import StructureModel, StructureParameter, Values
from voldetail.texture.structures.noise import cell_words, fractal

P = StructureParameter

LATE_WOOD = 0.2
"""Share of a year in which wood turns dark again."""

LINE_STRETCH, STREAK_STRETCH = 6.0, 18.0
BEND_DETAIL = 0.25
"""The finest bends of rings, a share of the coarsest: with finer ones rings fall to crumbs."""

LINE_FIBRE = 0.12
"""Share of the structure that fine fibres between the lines take."""


def _woodlines(x: Any, y: Any, values: Values, seed: int) -> Any:
    """Year lines: bright from early wood on, dark within the last fifth, bent by noise four lines wide."""
    f = functions(x)
    spacing = values["spacing"]
    u = y / spacing + values["waviness"] * fractal(x, y, 4.0 * spacing, seed, LINE_STRETCH)
    t = u - f.floor(u)
    late = max(LATE_WOOD, 1.5 / spacing)
    line = f.minimum((1.0 - t) / (1.0 - late), t / late)
    fibre = fractal(x, y, max(2.0, spacing / 6.0), seed + 1, STREAK_STRETCH)
    return clip((1.0 - LINE_FIBRE) * line + LINE_FIBRE * (0.5 + 0.5 * fibre), 0.0, 1.0)


def _woodstreaks(x: Any, y: Any, values: Values, seed: int) -> Any:
    """Octaves of noise drawn out along the grain."""
    return 0.5 + 0.5 * fractal(x, y, values["size"], seed, STREAK_STRETCH)


def _rings(x: Any, y: Any, values: Values, seed: int) -> Any:
    """Bands of u = distance from the heart / period + turbulence; each band has its own width."""
    f = functions(x)
    period = values["period"]
    across = y + values["distance"]
    u = f.sqrt(x * x + across * across) / period
    size = values["turbulence_size"]
    u = u + values["turbulence"] * fractal(x, y, size, seed, finest=BEND_DETAIL * size)
    number = f.floor(u)
    off = 2.0 * (u - number) - 1.0
    tone = cell_words(number, 0.0 * number, seed + 1)[0]
    width = values["width"] * (1.0 + values["spread"] * (2.0 * tone - 1.0))
    width = f.minimum(width, 0.9)
    # Rims end where the next band begins, however soft.
    softness = values["softness"] * f.minimum(width, 1.0 - width) * period
    return edge(0.5 * period * (width - f.maximum(off, -off)), softness)


WOOD_LINES = StructureModel(
    "woodlines", "wood",
    (
        P("spacing", 4.0, 48.0, 14.0, "log", 11, "Texels from one year's line to the next."),
        P("waviness", 0.0, 2.0, 0.5, "linear", 11, "How many lines' spacing the lines are bent by."),
    ),
    "Year lines along x, dark on one side.", _woodlines,
)  # fmt: skip

WOOD_STREAKS = StructureModel(
    "woodstreaks", "wood",
    (P("size", 2.0, 24.0, 8.0, "log", 11, "Texels across a streak of the coarsest octave."),),
    "Streaks along x, of many sizes.", _woodstreaks,
)  # fmt: skip

RINGS = StructureModel(
    "rings", "rings",
    (
        P("period", 5.0, 64.0, 20.0, "log", 21, "Texels from one ring to the next."),
        P("width", 0.1, 0.85, 0.5, "linear", 11, "Share of the period that is bright."),
        P("spread", 0.0, 0.9, 0.3, "linear", 6, "How much rings differ in width, each its own way."),
        P("softness", 0.0, 1.0, 0.5, "linear", 6, "How far rims fade; 1: to the middle of the narrower band."),
        P("turbulence", 0.0, 2.0, 0.5, "linear", 11, "How many periods the rings are bent by."),
        P("turbulence_size", 24.0, 128.0, 64.0, "log", 11, "Texels a cell of the coarsest bend."),
        P("distance", 0.0, 600.0, 300.0, "linear", 11, "Texels from the plane's origin down to the rings' heart."),
    ),
    "Turbulent rings of varied width.", _rings,
)  # fmt: skip
