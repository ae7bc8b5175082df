"""Sheets to look at: a photograph, and tiles of it laid 2 x 2 and on a plane that goes to the horizon."""

from __future__ import annotations

from pathlib import Path

import matplotlib
import numpy as np
from numpy.typing import NDArray

from tests.benchmarks.stationarize_photos import Photograph
from voldetail.image import resize, to_srgb

matplotlib.use("Agg")
from matplotlib import pyplot as plt

Picture = NDArray[np.float32]

PLANE = (256, 640)  # rows and columns of the view of the plane
HORIZON = 0.12  # of its height: the row, above the picture, where the plane ends
TILES_ACROSS = 3.0  # at the lower edge
SAMPLES = 4  # a pixel, each way


def plane(tile: Picture) -> Picture:
    """The tile repeated on a plane that is seen from above, aslant (H, W, 3), linear."""
    height, width = PLANE
    v = (np.arange(height * SAMPLES) + 0.5) / (height * SAMPLES)
    u = (np.arange(width * SAMPLES) + 0.5) / (width * SAMPLES) - 0.5
    depth = ((1 + HORIZON) / (v + HORIZON))[:, None]
    side = len(tile)
    column = np.floor(u[None, :] * depth * TILES_ACROSS * side).astype(np.int64) % side
    row = np.broadcast_to(np.floor(depth * TILES_ACROSS * side * 0.6).astype(np.int64) % side, column.shape)
    fine = tile[row, column]
    return fine.reshape(height, SAMPLES, width, SAMPLES, 3).mean(axis=(1, 3), dtype=np.float32)


def sheet(path: Path, photograph: Photograph, photo: Picture, tiles: dict[str, Picture], seed: int) -> None:
    """Write one photograph's sheet: above the photo and 2 x 2 tilings, below the planes."""
    names = {"plain": "toroidal PatchMatch", "histogram": "local histograms matched"}
    figure, axes = plt.subplots(2, 3, figsize=(15, 8.2), gridspec_kw={"height_ratios": [1.6, 1]})
    long = 512 / max(photo.shape[:2])
    _show(axes[0, 0], resize(photo, (round(photo.shape[0] * long), round(photo.shape[1] * long))), f"{photograph.name} (photo)")
    axes[1, 0].axis("off")
    words = f"{photograph.credit}\nseed {seed}: of those tried the one that\nmakes plain PatchMatch most stationary"
    if photograph.fails:
        words += f"\n\nA failure is expected here:\n{photograph.fails}."
    axes[1, 0].text(0, 0.95, words, va="top", fontsize=12)
    for i, (way, tile) in enumerate(tiles.items()):
        _show(axes[0, i + 1], np.tile(tile, (2, 2, 1)), f"{names[way]}, 2 x 2")
        _show(axes[1, i + 1], plane(tile), "on a plane")
    figure.tight_layout()
    figure.savefig(path, dpi=80, pil_kwargs={"quality": 72} if path.suffix == ".jpg" else None)
    plt.close(figure)


def _show(axis: plt.Axes, picture: Picture, title: str) -> None:
    axis.imshow(np.clip(to_srgb(picture), 0, 1), interpolation="antialiased")
    axis.set_title(title, fontsize=11)
    axis.axis("off")
