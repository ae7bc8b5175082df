"""A distant light: the sun, or a lamp far away."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from voldetail.errors import InputError
from voldetail.records.refusal import shown
from voldetail.setup.lamp import Lamp
from voldetail.setup.lights.kind import Fields, LightKind, LightNumbers, Numbers, listed
from voldetail.setup.lights.vectors import Vector, angles_of, direction_of

SIDES = ("the right", "the upper right", "above", "the upper left", "the left", "the lower left", "below", "the lower right")
HEAD_ON = 80.0
"""Degrees of elevation from which a side can no longer be told."""


class Directional(LightKind):
    """Light from one direction, of the same strength everywhere (GD10's own)."""

    name = "directional"
    forms = ("AZ,EL in degrees", "x,y,z")
    needed = own = ("direction",)

    def fields(self, word: str, numbers: Numbers) -> Fields | None:
        """Return the direction of AZ,EL or x,y,z: what nothing else understands is taken for one."""
        values = numbers(word, (2, 3))
        if len(values) == 3:
            return {"direction": tuple(values)}
        azimuth, elevation = values
        if abs(elevation) > 90 or abs(azimuth) > 360:
            raise InputError(
                f"The light {shown(word)} is out of range: azimuth is -360 to 360 and elevation over 0 to 90 degrees, or, for a"
                " medium, -90 to 90."
            )
        return {"direction": direction_of(azimuth, elevation)}

    def text(self, light: LightNumbers) -> str:
        """Return AZ,EL."""
        assert light.direction is not None
        return listed(*angles_of(light.direction))

    def lamp(self, light: LightNumbers, luminance: NDArray[np.float32] | None) -> Lamp:
        """Return it as it is."""
        return Lamp(direction=light.direction, strength=light.strength)

    def words(self, light: LightNumbers) -> str:
        """Return the side, the azimuth and the elevation."""
        assert light.direction is not None
        azimuth, elevation = angles_of(light.direction)
        if elevation > HEAD_ON:
            return f"from the viewer's side, {elevation:.0f} degrees above the picture"
        side = SIDES[round(azimuth / 45) % 8]
        return f"from {side} (azimuth {azimuth:.0f} degrees), {elevation:.0f} degrees above the picture"

    def source(self, light: LightNumbers) -> Vector | None:
        """Return the direction."""
        return light.direction
