"""The curve after part of the noise was clamped away: mean and variance over the removed part, as a table.

    Hbar(z, r) = E_g[H(Phi(z + sqrt(r) g))],      V(z, r) = E_g[H^2] - Hbar^2,      g normal

z is what is left of the noise, divided by the whole noise's deviation, and r the share of its variance that was removed. A
pixel sees the mean of the curve's values and not the curve's value at the mean (Hart et al. 1999; Lagae et al. 2009).
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from voldetail.texture.curve import curve_at

FARTHEST = 5.0
"""Deviations at which the table ends; |z| is larger once in two million texels."""

COLUMNS = 257
"""Places in z: steps of 0.04, a fifteenth of the distance between the curve's samples."""

ROWS = 33
"""Places in r, in equal steps: the mean is a solution of the heat equation in r, and so nearly straight along it."""

_ORDER = 24


@lru_cache(maxsize=256)
def filtered_curve(samples: tuple[float, ...]) -> NDArray[np.float32]:
    """Return (ROWS, COLUMNS, 2): mean and variance at r = 0 to 1 and z = -FARTHEST to FARTHEST; read-only, cached."""
    nodes, weights = np.polynomial.hermite_e.hermegauss(_ORDER)
    weights = weights / weights.sum()
    z = np.linspace(-FARTHEST, FARTHEST, COLUMNS)
    removed = np.sqrt(np.linspace(0.0, 1.0, ROWS))
    values = curve_at(samples, z[None, :, None] + removed[:, None, None] * nodes)
    mean = values @ weights
    spread = np.maximum((values - mean[..., None]) ** 2 @ weights, 0.0)
    table = np.stack([mean, spread], axis=-1).astype(np.float32)
    table.flags.writeable = False
    return table
