"""The camera of a setup."""

from __future__ import annotations

import math
from typing import Literal

from pydantic import Field

from voldetail.detail.record import Record
from voldetail.setup.light import FURTHEST

DEFAULT_FIELD_OF_VIEW = 40.0  # degrees, about a 50 mm lens on 35 mm film
ORTHOGRAPHIC_DISTANCE = 4.0  # scene units; any value in front of the proxy gives the same picture


class CameraSetup(Record):
    """A camera on the z axis that looks along -z, y up."""

    kind: Literal["orthographic", "perspective"] = Field(default="orthographic", description="The projection.")
    field_of_view: float = Field(
        default=DEFAULT_FIELD_OF_VIEW,
        ge=1,
        le=150,
        json_schema_extra={"unit": "degrees"},
        description="The angle across the longest side of the photo, in degrees; perspective only.",
    )
    distance: float | None = Field(
        default=None,
        gt=0,
        le=FURTHEST,
        json_schema_extra={"unit": "scene units"},
        description="From the camera to the origin; null: a proxy 2 across just fills the view.",
    )

    @property
    def distance_used(self) -> float:
        """From the camera to the origin, in scene units: as given, or the default of the kind."""
        if self.distance is not None:
            return self.distance
        if self.kind == "orthographic":
            return ORTHOGRAPHIC_DISTANCE
        return 1 / math.tan(math.radians(self.field_of_view) / 2)
