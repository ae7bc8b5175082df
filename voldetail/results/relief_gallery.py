"""The pictures that a page about a photo's own relief shows."""

from __future__ import annotations

from dataclasses import dataclass

from voldetail.types import Picture


@dataclass(frozen=True, eq=False)
class ReliefGallery:
    """Linear pictures (H, W, 3): the photo, the maps under its light, height as grey, normals and albedo as they are looked at,
    captions and pictures under other lights and on shapes; the tile 2 x 2, None where there is none."""

    photo: Picture
    again: Picture
    height: Picture
    normal: Picture
    albedo: Picture
    lights: tuple[tuple[str, Picture], ...]
    shapes: tuple[tuple[str, Picture], ...]
    tile: Picture | None = None
