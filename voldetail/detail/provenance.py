"""Where a detail came from, and the distances that chance alone gives: what it carries besides its parameters."""

from __future__ import annotations

from datetime import datetime
from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field, JsonValue, field_validator

Sha256 = Annotated[str, Field(pattern=r"^[0-9a-f]{64}$")]


class Record(BaseModel):
    """Base of the records: frozen, no unknown keys, finite numbers only."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)


class Provenance(Record):
    """Where a detail came from: inputs, versions, settings and what the fit reached."""

    voldetail: str = Field(description="The version of voldetail that made the detail.")
    created: str = Field(description="When it was made, an ISO 8601 date or date and time.")
    photo: str = Field(description="The file name of the photo, without its folder.")
    photo_sha256: Sha256 | None = Field(default=None, description="The SHA-256 of the photo file.")
    mask_sha256: Sha256 | None = Field(default=None, description="The SHA-256 of the mask file, if there was one.")
    zone: tuple[int, int, int, int] | None = Field(
        default=None,
        description="The part of the photo used: x, y, width, height in pixels; null for all of it.",
        json_schema_extra={"allowed": "four whole numbers x, y, width, height", "unit": "pixels"},
    )
    resolution: int = Field(ge=1, description="The longest side of the zone when it was fitted, in pixels.")
    light: str = Field(description="The light of the photo, as it is written on the command line.")
    proxy: str = Field(description="The kind of proxy shape.")
    solver: str = Field(description="The solver that searched.")
    metric: str = Field(description="The metric that was minimised.")
    evaluations: int = Field(ge=0, description="How many pictures were rendered and compared.")
    seconds: float = Field(ge=0, description="How long the fit took, in seconds.")
    distance: float = Field(ge=0, description="The metric M between photo and rendering at the end of the fit.")
    mitsuba: str = Field(description="The version of Mitsuba.")
    drjit: str = Field(description="The version of Dr.Jit.")
    numpy: str = Field(description="The version of NumPy.")
    settings: dict[str, JsonValue] = Field(default_factory=dict, description="The other settings of the fit.")

    @field_validator("created")
    @classmethod
    def _iso(cls, created: str) -> str:
        try:
            datetime.fromisoformat(created)
        except ValueError:
            raise ValueError(f"{created!r:.60} is not an ISO 8601 date such as 2024-05-31") from None
        return created


class NoiseFloor(Record):
    """How small a distance can get by chance: the measure that M has to be held against."""

    other_seed: float | None = Field(
        default=None, ge=0, description="M between two renderings of this detail with different seeds."
    )
    photo_halves: float | None = Field(default=None, ge=0, description="M between two halves of the photo.")
