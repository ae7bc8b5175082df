"""The light as the user gives it: a record, and the text for it on the command line."""

from __future__ import annotations

import math
from typing import Annotated, Any, Literal

from pydantic import Field, ValidationError, field_validator, model_validator

from voldetail.detail.record import Record
from voldetail.errors import InputError
from voldetail.records.refusal import refusal, shown

SHORTEST = 1e-12  # a direction shorter than this is zero for the user, and dividing by it is inexact
FURTHEST = 1000.0  # scene units, 500 proxies away: beyond it a length is a slip of the pen

Vector = tuple[float, float, float]
Length = Annotated[float, Field(ge=-FURTHEST, le=FURTHEST)]
_Share = Annotated[float, Field(ge=0, le=1)]


class Light(Record):
    """The light: a `direction` (made a unit vector), a `position`, a phone's flash at the camera, or not known yet."""

    kind: Literal["directional", "point", "flash", "auto"] = Field(
        default="directional", description="The kind of light; auto is estimated from the photo by a fit."
    )
    direction: Vector | None = Field(
        default=None,
        description="From the surface to the light; directional only.",
        json_schema_extra={"allowed": "three numbers x, y, z, z over 0 but for a medium"},
    )
    position: tuple[Length, Length, Length] | None = Field(
        default=None,
        description="Where the lamp is, in scene units; point only.",
        json_schema_extra={"allowed": f"three numbers x, y, z of at most {FURTHEST:g}, z over 0 but for a medium"},
    )
    foot: tuple[_Share, _Share] | None = Field(
        default=None,
        description="Where in the photo the flash is nearest, as fractions from the left and the top;"
        " null: the brightest point.",
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
        wanted = {"directional": "direction", "point": "position"}.get(self.kind)
        if wanted and getattr(self, wanted) is None:
            raise ValueError(f'a light of kind "{self.kind}" needs its {wanted}: three numbers x, y, z')
        for name, kind in (("direction", "directional"), ("position", "point"), ("foot", "flash")):
            if getattr(self, name) is not None and self.kind != kind:
                raise ValueError(f'{name} belongs to a light of kind "{kind}", but the kind is "{self.kind}"')
        return self

    @property
    def behind(self) -> str:
        """Why only a medium can be lit by it, which light passes through; empty where it stands before the surface."""
        vector = self.direction or self.position
        if not vector or vector[2] > 0:
            return ""
        return f"it is behind the surface: z is {vector[2]:g}, and has to be over 0 (to the viewer) but for a medium"


FORMS_GIVEN = "AZ,EL in degrees, x,y,z, flash, flash@height, flash@u,v, flash@u,v,height or point:x,y,z"
FORMS = FORMS_GIVEN + ", or auto to have it estimated"


def direction_of(azimuth: float, elevation: float) -> Vector:
    """The unit vector of a light: (cos el cos az, cos el sin az, sin el), angles in degrees.

    The azimuth runs from +x counter-clockwise in the image plane, the elevation from there to the viewer.
    """
    az, el = math.radians(azimuth), math.radians(elevation)
    return math.cos(el) * math.cos(az), math.cos(el) * math.sin(az), math.sin(el)


def angles_of(direction: Vector) -> tuple[float, float]:
    """Azimuth in [0, 360) and elevation of a direction, in degrees: the inverse of `direction_of`."""
    x, y, z = direction
    return math.degrees(math.atan2(y, x)) % 360, math.degrees(math.atan2(z, math.hypot(x, y)))


def parse_light(text: str) -> Light:
    """The light that `text` describes, in one of the forms in FORMS.

    Raises InputError for another form, a wrong count, NaN or a zero vector.
    """
    word = text.strip()
    if word in ("flash", "auto"):
        return _light(text, kind=word)
    if word.startswith("flash@"):
        numbers = _numbers(text, word.removeprefix("flash@"), (1, 2, 3))
        foot = {"foot": tuple(numbers[:2])} if len(numbers) > 1 else {}
        height = {"height": numbers[-1]} if len(numbers) != 2 else {}
        return _light(text, kind="flash", **foot, **height)
    if word.startswith("point:"):
        return _light(text, kind="point", position=tuple(_numbers(text, word.removeprefix("point:"), (3,))))
    numbers = _numbers(text, word, (2, 3))
    if len(numbers) == 3:
        return _light(text, direction=tuple(numbers))
    azimuth, elevation = numbers
    if abs(elevation) > 90 or abs(azimuth) > 360:
        raise InputError(
            f"The light {shown(text)} is out of range: azimuth is -360 to 360 and elevation over 0 to 90 degrees, or, for a"
            " medium, -90 to 90."
        )
    return _light(text, direction=direction_of(azimuth, elevation))


def light_text(light: Light) -> str:
    """`light` in the form that `parse_light` reads, numbers to 7 digits; the strength is left out."""
    if light.direction:
        return ",".join(f"{a:.7g}" for a in angles_of(light.direction))
    if light.position:
        return "point:" + ",".join(f"{a:.7g}" for a in light.position)
    if light.kind == "auto":
        return "auto"
    if light.foot:
        return f"flash@{light.foot[0]:.7g},{light.foot[1]:.7g},{light.height:.7g}"
    return f"flash@{light.height:.7g}"


def _numbers(text: str, listed: str, counts: tuple[int, ...]) -> list[float]:
    try:
        numbers = [float(part) for part in listed.split(",")]
    except ValueError:
        raise InputError(f"The light {shown(text)} is not understood; use {FORMS}.") from None
    if not all(map(math.isfinite, numbers)):
        raise InputError(f"The light {shown(text)} holds a number that is not finite; use {FORMS}.")
    if len(numbers) not in counts:
        wanted = " or ".join(map(str, counts))
        raise InputError(
            f"The light {shown(text)} has {len(numbers)} numbers where {wanted} are wanted; use {FORMS}."
        )
    return numbers


def _light(text: str, **fields: Any) -> Light:
    try:
        return Light(**fields)
    except ValidationError as error:
        raise InputError(refusal(error, Light, f"The light {shown(text)}") + ".") from None
