"""The frozen Setup: what a photo is of, and how a detail is fitted to it.

Lengths are in scene units, in which the proxy is about 2 across; x points right, y up, z to the viewer, and
the proxy is at the origin unless it is moved. A light direction points FROM the surface TO the light.
"""

from __future__ import annotations

import math
from pathlib import Path
from typing import Annotated, Literal

from pydantic import Field, model_validator

from voldetail.detail.parameters import declared, parameter
from voldetail.detail.record import LARGEST_SEED, Record
from voldetail.records.examples import NAMES, PREFIX
from voldetail.records.nearest import nearest
from voldetail.setup.light import FURTHEST, Length, Light, Vector
from voldetail.setup.shapes import SHAPES, ShapeKind, ShapeRow

__all__ = ["CameraSetup", "FitSettings", "Light", "PhotoSetup", "ProxySetup", "Setup", "Vector"]


SMALLEST_ZONE = 32  # pixels: the metric's 8-pixel window on the third level of its pyramid, 8 * 2**2
DEFAULT_FIELD_OF_VIEW = 40.0  # degrees, about a 50 mm lens on 35 mm film
ORTHOGRAPHIC_DISTANCE = 4.0  # scene units; any value in front of the proxy gives the same picture

_Pixels = Annotated[int, Field(ge=0, le=100_000)]  # no photo that is read is longer than this
_Turn = Annotated[float, Field(ge=-360, le=360)]


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


class ProxySetup(Record):
    """The simple shape that stands for the object: `size` None means the kind's own (see `extent`)."""

    kind: ShapeKind = Field(default="plane", description="The kind of shape; a plane faces the camera.")
    mesh: Path | None = Field(default=None, description="The mesh file, for the kind mesh only.")
    size: Vector | None = Field(
        default=None,
        description="Width, height and depth, in scene units.",
        json_schema_extra={"allowed": f"three numbers over 0, at most {FURTHEST:g} scene units"},
    )
    position: tuple[Length, Length, Length] = Field(
        default=(0.0, 0.0, 0.0),
        description="Where its centre is, in scene units.",
        json_schema_extra={"allowed": f"three numbers, each -{FURTHEST:g} to {FURTHEST:g} scene units"},
    )
    rotation: tuple[_Turn, _Turn, _Turn] = Field(
        default=(0.0, 0.0, 0.0),
        description="Turns about x, then y, then z, in degrees.",
        json_schema_extra={"allowed": "three numbers, each -360 to 360 degrees"},
    )

    @property
    def row(self) -> ShapeRow:
        """What a setup knows of the kind."""
        return SHAPES[self.kind]

    @property
    def extent(self) -> Vector:
        """Width, height and depth in scene units: as given, or the kind's default."""
        return self.size or self.row.size

    @model_validator(mode="after")
    def _usable(self) -> ProxySetup:
        if self.row.of_file and self.mesh is None:
            raise ValueError(f'the kind "{self.kind}" needs the path of a mesh file as proxy.mesh')
        if not self.row.of_file and self.mesh is not None:
            raise ValueError(f'a mesh file is given but the kind is "{self.kind}"; set proxy.kind to "mesh"')
        thick = 2 if self.row.flat else 3  # a plane has no depth
        if self.size and not (min(self.size[:thick]) > 0 and self.size[2] >= 0 and max(self.size) <= FURTHEST):
            raise ValueError(
                f"the size {','.join(f'{v:g}' for v in self.size)} has to be over 0 and at most {FURTHEST:g} scene units each way"
            )
        if refused := self.row.refused(self.extent):
            raise ValueError(refused)
        return self


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


class FitSettings(Record):
    """How the search is done."""

    solver: Literal["default", "paper"] = Field(default="default", description="Ours, or the one of GD10 section 7.")
    metric: str = Field(default="combined", min_length=1, description="The distance that is minimised.")
    evaluations: int | None = Field(
        default=None,
        ge=1,
        le=1_000_000,
        description="The most pictures that are rendered; null: the solver's own number.",
    )
    time_limit: float | None = Field(
        default=None,
        gt=0,
        le=1e6,
        json_schema_extra={"unit": "seconds"},
        description="The longest time for the search, in seconds; null for no limit.",
    )
    seeds: int = Field(default=2, ge=1, le=16, description="Noise seeds compared at once, so that none is overfitted.")
    specular: bool = Field(default=True, description="Whether the surface may have a highlight.")
    library: str = Field(
        default="auto", min_length=1, max_length=4096,
        description="Reliefs to start from: auto (built once and kept), none, or a library's path.",
    )  # fmt: skip


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
