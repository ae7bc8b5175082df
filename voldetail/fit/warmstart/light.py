"""The photo in the light's frame: turned so that its light comes from the right, as the library's reliefs are lit."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import rotate

from voldetail.fit.warmstart.reliefs import SIDE
from voldetail.image import resize
from voldetail.results import Target
from voldetail.setup.lamp import Lamp
from voldetail.setup.view import View

WHOLE = 0.999
"""Share of a pixel that has to be inside the mask after turning: all of it, but for rounding."""


@dataclass(frozen=True, eq=False)
class Turned:
    """A photo's zone as the library compares it: luminance (H, W) linear, mask (H, W) or None for all of it."""

    picture: NDArray[np.float32]
    mask: NDArray[np.bool_] | None

    def mirrored(self) -> Turned:
        """Return it on the other side of the light's direction."""
        return Turned(self.picture[::-1], None if self.mask is None else self.mask[::-1])


def direction_at_zone(lamp: Lamp, view: View) -> tuple[float, float]:
    """Return azimuth and elevation, radians, of the light at the middle of the zone; a near one is taken for distant."""
    x, y, z = lamp.source
    if lamp.near:
        x, y = x - 0.5 * (view.left + view.right), y - 0.5 * (view.bottom + view.top)
    return math.atan2(y, x), math.atan2(z, math.hypot(x, y))


def turned(target: Target, azimuth: float) -> Turned:
    """Return the zone of ``target`` turned clockwise by ``azimuth`` (radians), its longest side SIDE pixels.

    Quarter turns move pixels, the rest is interpolated at full resolution; what a turned zone leaves of its rectangle is masked.
    """
    quarters = round(azimuth / (math.pi / 2))
    rest = math.degrees(azimuth) - 90.0 * quarters
    picture, inside = np.rot90(target.luminance, -quarters), np.rot90(target.mask, -quarters).astype(np.float32)
    factor = SIDE / max(picture.shape)
    if abs(rest) > 0.5:
        picture, inside = (rotate(a, -rest, order=1, reshape=True, cval=0.0) for a in (picture, inside))
    size = (max(1, round(picture.shape[0] * factor)), max(1, round(picture.shape[1] * factor)))
    small = resize(np.ascontiguousarray(picture, np.float32), size)
    mask = resize(np.ascontiguousarray(inside, np.float32), size) > WHOLE
    return Turned(small, None if mask.all() else mask)
