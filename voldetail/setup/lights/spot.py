"""A lamp that is near and shines into a cone: a work light, a torch.

Symbols
    a      angle between the cone's axis and the way to a point
    A      half the cone's opening, `angle`
    f(a)   1 up to BEAM A, then falling in a straight line to 0 at A, as Mitsuba's `spot` does
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from voldetail.errors import InputError
from voldetail.setup.lamp import Lamp
from voldetail.setup.lights.kind import Fields, LightKind, LightNumbers, Numbers, listed
from voldetail.setup.lights.vectors import Vector


class Spot(LightKind):
    """Light from a place into a cone about the way to a target, falling off with distance and towards the cone's edge."""

    name = "spot"
    forms = ("spot:x,y,z@u,v,w,ANGLE",)
    needed = own = ("position", "target", "angle")

    def fields(self, word: str, numbers: Numbers) -> Fields | None:
        """Return the place, the place that it is aimed at, and half the cone's opening in degrees."""
        if not word.startswith("spot:"):
            return None
        place, _, aim = word.removeprefix("spot:").partition("@")
        values = numbers(aim, (4,))
        return {"position": tuple(numbers(place, (3,))), "target": tuple(values[:3]), "angle": values[3]}

    def text(self, light: LightNumbers) -> str:
        """Return spot:x,y,z@u,v,w,ANGLE."""
        assert light.position is not None
        assert light.target is not None
        assert light.angle is not None
        return f"spot:{listed(*light.position)}@{listed(*light.target, light.angle)}"

    def lamp(self, light: LightNumbers, luminance: NDArray[np.float32] | None) -> Lamp:
        """Return it as it is. Raises InputError where it is aimed at its own place."""
        assert light.position is not None
        assert light.target is not None
        assert light.angle is not None
        axis = np.subtract(light.target, light.position)
        length = float(np.linalg.norm(axis))
        if length < 1e-9:
            raise InputError("The spot light is aimed at the place where it stands: give another target.")
        x, y, z = (float(v) for v in axis / length)
        return Lamp(position=light.position, strength=light.strength, axis=(x, y, z), cone=math.radians(light.angle))

    def words(self, light: LightNumbers) -> str:
        """Return the place, the target and the opening."""
        assert light.position is not None
        assert light.target is not None
        place, aim = (", ".join(f"{v:.3g}" for v in p) for p in (light.position, light.target))
        return f"a spot light at {place} scene units, aimed at {aim}, {light.angle:.3g} degrees to each side"

    def source(self, light: LightNumbers) -> Vector | None:
        """Return the place."""
        return light.position
