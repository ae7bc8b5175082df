"""A phone's flash at the camera."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from voldetail.setup.lamp import Lamp
from voldetail.setup.lights.kind import Fields, LightKind, LightNumbers, Numbers, listed

FOOT_BLUR = 0.06
"""Blur, in photo widths, before the brightest point is taken as the flash's foot; tuned on the flash photographs of the
test data so that a single glint does not win."""


class Flash(LightKind):
    """A lamp beside the lens, over its foot point in the photo: where that is not given, over the brightest part."""

    name = "flash"
    forms = ("flash", "flash@height", "flash@u,v", "flash@u,v,height")
    own = ("foot",)

    def fields(self, word: str, numbers: Numbers) -> Fields | None:
        """Return the foot and the height, as far as they are given."""
        if word == "flash":
            return {}
        if not word.startswith("flash@"):
            return None
        values = numbers(word.removeprefix("flash@"), (1, 2, 3))
        foot: Fields = {"foot": tuple(values[:2])} if len(values) > 1 else {}
        return foot | ({"height": values[-1]} if len(values) != 2 else {})

    def text(self, light: LightNumbers) -> str:
        """Return flash@height, with the foot where it is given."""
        return "flash@" + listed(*(light.foot or ()), light.height)

    def lamp(self, light: LightNumbers, luminance: NDArray[np.float32] | None) -> Lamp:
        """Return a lamp over the foot, at the photo's middle where there is neither a foot nor a photo."""
        u, v = light.foot or (flash_foot(luminance) if luminance is not None else (0.5, 0.5))
        rows, columns = luminance.shape if luminance is not None else (1, 1)
        unit = 2.0 / max(rows, columns)
        position = ((u - 0.5) * columns * unit, (0.5 - v) * rows * unit, 2.0 * light.height)
        return Lamp(position=position, strength=light.strength, at_camera=True)

    def words(self, light: LightNumbers) -> str:
        """Return the height and the foot."""
        foot = ""
        if light.foot:
            left, top = (100 * v for v in light.foot)
            foot = f", nearest {left:.0f} % from the left and {top:.0f} % from the top"
        return f"a flash {light.height:.3g} photo widths in front of it{foot}"


def flash_foot(luminance: NDArray[np.float32]) -> tuple[float, float]:
    """Return where a flash photo is brightest, as fractions (u, v) from the left and the top."""
    from scipy.ndimage import gaussian_filter  # loaded when a photo is there: the command line starts without it

    rows, columns = luminance.shape
    # Full resolution is not needed for a wide blur.
    step = max(1, max(rows, columns) // 256)
    small = luminance[::step, ::step]
    blurred = gaussian_filter(small.astype(np.float64), FOOT_BLUR * max(small.shape), mode="constant")
    weight = gaussian_filter(np.ones_like(small, dtype=np.float64), FOOT_BLUR * max(small.shape), mode="constant")
    row, column = np.unravel_index(np.argmax(blurred / weight), small.shape)
    return (float(column) + 0.5) / small.shape[1], (float(row) + 0.5) / small.shape[0]
