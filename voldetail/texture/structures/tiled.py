"""The tiled models of GKHF14 section 6: brick, a half-shaded turbulent surface, and woodplanks, a floor of boards.

Chosen here, since the paper says no more: joints are dark, each brick or board has a tone of its own, bricks are darker
towards their rims, and the phase shift between rows is on or off.
"""

from __future__ import annotations

from typing import Any

from voldetail.texture.structures.arrays import clip, functions, ramp
from voldetail.texture.structures.grids import centred, edge
from voldetail.texture.structures.model import StructureModel, StructureParameter, Values
from voldetail.texture.structures.noise import cell_words, fractal

P = StructureParameter

# Structure of a brick's face, of mortar, and of a board: means and the shares that tone, noise and shade take.
BRICK_FACE, BRICK_TONE, BRICK_NOISE, BRICK_SHADE = 0.78, 0.10, 0.12, 0.25
MORTAR, MORTAR_NOISE = 0.12, 0.10
BOARD_FACE, BOARD_TONE, BOARD_GRAIN, JOINT = 0.58, 0.18, 0.24, 0.04
JOINT_WIDTH = 1.5  # texels
GRAIN_STRETCH = 14.0
GRAIN_CELLS = 7.0
"""Cells of the grain's noise across a board."""

FAR_APART = 4096.0
"""Texels by which boards' grains are moved apart, at most."""


def _rows(x: Any, y: Any, length: float, height: float, seed: int, phase: int) -> tuple[Any, Any, Any, Any]:
    """Return (row, number in the row, texels from the rim, tone -1 to 1) of rectangles in rows.

    phase 0: all in line; 1: every second row moved by half a length; 2: every row its own way.
    """
    f = functions(x)
    row, dy = centred(y, height)
    if phase == 1:
        x = x + (row - 2.0 * f.floor(row / 2.0)) * (0.5 * length)
    elif phase == 2:
        x = x + cell_words(row, 0.0 * row, seed + 1)[0] * length
    number, dx = centred(x, length)
    rim = f.minimum(0.5 * length - f.maximum(dx, -dx), 0.5 * height - f.maximum(dy, -dy))
    return row, number, rim, 2.0 * cell_words(number, row, seed)[0] - 1.0


def _brick(x: Any, y: Any, values: Values, seed: int) -> Any:
    height, length = values["height"], values["length"]
    _, _, rim, tone = _rows(x, y, length, height, seed, int(values["phase"]))
    mortar = values["mortar"] * min(height, length)
    noise = fractal(x, y, 12.0, seed + 2)
    shade = BRICK_SHADE * (ramp((rim - 0.5 * mortar) / (0.3 * min(height, length))) - 1.0)
    face = BRICK_FACE + BRICK_TONE * tone + BRICK_NOISE * noise + shade
    return clip(_between(MORTAR + MORTAR_NOISE * noise, face, edge(rim - 0.5 * mortar, 1.0)), 0.0, 1.0)


def _planks(x: Any, y: Any, values: Values, seed: int) -> Any:
    width = values["width"]
    row, number, rim, tone = _rows(x, y, values["length"], width, seed, 1 + int(values["phase"]))
    away = cell_words(number, row, seed + 3)
    # Whole texels: a float of 4096 and more would else lose what it has after the point.
    f = functions(x)
    gx, gy = x + f.floor(away[0] * FAR_APART), y + f.floor(away[1] * FAR_APART)
    grain = fractal(gx, gy, max(2.0, width / GRAIN_CELLS), seed + 2, GRAIN_STRETCH)
    face = BOARD_FACE + BOARD_TONE * tone + BOARD_GRAIN * grain
    return clip(_between(JOINT, face, edge(rim - 0.5 * JOINT_WIDTH, 0.0)), 0.0, 1.0)


def _between(a: Any, b: Any, share: Any) -> Any:
    return a + (b - a) * share


BRICK = StructureModel(
    "brick", "tiled",
    (
        P("length", 12.0, 96.0, 48.0, "log", 101, "Texels from one brick to the next in a row."),
        P("height", 6.0, 64.0, 20.0, "log", 101, "Texels from one row to the next."),
        P("mortar", 0.04, 0.4, 0.12, "linear", 11, "Width of the mortar, a share of the shorter side."),
        P("phase", 0, 1, 1, "integer", 2, "1 moves every second row by half a brick; 0 leaves rows in line."),
    ),
    "Bright bricks, rough and darker towards their rims, in dark mortar.", _brick,
)  # fmt: skip

WOOD_PLANKS = StructureModel(
    "woodplanks", "tiled",
    (
        P("length", 32.0, 256.0, 128.0, "log", 101, "Texels from one board to the next in a row."),
        P("width", 8.0, 64.0, 24.0, "log", 101, "Texels from one row of boards to the next."),
        P("phase", 0, 1, 1, "integer", 2, "0 moves every second row by half a board, 1 every row its own way."),
    ),
    "Boards with fine grain along x, each of its own tone.", _planks,
)  # fmt: skip
