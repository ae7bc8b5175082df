"""`voldetail compare`: how unlike two textures are, part by part."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import numpy as np
import typer
from numpy.typing import NDArray
from rich.table import Table

from voldetail.cli.console import output, result
from voldetail.errors import InputError

if TYPE_CHECKING:
    from voldetail.metric import Descriptor

MOST_PIXELS = 4_000_000
"""Of a picture that is described: the filters hold some 300 bytes a pixel."""


@dataclass(frozen=True)
class _Picture:
    """Luminance (H, W) and which of it counts (H, W) or None for all."""

    name: str
    light: NDArray[np.float32]
    mask: NDArray[np.bool_] | None


def compare(
    first: Annotated[str, typer.Argument(metavar="A", help="The reference: a photo or picture.")],
    second: Annotated[str, typer.Argument(metavar="B", help="What is compared with it.")],
    mask: Annotated[Path | None, typer.Option(help="White is used, of both; then both need the mask's size.")] = None,
    metric: Annotated[str, typer.Option(help="combined, published (GD10's), or one ingredient.")] = "combined",
    resolution: Annotated[
        int | None,
        typer.Option(min=32, max=2000, help="Shrink both so that the longest side has this many pixels."),
    ] = None,
) -> None:
    """Compare the textures of two pictures: the distance M, and what it is made of.

    Pictures need not have the same size, but a texture has to have the same scale in both, in pixels. As a
    yardstick, the left half of A is compared with its right half.
    """
    from voldetail.metric import describe, distance_by_level, metric_named

    metric = metric_named(metric)
    a, b = (_read(name, mask, resolution) for name in (first, second))
    if mask is not None and a.light.shape != b.light.shape:
        raise InputError(f"With --mask, {first} and {second} have to have the same size.")
    reference = describe(a.light, a.mask, metric=metric)
    parts = distance_by_level(reference, describe(b.light, b.mask, like=reference))
    halves = _halves(a, metric)
    record = {
        "a": first, "b": second, "metric": metric, "distance": _total(parts), "parts": parts,
        "halves_of_a": None if halves is None else {"distance": _total(halves), "parts": halves},
    }  # fmt: skip
    result(record)
    _print(record)


def _read(name: str, mask: Path | None, resolution: int | None) -> _Picture:
    from voldetail.image import load_masked, luminance, resize, resize_mask

    photo = load_masked(name, mask)
    used = photo.opaque
    light = luminance(photo.pixels)
    rows, columns = light.shape
    if resolution is not None and resolution < max(rows, columns):
        factor = resolution / max(rows, columns)
        shape = (max(1, round(rows * factor)), max(1, round(columns * factor)))
        light = resize(light, shape)
        used = None if used is None else resize_mask(used, shape)
    if light.size > MOST_PIXELS:
        raise InputError(f"{name} has {columns} x {rows} pixels, too many to compare; give --resolution, e.g. 1000.")
    return _Picture(name, light, used)


def _halves(a: _Picture, metric: str) -> dict[str, float] | None:
    """Distances between the left and the right half of A; None where a half is too small."""
    from voldetail.metric import describe, distance_by_level

    half = a.light.shape[1] // 2
    try:
        left: Descriptor = describe(*_columns(a, slice(None, half)), metric=metric)
        right = describe(*_columns(a, slice(-half, None)), like=left)
    except InputError:
        return None
    return distance_by_level(left, right)


def _columns(a: _Picture, part: slice) -> tuple[NDArray[np.float32], NDArray[np.bool_] | None]:
    light = np.ascontiguousarray(a.light[:, part])
    return light, None if a.mask is None else np.ascontiguousarray(a.mask[:, part])


def _total(parts: dict[str, float]) -> float:
    return float(sum(parts.values()))


def _print(record: dict[str, Any]) -> None:
    halves = record["halves_of_a"]
    table = Table(title=f"{record['a']} against {record['b']}, metric {record['metric']}", title_justify="left")
    table.add_column("part")
    table.add_column("A against B", justify="right")
    table.add_column("A's halves", justify="right")
    for part, value in record["parts"].items():
        table.add_row(part, f"{value:.4g}", "" if halves is None else f"{halves['parts'].get(part, 0.0):.4g}")
    table.add_section()
    table.add_row("M, all together", f"{record['distance']:.4g}", "" if halves is None else f"{halves['distance']:.4g}")
    output().print(table)
