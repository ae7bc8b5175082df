"""The record of the pictures that a report shows."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from voldetail.types import Picture


@dataclass(frozen=True)
class Gallery:
    """Pictures (H, W, 3), linear.

    photo: the zone at working resolution; mask (H, W): its used pixels; overlay: the whole photo with the zone, the
    mask and the proxy drawn over it; fitted: the rendering under the photo's light; lights: captions and renderings
    under four others; grazing: a tilted plane; sphere; mesh with its name.
    """

    photo: Picture
    mask: NDArray[np.bool_]
    overlay: Picture
    fitted: Picture
    lights: tuple[tuple[str, Picture], ...]
    grazing: Picture
    sphere: Picture
    mesh: Picture
    mesh_name: str
