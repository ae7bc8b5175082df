"""The record of a photo as a fit compares it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from voldetail.image import Photo
from voldetail.metric import Descriptor
from voldetail.setup.lamp import Lamp
from voldetail.setup.view import Zone

EVEN_ENOUGH = 0.45
"""Unevenness above which a photo is called uneven. Tuned on photographs: gravel has 0.09, rock 0.21 and 0.29, a sandy ground
0.25, a wall of pebbles, ten across, 0.41; stained and shaded ones from 0.44 to 0.73."""


@dataclass(frozen=True)
class Target:
    """What a rendering is compared with.

    white: the luminance at which the photo burns out; renderings are clipped there, as the camera did.
    pixels (H, W, 3) and luminance (H, W): the zone, linear, at working resolution. mask (H, W). shape: rows and columns
    of the whole photo; zone in its pixels. photo_halves: distance between the two halves of the zone. unevenness: of the photo
    (u of fit.evenness), before anything was evened; None where it means nothing.
    """

    photo: Photo
    pixels: NDArray[np.float32]
    luminance: NDArray[np.float32]
    mask: NDArray[np.bool_]
    shape: tuple[int, int]
    zone: Zone
    lamp: Lamp
    tint: tuple[float, float, float]
    descriptor: Descriptor
    photo_halves: float | None
    white: float
    unevenness: float | None = None
