"""The record of how a fitted detail was coloured."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from voldetail.detail import Detail


@dataclass(frozen=True)
class ColourChoice:
    """The colour of a detail: what was chosen, how far each try was from the photo, and the picture (H, W, 3)."""

    detail: Detail
    chosen: str
    distances: dict[str, float]
    picture: NDArray[np.float32]
