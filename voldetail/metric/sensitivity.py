"""How well the eye sees contrast at each frequency (Mannos & Sakrison 1974, "The effects of a visual fidelity criterion on
the encoding of images", equation for A(f))."""

import numpy as np
from numpy.typing import NDArray

PIXELS_A_DEGREE = 40.0
"""A screen of 96 pixels an inch seen from 60 cm has 40 pixels a degree of the eye; the peak is then at waves of 5 pixels."""


def contrast_sensitivity(cycles_a_pixel: NDArray[np.float64]) -> NDArray[np.float64]:
    """A(f) = 2.6 (0.0192 + 0.114 f) exp(-(0.114 f)^1.1), f in cycles a degree; at most 0.98, near 8 cycles."""
    f = 0.114 * PIXELS_A_DEGREE * np.asarray(cycles_a_pixel, np.float64)
    return np.asarray(2.6 * (0.0192 + f) * np.exp(-(f**1.1)))
