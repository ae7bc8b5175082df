"""A map of numbers as colours."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib import colormaps
from numpy.typing import NDArray

from voldetail.image import luminance, to_linear, to_srgb

SHOWN = 0.35  # of the photo's lightness under the colours, so that places can be found again
NOWHERE = 0.5  # sRGB grey


def heat(values: NDArray[Any], photo: NDArray[Any] | None = None) -> NDArray[np.float32]:
    """A map (H, W) as a linear picture (H, W, 3): dark blue where it is lowest, yellow where it is highest, grey where NaN.

    `photo` (H, W, 3), linear, shimmers through if given.
    """
    finite = np.isfinite(values)
    low, high = (float(values[finite].min()), float(values[finite].max())) if finite.any() else (0.0, 0.0)
    span = high - low if high > low else 1.0
    colours = colormaps["plasma"](np.where(finite, (values - low) / span, 0))[..., :3]
    if photo is not None:
        grey = to_srgb(np.clip(np.nan_to_num(luminance(photo)), 0, 1))[..., None]
        colours = (1 - SHOWN) * colours + SHOWN * grey
    return to_linear(np.where(finite[..., None], colours, NOWHERE).astype(np.float32))
