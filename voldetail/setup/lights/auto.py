"""A light that is not known yet."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from voldetail.errors import InputError
from voldetail.setup.lamp import Lamp
from voldetail.setup.lights.kind import Fields, LightKind, LightNumbers, Numbers


class Auto(LightKind):
    """To be estimated from a photo, by a fit."""

    name = "auto"
    forms = ("auto",)
    estimated = True

    def fields(self, word: str, numbers: Numbers) -> Fields | None:
        """Return nothing for the word itself."""
        return {} if word == "auto" else None

    def text(self, light: LightNumbers) -> str:
        """Return the word."""
        return "auto"

    def lamp(self, light: LightNumbers, luminance: NDArray[np.float32] | None) -> Lamp:
        """Raise InputError: there is nothing yet."""
        raise InputError(
            "The light auto is estimated from a photo, by fit alone: give it as AZ,EL in degrees, or another that stands."
        )

    def words(self, light: LightNumbers) -> str:
        """Return that it is not known."""
        return "to be estimated from the photo"
