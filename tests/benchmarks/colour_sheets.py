"""Pictures of colour textures: captioned rows, and what only a formula can: more of it, steps to another, solids, edits."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont

from voldetail.apply import painted, render
from voldetail.detail.colour import ColourTexture
from voldetail.image import to_srgb
from voldetail.texture import edit, morph, picture

Picture = NDArray[np.float32]
Captioned = tuple[str, Picture]

GAP, LINE = 6, 18
"""Pixels between tiles, and of a line of caption."""

STEPS = 6
STEP_SIDE = 192


def row(tiles: Sequence[Captioned]) -> Image.Image:
    """Return linear pictures (H, W, 3), of any sizes, beside each other under their captions."""
    height = max(shown.shape[0] for _, shown in tiles)
    page = Image.new("RGB", (sum(shown.shape[1] + GAP for _, shown in tiles) - GAP, height + LINE + GAP), "white")
    pen, font, left = ImageDraw.Draw(page), ImageFont.load_default(12), 0
    for caption, shown in tiles:
        pen.text((left, 1), caption, fill="black", font=font)
        page.paste(Image.fromarray(np.round(np.clip(to_srgb(shown), 0, 1) * 255).astype(np.uint8)), (left, LINE))
        left += shown.shape[1] + GAP
    return page


def stacked(rows: Sequence[Image.Image], columns: int = 1) -> Image.Image:
    """Return rows of pictures as one page, filled column by column."""
    width, height = (max(getattr(r, side) for r in rows) for side in ("width", "height"))
    lines = -(-len(rows) // columns)
    page = Image.new("RGB", (columns * (width + 3 * GAP) - 3 * GAP, lines * height), "white")
    for k, one in enumerate(rows):
        page.paste(one, (k // lines * (width + 3 * GAP), k % lines * height))
    return page


def tiles_of(page: Image.Image, title: str, side: int, size: int, count: int = 3) -> Image.Image:
    """Return the middle `size` x `size` pixels of each of a row's first `count` tiles of `side` pixels, in one line."""
    cut = max((side - size) // 2, 0)
    size = min(size, side)
    line = Image.new("RGB", (count * (size + 2) - 2, size + LINE), "white")
    ImageDraw.Draw(line).text((0, 1), title, fill="black", font=ImageFont.load_default(11))
    for k in range(count):
        left, top = k * (side + GAP) + cut, LINE + cut
        line.paste(page.crop((left, top, left + size, top + size)), (k * (size + 2), LINE))
    return line


def larger_row(photo: Picture, texture: ColourTexture) -> Image.Image:
    """Return a photo beside four times its area of its texture."""
    rows, columns = photo.shape[:2]
    return row([("photograph", photo), ("its texture, four times the area", picture(texture, (2 * columns, 2 * rows)))])


def morph_row(a: ColourTexture, b: ColourTexture) -> Image.Image:
    """Return six steps from one texture to another."""
    tiles = []
    for k in range(STEPS):
        t = k / (STEPS - 1)
        caption = a.name if k == 0 else b.name if k == STEPS - 1 else f"{t:.0%} of the way"
        tiles.append((caption.replace("_", " "), picture(morph(a, b, t), (STEP_SIDE, STEP_SIDE))))
    return row(tiles)


def edit_row(texture: ColourTexture) -> Image.Image:
    """Return a texture as it is, with louder fine bands, louder coarse ones, less contrast and more."""
    made: Mapping[str, ColourTexture] = {
        "as analysed": texture,
        "fine bands twice": edit(texture, {"fine": 2.0}),
        "coarse bands twice": edit(texture, {"coarse": 2.0}),
        "half the contrast": edit(texture, contrast=0.5),
        "half as much contrast again": edit(texture, contrast=1.5),
    }
    return row([(caption, picture(one, (STEP_SIDE, STEP_SIDE))) for caption, one in made.items()])


def solid_row(textures: Sequence[ColourTexture], side: int = 256) -> Image.Image:
    """Return spheres that look carved from solid textures."""
    return row([(f"{texture.name.replace('_', ' ')}, solid", carved_sphere(texture, side)) for texture in textures])


def carved_sphere(texture: ColourTexture, side: int) -> Picture:
    """Return the rendering (side, side, 3), linear, of a sphere carved from the solid texture, a texel to a pixel, on white."""
    return render(painted(texture, side / 2), "sphere", size=(side, side), background=1.0)
