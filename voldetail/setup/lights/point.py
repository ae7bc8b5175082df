"""A lamp that is near and shines to all sides."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from voldetail.setup.lamp import Lamp
from voldetail.setup.lights.kind import Fields, LightKind, LightNumbers, Numbers, listed
from voldetail.setup.lights.vectors import Vector


class Point(LightKind):
    """Light from a place, falling off with the square of the distance."""

    name = "point"
    forms = ("point:x,y,z",)
    needed = own = ("position",)

    def fields(self, word: str, numbers: Numbers) -> Fields | None:
        """Return the place."""
        if not word.startswith("point:"):
            return None
        return {"position": tuple(numbers(word.removeprefix("point:"), (3,)))}

    def text(self, light: LightNumbers) -> str:
        """Return point:x,y,z."""
        assert light.position is not None
        return "point:" + listed(*light.position)

    def lamp(self, light: LightNumbers, luminance: NDArray[np.float32] | None) -> Lamp:
        """Return it as it is."""
        return Lamp(position=light.position, strength=light.strength)

    def words(self, light: LightNumbers) -> str:
        """Return the place."""
        assert light.position is not None
        return "a lamp at " + ", ".join(f"{v:.3g}" for v in light.position) + " scene units (right, up, to the viewer)"

    def source(self, light: LightNumbers) -> Vector | None:
        """Return the place."""
        return light.position
