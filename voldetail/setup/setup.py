"""The frozen Setup: what a photo is of, and how a detail is fitted to it.

Lengths are in scene units, in which the proxy is about 2 across; x points right, y up, z to the viewer, and
the proxy is at the origin unless it is moved. A light direction points FROM the surface TO the light.
"""

from __future__ import annotations

from pathlib import Path
from typing import Literal

from pydantic import Field, model_validator

from voldetail.detail.parameters import declared, parameter
from voldetail.detail.record import LARGEST_SEED, Record
from voldetail.setup.camera import CameraSetup
from voldetail.setup.fit_settings import FitSettings
from voldetail.setup.light import Light
from voldetail.setup.photo import PhotoSetup
from voldetail.setup.proxy import ProxySetup


class Setup(Record):
    """All that a fit needs besides the photo's pixels."""

    photo: PhotoSetup = Field(description="The photo.", json_schema_extra={"allowed": "a table with path"})
    mask: Path | None = Field(default=None, description="A picture whose white pixels are used; null for all.")
    proxy: ProxySetup = Field(default_factory=ProxySetup, description="The shape in the photo.")
    camera: CameraSetup = Field(default_factory=CameraSetup, description="The camera.")
    light: Light = Field(
        description="The light in the photo.",
        json_schema_extra={"allowed": '"AZ,EL" in degrees, "x,y,z", "flash", "point:x,y,z", "auto", or a table'},
    )
    amplitude: float | None = Field(
        default=None,
        gt=0,
        le=parameter("relief.amplitude").upper,
        json_schema_extra={"unit": "scene units"},
        description="The amplitude A_d of the relief, in scene units; null: searched.",
    )
    domain: Literal["solid", "surface"] = declared("noise.domain")
    mode: Literal["displacement", "volume"] = Field(
        default="displacement",
        description="Whether relief displaces the proxy's surface, or shifts the points of space through its density.",
    )
    look: Literal["surface", "medium"] = Field(
        default="surface", description="How a volume is seen: as the surface of solid matter, or as a medium, as clouds."
    )
    colour: Literal["auto", "by-example", "height", "cell", "none"] = Field(
        default="auto",
        description="How the surface's colour is made: by example, with height, by the cell, none, or whichever is nearest.",
    )
    fit: FitSettings = Field(default_factory=FitSettings, description="How the search is done.")
    relief: bool = Field(
        default=True,
        description="Whether the photo's own relief is kept beside the detail; of a plane that faces the camera.",
    )
    seed: int = Field(default=0, ge=0, le=LARGEST_SEED, description="The root of every random number.")
    output: Path | None = Field(default=None, description="The folder for results; null: one named by the photo.")

    @property
    def medium(self) -> bool:
        """Whether the photo is of a medium."""
        return self.mode == "volume" and self.look == "medium"

    @model_validator(mode="after")
    def _volume(self) -> Setup:
        if self.photo.stationarize and (not self.proxy.row.flat or self.medium):
            raise ValueError("an even picture can be made of a flat surface alone: leave stationarize out, or the proxy a plane")
        if self.mode == "displacement" and self.look == "medium":
            raise ValueError('the look "medium" needs the mode "volume"; a displaced surface is solid')
        if self.colour not in ("auto", "none") and (self.medium or (self.mode == "volume" and self.colour != "by-example")):
            allowed = "none" if self.medium else "by-example or none"
            raise ValueError(f"the colour {self.colour!r} is for displaced surfaces; for this use {allowed}")
        if self.mode == "volume" and self.domain == "surface":
            raise ValueError('the mode "volume" needs noise that fills space: leave the domain "solid"')
        if self.light.behind and not self.medium:
            raise ValueError(f"the light cannot be used: {self.light.behind}")
        return self
