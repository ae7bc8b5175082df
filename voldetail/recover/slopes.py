"""The slopes of a photo's relief, by the network or by the linear step alone."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from voldetail.recover.gates import Gated
from voldetail.recover.light_map import LightMap
from voldetail.recover.linear import linear_slopes
from voldetail.recover.network import predict

Method = Literal["network", "linear"]
"""How slopes are found: by the network, or by the linear step alone."""


@dataclass(frozen=True, eq=False)
class Found:
    """p = dh/dx, q = dh/dy (up), (H, W). paint (H, W): log albedo over its local mean, None where it was not looked for."""

    p: NDArray[np.float32]
    q: NDArray[np.float32]
    paint: NDArray[np.float32] | None = None


def slopes_of(pixels: NDArray[np.float32], used: NDArray[np.bool_], seen: Gated, lights: LightMap, method: Method) -> Found:
    """Return the slopes of what was read of ``pixels`` (H, W, 3)."""
    if method == "linear":
        slopes = linear_slopes(seen.detail, lights)
        return Found(slopes.p, slopes.q)
    # Without the mask's edges, which are no relief.
    inside = pixels if used.all() else np.where(used[..., None], pixels, seen.slow[..., None])
    found = predict(np.asarray(inside, np.float32), lights)
    return Found(np.where(used, found.p, 0.0).astype(np.float32), np.where(used, found.q, 0.0).astype(np.float32), found.paint)
