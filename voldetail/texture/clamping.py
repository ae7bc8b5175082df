"""How much of each band a pixel lets through (frequency clamping; Norton et al. 1982, Cook and DeRose 2005, section 5).

A pixel is taken as a square of ``footprint`` texels. The share of a band's variance that is left after the mean over it is
known (`noise.wavelet_spectrum.passed_variance`), and the band's weight is multiplied by its square root: it fades smoothly,
from 1 where the pixel is small to nothing where it is as long as the band's wavelengths.
"""

from __future__ import annotations

from functools import cache

import numpy as np
from numpy.typing import NDArray

from voldetail.noise.wavelet_spectrum import passed_variance
from voldetail.texture.solid import FINEST_SHARE, SLICE_SHARE, share

SMALLEST_LOG, LARGEST_LOG = -4.0, 6.0
"""log2 of a pixel's side in coefficients, between which the table lies: 0.998 of the variance passes at one end, nothing at
the other."""

STEPS = 81


@cache
def passed_table(dims: int) -> NDArray[np.float32]:
    """Return the share of variance (STEPS,) that passes a pixel, by log2 of its side in coefficients; read-only, cached.

    dims: 2, or 3 for a slice of solid noise. A slice's power lies in the octaves of SLICE_SHARE, and each octave passes as
    the 2D band of that octave does: right for the mean over octaves, though a 2D band is a little wider than an octave.
    """
    logs = np.linspace(SMALLEST_LOG, LARGEST_LOG, STEPS)
    plane = passed_variance(2.0**logs)
    plane[0], plane[-1] = 1.0, 0.0
    if dims == 3:
        octaves = range(FINEST_SHARE, 12)
        shares = np.array([share(SLICE_SHARE, k) for k in octaves])
        parts = np.stack([np.interp(logs - k, logs, plane) for k in octaves])
        plane = (shares[:, None] * parts).sum(axis=0) / shares.sum()
        plane[0] = 1.0
    table = plane.astype(np.float32)
    table.flags.writeable = False
    return table
