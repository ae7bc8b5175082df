"""What every writer is told besides the detail and the shape."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from voldetail.apply.volumes import quiet


@dataclass(frozen=True)
class ExportOptions:
    """cells: to the 2 scene units that a shape is long, 16 to 1024; scale: how many times larger the relief is; rotation: the
    shape's turns about x, y, z in degrees; tell: gets a sentence with what a volume takes before it is made."""

    cells: int = 128
    scale: float = 1.0
    rotation: tuple[float, float, float] = (0.0, 0.0, 0.0)
    tell: Callable[[str], None] = quiet
