"""The slopes of a photo's relief, by the network or by the linear step alone."""

from __future__ import annotations

from typing import Literal

import numpy as np
from numpy.typing import NDArray

from voldetail.recover.evidence import Evidence
from voldetail.recover.gates import Gated
from voldetail.recover.light_map import LightMap
from voldetail.recover.linear import Slopes, linear_slopes
from voldetail.recover.network import predict

Method = Literal["network", "linear"]
"""How slopes are found: by the network, or by the linear step alone."""


BELIEF, BELIEF_SLOPE = 0.4, 2.5
LEAST_BELIEF, MOST_BELIEF = 0.3, 1.3
"""How far the network's slopes are believed where the photo's evidence e is what it is: 0.4 + 2.5 e, within bounds. Where paint
hides the shading it makes too much of what it sees, and too little where the surface is even. Tuned on six scans of 256 pixels,
even and painted, under light from 20, 45 and 70 degrees; checked on the registered captures, which took no part."""


def belief(found: Evidence) -> float:
    """Return the factor on the network's slopes; 1 under a light from the front, which leaves no evidence."""
    if found.ratio is None:
        return 1.0
    return float(np.clip(BELIEF + BELIEF_SLOPE * found.ratio, LEAST_BELIEF, MOST_BELIEF))


def slopes_of(
    pixels: NDArray[np.float32], used: NDArray[np.bool_], seen: Gated, lights: LightMap, method: Method, found: Evidence
) -> Slopes:
    """Return the slopes of what was read of ``pixels`` (H, W, 3)."""
    if method == "linear":
        return linear_slopes(seen.detail, lights)
    # Without the mask's edges, which are no relief.
    inside = pixels if used.all() else np.where(used[..., None], pixels, seen.slow[..., None])
    said = predict(np.asarray(inside, np.float32), lights)
    factor = np.where(used, np.float32(belief(found)), np.float32(0.0))
    return Slopes(said.p * factor, said.q * factor)
