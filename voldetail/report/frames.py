"""Many pictures of one thing: a contact sheet and an animation."""

from __future__ import annotations

import math
from collections.abc import Sequence
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from voldetail.files import write_bytes
from voldetail.image import resize
from voldetail.report.charts import new_figure
from voldetail.report.pictures import encoded

SHEET_PIXELS = 1600  # width of a contact sheet
LARGEST_TILE = 400
CAPTION_PIXELS = 26
DPI = 100


def write_contact_sheet(path: Path, frames: Sequence[tuple[str, NDArray[Any]]], title: str) -> None:
    """Write captioned linear pictures (H, W, 3) of one size, in rows, as the PNG ``path``."""
    count = len(frames)
    columns = min(count, max(2, math.ceil(math.sqrt(count * 4 / 3))))
    rows = math.ceil(count / columns)
    tile = min(LARGEST_TILE, SHEET_PIXELS // columns)
    high = max(1, round(tile * frames[0][1].shape[0] / frames[0][1].shape[1]))
    # Text on a narrow sheet would not fit its heading.
    width = max(columns * tile, 480)
    height = rows * (high + CAPTION_PIXELS) + 60
    figure = new_figure(width / DPI, height / DPI, "#fbfaf8", DPI)
    figure.text(12 / width, 1 - 16 / height, title, fontsize=12, va="top", color="#22262b", parse_math=False)
    for index, (caption, picture) in enumerate(frames):
        row, column = divmod(index, columns)
        left, top = column * tile, 60 + row * (high + CAPTION_PIXELS) - 8
        axes = figure.add_axes(((left + 4) / width, 1 - (top + high - 4) / height, (tile - 8) / width, (high - 8) / height))
        shrunk = resize(picture, (high, tile)) if picture.shape[1] > tile else picture
        axes.imshow(encoded(shrunk), aspect="auto", interpolation="bilinear")
        axes.set_axis_off()
        figure.text(
            (left + 5) / width,
            1 - (top + high) / height,
            caption,
            fontsize=8,
            va="top",
            color="#555b63",
            parse_math=False,
        )
    buffer = BytesIO()
    figure.savefig(buffer, format="png", dpi=DPI)
    write_bytes(path, buffer.getvalue())


def write_animation(path: Path, frames: Sequence[NDArray[np.uint8]], seconds: float) -> None:
    """Write 8-bit sRGB pictures (H, W, 3) as an endless animation of ``seconds``: `.gif`, or `.png`."""
    pictures = [Image.fromarray(frame) for frame in frames]
    if path.suffix.lower() == ".gif":
        # One palette for all frames: with one each, flat parts flicker.
        palette = _palette(frames)
        pictures = [p.quantize(palette=palette, dither=Image.Dither.FLOYDSTEINBERG) for p in pictures]
    buffer = BytesIO()
    pictures[0].save(
        buffer,
        format="GIF" if path.suffix.lower() == ".gif" else "PNG",
        save_all=True,
        append_images=pictures[1:],
        duration=max(20, round(1000 * seconds / len(pictures))),
        loop=0,
    )
    write_bytes(path, buffer.getvalue())


def _palette(frames: Sequence[NDArray[np.uint8]]) -> Image.Image:
    """Return a picture whose 256 colours suit all frames, from some pixels of each."""
    step = max(1, math.isqrt(sum(f.shape[0] * f.shape[1] for f in frames) // 200_000))
    pixels = np.concatenate([f[::step, ::step].reshape(-1, 3) for f in frames])
    return Image.fromarray(np.ascontiguousarray(pixels[None])).quantize(256, method=Image.Quantize.MEDIANCUT)


def thumbnail(picture: NDArray[Any]) -> NDArray[np.float32]:
    """A linear picture as large as the contact sheet needs it."""
    width = min(LARGEST_TILE, picture.shape[1])
    return resize(picture, (max(1, round(picture.shape[0] * width / picture.shape[1])), width))
