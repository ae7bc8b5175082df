"""The light as the user gives it: a record, and the text for it on the command line."""

from __future__ import annotations

import math
from typing import Annotated, Any

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, ValidationError, field_validator, model_validator

from voldetail.detail.record import Record
from voldetail.errors import InputError
from voldetail.records.refusal import refusal, shown
from voldetail.setup.lamp import Lamp
from voldetail.setup.lights.kind import LightKind
from voldetail.setup.lights.table import FORMS, FORMS_GIVEN, LIGHTS, LightName
from voldetail.setup.lights.vectors import FURTHEST, Vector, angles_of, direction_of, numbers_of

__all__ = [
    "FORMS", "FORMS_GIVEN", "FURTHEST", "Length", "Light", "Vector", "angles_of", "direction_of", "lamp_of", "light_text",
    "parse_light",
]  # fmt: skip

SHORTEST = 1e-12  # a direction shorter than this is zero for the user, and dividing by it is inexact
Length = Annotated[float, Field(ge=-FURTHEST, le=FURTHEST)]
_Share = Annotated[float, Field(ge=0, le=1)]


class Light(Record):
    """The light: a `direction` (made a unit vector), a `position`, a phone's flash at the camera, or not known yet."""

    kind: LightName = Field(default="directional", description="The kind of light; auto is estimated from the photo by a fit.")
    direction: Vector | None = Field(
        default=None,
        description="From the surface to the light; directional only.",
        json_schema_extra={"allowed": "three numbers x, y, z, z over 0 but for a medium"},
    )
    position: tuple[Length, Length, Length] | None = Field(
        default=None,
        description="Where the lamp is, in scene units; point and spot only.",
        json_schema_extra={"allowed": f"three numbers x, y, z of at most {FURTHEST:g}, z over 0 but for a medium"},
    )
    target: tuple[Length, Length, Length] | None = Field(
        default=None,
        description="What the lamp is aimed at, in scene units; spot only.",
        json_schema_extra={"allowed": f"three numbers x, y, z of at most {FURTHEST:g}"},
    )
    angle: float | None = Field(
        default=None,
        ge=1,
        le=85,
        json_schema_extra={"unit": "degrees"},
        description="Half the opening of the lamp's cone, in degrees; spot only.",
    )
    foot: tuple[_Share, _Share] | None = Field(
        default=None,
        description="Where in the photo the flash is nearest, as fractions from the left and the top; null: the brightest point.",
        json_schema_extra={"allowed": "two numbers u, v, each 0 to 1"},
    )
    height: float = Field(
        default=1.0,
        ge=0.05,
        le=100,
        description="How far the flash is, in units of the photo's longest side; flash only.",
    )
    strength: float = Field(default=1.0, gt=0, le=1e6, description="How strong the light is; 1 is the usual.")

    @field_validator("direction")
    @classmethod
    def _unit(cls, direction: Vector | None) -> Vector | None:
        if direction is None:
            return None
        length = math.hypot(*direction)
        if not SHORTEST < length < math.inf:
            raise ValueError("it is zero or too long; give x,y,z from the surface to the light")
        # Left alone when it is a unit vector already, so that a Setup read back from its file is the same.
        made = direction if abs(length - 1) < 1e-12 else tuple(v / length for v in direction)
        return made[0], made[1], made[2]

    @model_validator(mode="after")
    def _usable(self) -> Light:
        mine = LIGHTS[self.kind]
        for name in mine.needed:
            if getattr(self, name) is None:
                what = "number of degrees" if name == "angle" else "three numbers x, y, z"
                raise ValueError(f'a light of kind "{self.kind}" needs its {name}: {what}')
        for name in dict.fromkeys(name for light in LIGHTS.values() for name in light.own):
            if name not in mine.own and getattr(self, name) is not None:
                owners = " or ".join(f'"{light.name}"' for light in LIGHTS.values() if name in light.own)
                raise ValueError(f'{name} belongs to a light of kind {owners}, but the kind is "{self.kind}"')
        return self

    @property
    def row(self) -> LightKind:
        """What its kind does with it."""
        return LIGHTS[self.kind]

    @property
    def behind(self) -> str:
        """Why only a medium can be lit by it, which light passes through; empty where it stands before the surface."""
        vector = self.row.source(self)
        if not vector or vector[2] > 0:
            return ""
        return f"it is behind the surface: z is {vector[2]:g}, and has to be over 0 (to the viewer) but for a medium"


def parse_light(text: str) -> Light:
    """The light that `text` describes, in one of the forms in FORMS.

    Raises InputError for another form, a wrong count, NaN or a zero vector.
    """
    word = text.strip()

    def numbers(listed: str, counts: tuple[int, ...]) -> list[float]:
        return numbers_of(text, listed, counts, FORMS)

    for light in LIGHTS.values():
        if (fields := light.fields(word, numbers)) is not None:
            return _light(text, kind=light.name, **fields)
    raise InputError(f"The light {shown(text)} is not understood; use {FORMS}.")


def light_text(light: Light) -> str:
    """`light` in the form that `parse_light` reads, numbers to 7 digits; the strength is left out."""
    return light.row.text(light)


def lamp_of(light: Light, luminance: NDArray[np.float32] | None = None) -> Lamp:
    """Return the Lamp for a Light of a Setup; a flash without a foot is over the brightest part of ``luminance``.

    Raises InputError for the light "auto", which only a fit can make a direction of.
    """
    return light.row.lamp(light, luminance)


def _light(text: str, **fields: Any) -> Light:
    try:
        return Light(**fields)
    except ValidationError as error:
        raise InputError(refusal(error, Light, f"The light {shown(text)}") + ".") from None
