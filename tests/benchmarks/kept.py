"""How a picture is kept under results/: as JPEG, no wider than a person needs to judge it."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from voldetail.image import to_srgb

WIDEST = 1000
"""Pixels across, beyond which a sheet is made smaller."""

QUALITY = 72
"""Of JPEG: about a third of a PNG's bytes. Looked at as they are kept, sheets and rows show no block in stones or grass."""


def keep(path: Path, page: Image.Image) -> None:
    """Write a page as JPEG to ``path``, whose suffix is .jpg."""
    if path.suffix != ".jpg":
        raise ValueError(f"{path} is kept as .jpg")
    path.parent.mkdir(parents=True, exist_ok=True)
    shown = page.convert("RGB")
    if shown.width > WIDEST:
        shown = shown.resize((WIDEST, round(shown.height * WIDEST / shown.width)), Image.Resampling.LANCZOS)
    shown.save(path, quality=QUALITY, optimize=True)


def keep_linear(path: Path, picture: NDArray[np.floating]) -> None:
    """Write a linear picture (H, W) or (H, W, 3) as `keep` does."""
    stored = np.round(np.clip(to_srgb(np.asarray(picture, np.float32)), 0, 1) * 255).astype(np.uint8)
    keep(path, Image.fromarray(stored))
