"""How much of each band a pixel lets through (frequency clamping; Norton et al. 1982, Cook and DeRose 2005, section 5).

A pixel is taken as a square of ``footprint`` texels. The share of a band's variance that is left after the mean over it is
known (`noise.wavelet_spectrum.passed_variance`), and the band's weight is multiplied by its square root: it fades smoothly,
from 1 where the pixel is small to nothing where it is as long as the band's wavelengths.
"""

from __future__ import annotations

from functools import cache

import numpy as np
from numpy.typing import NDArray

from voldetail.noise.gabor import TURN
from voldetail.noise.wavelet_spectrum import passed_slice, passed_variance

SMALLEST_LOG, LARGEST_LOG = -4.0, 6.0
"""log2 of a pixel's side in coefficients, between which the table lies: 0.998 of the variance passes at one end, under
1e-4 (2D) and 1e-3 (a slice) at the other."""

STEPS = 81


@cache
def passed_table(dims: int) -> NDArray[np.float32]:
    """Return the share of variance (STEPS,) that passes a pixel, by log2 of its side in coefficients; read-only, cached.

    dims: 2, or 3 for a slice of solid noise, of which some is always slower than the pixel.
    """
    logs = np.linspace(SMALLEST_LOG, LARGEST_LOG, STEPS)
    passed = passed_variance(2.0**logs) if dims == 2 else passed_slice(2.0**logs, TURN)
    passed[0] = 1.0
    # Rounding makes the far end rise and fall by a millionth.
    table = np.minimum.accumulate(passed).astype(np.float32)
    table.flags.writeable = False
    return table
