"""Where the light comes from at each pixel of a photo, and how bright it makes a bare plane there."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from voldetail.setup.lamp import Lamp
from voldetail.setup.view import View


@dataclass(frozen=True, eq=False)
class LightMap:
    """direction (H, W, 3): unit vectors to the light, x right, y up, z to the viewer. falloff (H, W): E n . l over pi."""

    direction: NDArray[np.float32]
    falloff: NDArray[np.float32]

    @property
    def varies(self) -> bool:
        """Whether directions differ over the photo: a near light."""
        return bool(np.ptp(self.direction[::8, ::8].reshape(-1, 3), axis=0).max() > 0.02)


def light_map(lamp: Lamp, view: View) -> LightMap:
    """Return the light of ``lamp`` on the plane z = 0 of a photo seen through ``view``."""
    shape = view.rows, view.columns
    x, y = (v.reshape(shape) for v in view.coordinates(1))
    if not lamp.near:
        direction = np.broadcast_to(np.asarray(lamp.source, np.float32), (*shape, 3))
    else:
        px, py, pz = lamp.source
        offset = np.stack([px - x, py - y, np.full(shape, pz, np.float32)], axis=-1)
        direction = offset / np.linalg.norm(offset, axis=-1, keepdims=True)
    return LightMap(np.asarray(direction, np.float32), lamp.on_plane(x, y))
