"""The kinds of proxy: one row each. What a kind looks like is in the class of its name in `geometry/primitives`."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import PurePath
from typing import Literal, get_args

Size = tuple[float, float, float]

ShapeKind = Literal["plane", "sphere", "ellipsoid", "box", "cylinder", "torus", "mesh"]


@dataclass(frozen=True)
class ShapeRow:
    """A kind of proxy, as far as a setup knows it.

    size: width, height and depth that it has where none are given, in scene units. flat: a plane, which has no depth and may fill
    the view. of_file: whether it is read from a mesh file. refused: why a size cannot be used, empty where it can.
    """

    size: Size
    flat: bool = False
    of_file: bool = False
    refused: Callable[[Size], str] = lambda size: ""


def _ring(size: Size) -> str:
    """Why a torus cannot have a size: it is round about z and has a hole."""
    width, height, depth = size
    if abs(width - height) > 1e-9 * width:
        return "a torus is as wide as it is high: give width and height alike"
    return "" if depth < width / 2 else "a torus has a hole: its depth has to be less than half of its width"


SHAPES: dict[ShapeKind, ShapeRow] = {
    "plane": ShapeRow((2.0, 2.0, 0.0), flat=True),
    "sphere": ShapeRow((2.0, 2.0, 2.0)),
    "ellipsoid": ShapeRow((2.0, 1.5, 1.5)),
    "box": ShapeRow((2.0, 2.0, 2.0)),
    "cylinder": ShapeRow((1.5, 2.0, 1.5)),
    "torus": ShapeRow((2.0, 2.0, 0.7), refused=_ring),
    "mesh": ShapeRow((2.0, 2.0, 2.0), of_file=True),
}

SIMPLE_KINDS: tuple[ShapeKind, ...] = tuple(kind for kind in get_args(ShapeKind) if not SHAPES[kind].of_file)
"""Kinds that need no file, in the order in which they are listed for users."""

SHAPE_WORDS = ", ".join(SIMPLE_KINDS)


def simple_kind(word: str) -> ShapeKind | None:
    """Return the kind that ``word`` names, None where it names none or one that is read from a file."""
    return next((kind for kind in SIMPLE_KINDS if kind == word), None)


def named_shape(word: str) -> dict[str, object] | None:
    """Return the kind and the mesh file of the shape that ``word`` names: a kind, or a file with a suffix; None for neither."""
    if simple_kind(word) is not None:
        return {"kind": word, "mesh": None}
    return {"kind": "mesh", "mesh": word} if PurePath(word).suffix else None
