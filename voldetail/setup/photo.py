"""The photo of a setup, and the part of it that is looked at."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

from pydantic import Field, model_validator

from voldetail.detail.record import Record
from voldetail.records.examples import NAMES, PREFIX
from voldetail.records.nearest import nearest

SMALLEST_ZONE = 32  # pixels: the metric's 8-pixel window on the third level of its pyramid, 8 * 2**2

_Pixels = Annotated[int, Field(ge=0, le=100_000)]  # no photo that is read is longer than this


class PhotoSetup(Record):
    """The photo and the part of it that is looked at."""

    path: str = Field(min_length=1, description="The photo file, or skimage:gravel, skimage:grass or skimage:brick.")
    encoding: Literal["auto", "srgb", "linear"] = Field(
        default="auto", description="How its numbers stand for light; auto goes by the file's kind."
    )
    zone: tuple[_Pixels, _Pixels, _Pixels, _Pixels] | None = Field(
        default=None,
        description="The part that is used, in pixels of the photo; null for all of it.",
        json_schema_extra={"allowed": f"x, y, width, height in pixels, the last two at least {SMALLEST_ZONE}"},
    )
    resolution: int = Field(
        default=192,
        ge=64,
        le=1024,
        json_schema_extra={"unit": "pixels"},
        description="The longest side of the zone after resampling, in pixels.",
    )
    stationarize: bool = Field(
        default=False, description="Whether an even picture is made of it first, without stains and slow shading."
    )

    @property
    def skimage(self) -> str | None:
        """The name of the scikit-image photograph, or None for a file."""
        return self.path.removeprefix(PREFIX) if self.path.startswith(PREFIX) else None

    @property
    def name(self) -> str:
        """The file name without its folder, for reports and provenance."""
        return self.path if self.skimage else Path(self.path).name

    @model_validator(mode="after")
    def _usable(self) -> PhotoSetup:
        if self.skimage is not None and self.skimage not in NAMES:
            raise ValueError(f"there is no photo {self.path[:60]!r}; {nearest(self.skimage, list(NAMES))}")
        if self.zone and min(self.zone[2:]) < SMALLEST_ZONE:
            size = f"{self.zone[2]} x {self.zone[3]}"
            raise ValueError(f"the zone is {size} pixels; it has to be at least {SMALLEST_ZONE} each way")
        return self
