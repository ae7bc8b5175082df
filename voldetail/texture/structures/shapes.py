"""The models by which GKHF14 section 6 tests far-fetched matches: star and symbol.

The paper's symbols are a font's; these are ten shapes of our own, given by distances to their outlines in a square from -1
to 1, negative inside.
"""

from __future__ import annotations

from collections.abc import Callable
from math import cos, pi, sin
from typing import Any

from voldetail.texture.structures.arrays import functions
from voldetail.texture.structures.grids import centred, edge
from voldetail.texture.structures.model import StructureModel, StructureParameter, Values
from voldetail.texture.structures.noise import TURN, cell_words

P = StructureParameter

STAR_RADIUS = 0.48
"""Of a star's tips, a share of the spacing."""

STAR_WAIST = 0.42
"""Distance of the notches from the middle, a share of the tips'."""


def _star(x: Any, y: Any, values: Values, seed: int) -> Any:
    """Stars in rows and columns, one tip up; each half of a tip is what lies on one side of a line."""
    f = functions(x)
    _, dx = centred(x, values["size"])
    _, dy = centred(y, values["size"])
    step = 2 * pi / values["tips"]
    angle = f.atan2(dx, dy)
    angle = angle - step * f.floor(angle / step + 0.5)
    angle = f.maximum(angle, -angle)
    r = f.sqrt(dx * dx + dy * dy)
    tip = STAR_RADIUS * values["size"]
    notch_x, notch_y = tip * STAR_WAIST * cos(step / 2), tip * STAR_WAIST * sin(step / 2)
    length = ((tip - notch_x) ** 2 + notch_y**2) ** 0.5
    distance = (r * f.cos(angle) - tip) * (notch_y / length) + r * f.sin(angle) * ((tip - notch_x) / length)
    return edge(-distance, 0.0)


def _magnitude(x: Any, y: Any) -> Any:
    return functions(x).sqrt(x * x + y * y)


def _absolute(x: Any) -> Any:
    return functions(x).maximum(x, -x)


def _box(x: Any, y: Any, half_x: float, half_y: float) -> Any:
    return functions(x).maximum(_absolute(x) - half_x, _absolute(y) - half_y)


def _triangle(x: Any, y: Any) -> Any:
    return functions(x).maximum(-0.5 - y, 0.5 * y + 0.8660254 * _absolute(x) - 0.45)


def _heart(x: Any, y: Any) -> Any:
    f, a = functions(x), _absolute(x)
    lobes = _magnitude(a - 0.38, y - 0.25) - 0.537
    return f.minimum(lobes, (a + _absolute(y + 0.13) - 0.76) * 0.7071)


def _crescent(x: Any, y: Any) -> Any:
    return functions(x).maximum(_magnitude(x, y) - 0.9, 0.75 - _magnitude(x - 0.4, y))


def _arrow(x: Any, y: Any) -> Any:
    f = functions(x)
    head = f.maximum(-x, 0.7071 * (x + _absolute(y)) - 0.64)
    return f.minimum(head, _box(x + 0.4, y, 0.5, 0.25))


def _face(x: Any, y: Any) -> Any:
    f = functions(x)
    rim = _absolute(_magnitude(x, y) - 0.84) - 0.1
    eyes = _magnitude(_absolute(x) - 0.32, y - 0.28) - 0.14
    mouth = f.maximum(_absolute(_magnitude(x, y) - 0.5) - 0.09, y + 0.1)
    return f.minimum(f.minimum(rim, eyes), mouth)


OUTLINES: tuple[Callable[[Any, Any], Any], ...] = (
    lambda x, y: _magnitude(x, y) - 0.85,
    lambda x, y: _absolute(_magnitude(x, y) - 0.65) - 0.22,
    lambda x, y: _box(x, y, 0.75, 0.75),
    lambda x, y: (_absolute(x) + _absolute(y) - 0.95) * 0.7071,
    lambda x, y: functions(x).minimum(_box(x, y, 0.9, 0.28), _box(x, y, 0.28, 0.9)),
    _triangle,
    _heart,
    _crescent,
    _arrow,
    _face,
)
"""Disc, ring, square, diamond, cross, triangle, heart, crescent, arrow, face."""

STRAIGHT, STAGGERED, TURNED = 0, 1, 2


def _symbol(x: Any, y: Any, values: Values, seed: int) -> Any:
    f = functions(x)
    spacing = values["spacing"]
    row, dy = centred(y, spacing)
    if values["arrangement"] == STAGGERED:
        x = x + (row - 2.0 * f.floor(row / 2.0)) * (0.5 * spacing)
    column, dx = centred(x, spacing)
    if values["arrangement"] == TURNED:
        angle = cell_words(column, row, seed)[0] * TURN
        c, s = f.cos(angle), f.sin(angle)
        dx, dy = c * dx + s * dy, c * dy - s * dx
    radius = 0.5 * spacing * values["filling"]
    return edge(-radius * OUTLINES[int(values["kind"])](dx / radius, dy / radius), 0.0)


STAR = StructureModel(
    "star", "shapes",
    (
        P("tips", 4, 7, 5, "integer", 4, "Tips of a star."),
        P("size", 10.0, 96.0, 32.0, "log", 11, "Texels from one star to the next."),
    ),
    "Bright stars in rows and columns.", _star,
)  # fmt: skip

SYMBOL = StructureModel(
    "symbol", "shapes",
    (
        P("kind", 0, 9, 0, "integer", 10,
          "0 disc, 1 ring, 2 square, 3 diamond, 4 cross, 5 triangle, 6 heart, 7 crescent, 8 arrow, 9 face."),
        P("spacing", 10.0, 96.0, 32.0, "log", 51, "Texels from one symbol to the next."),
        P("filling", 0.4, 1.0, 0.8, "linear", 11, "Size of a symbol, a share of the spacing."),
        P("arrangement", 0, 2, 0, "integer", 3, "0 rows and columns, 1 every second row moved, 2 each turned its own way."),
    ),
    "Bright symbols of one kind on dark ground.", _symbol,
)  # fmt: skip
