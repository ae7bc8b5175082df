"""A detail made of maps: the photo's own relief, as `relief.json` beside its pictures tells of it.

It stands wherever a procedural Detail stands: it has an amplitude, a reflectance, a seed and a name, and what is at a point is
looked up in maps (field.mapped) where a Detail computes noise.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, model_validator

from voldetail.detail.provenance import Provenance, Record, Sha256
from voldetail.detail.record import LARGEST_SEED, Detail, Reflectance, ReliefParameters

RELIEF_VERSION: Literal[1] = 1
SMALLEST_SIDE, LARGEST_SIDE = 16, 16384
"""Pixels a side of the maps."""

Arrangement = Literal["photo", "endless"]


class MapFile(Record):
    """A picture beside the relief's file."""

    path: str = Field(min_length=1, max_length=255, pattern=r"^[^/\\]+$", description="The file's name, in the relief's folder.")
    sha256: Sha256 = Field(description="The SHA-256 of the file.")


class ReliefMapFiles(Record):
    """The maps of a photo's relief, all of one size."""

    height: MapFile = Field(description="Height above the lowest point, in scene units: OpenEXR, float.")
    normal: MapFile = Field(description="Unit normals (n + 1) / 2, y up: PNG, 16 bit, not encoded.")
    albedo: MapFile = Field(description="Albedo: PNG, 16 bit, sRGB.")
    roughness: MapFile = Field(description="Roughness alpha of the highlight, 0 to 1: PNG, 16 bit, not encoded.")


class PhotoRelief(Record):
    """The photo's own relief, as its file holds it; the numbers of pixels are in `maps`."""

    version: Literal[1] = Field(default=RELIEF_VERSION, description="The version of the file format.")
    name: str = Field(default="relief", min_length=1, max_length=200, description="A name for people.")
    seed: int = Field(default=0, ge=0, le=LARGEST_SEED, description="The seed of the random places, where it is made endless.")
    columns: int = Field(ge=SMALLEST_SIDE, le=LARGEST_SIDE, description="Width of the maps, in pixels.")
    rows: int = Field(ge=SMALLEST_SIDE, le=LARGEST_SIDE, description="Height of the maps, in pixels.")
    texels_per_unit: float = Field(gt=0, le=1e6, description="Pixels a scene unit; the photo's longest side is 2 units.")
    periodic: bool = Field(default=False, description="Whether opposite edges meet: a tile.")
    relief: ReliefParameters = Field(description="The height of the highest point above the lowest, in scene units.")
    reflectance: Reflectance = Field(description="Ka, Kd, Ks and N; on Ka and Kd goes the albedo map over its mean luminance.")
    light: str = Field(min_length=1, max_length=200, description="The light of the photo, as on the command line.")
    confidence: float = Field(ge=0, le=1, description="How sure the relief is, 0 to 1, in the mean.")
    notes: tuple[str, ...] = Field(default=(), max_length=50, description="What was seen on the way, in sentences.")
    maps: ReliefMapFiles = Field(description="The maps.")
    provenance: Provenance | None = Field(default=None, description="Where it came from.")

    @model_validator(mode="after")
    def _plain(self) -> PhotoRelief:
        r = self.reflectance
        used = [name for name in ("height_albedo", "cell_albedo", "speckle") if getattr(r, name) != 0.0]
        if used:
            raise ValueError(f"a relief of maps has its pattern of albedo in them: set reflectance.{used[0]} to 0")
        if self.relief.amplitude == 0:
            raise ValueError("relief.amplitude has to be over 0; a flat photo has no relief to keep")
        return self


@dataclass(frozen=True, eq=False)
class MappedDetail:
    """A photo's relief with its maps in memory.

    height (H, W) float32: 0 at the lowest point, 1 at the highest. albedo (H, W, 3) linear, 0 to 1. roughness (H, W), 0 to 1.
    domain: "surface" where a shape has two parameters, "solid" where the maps are laid on it from three sides. arrangement:
    "photo" is the photo as it is, mirrored beyond its edges; "endless" puts parts of it at random places side by side.
    """

    record: PhotoRelief
    height: NDArray[np.float32]
    albedo: NDArray[np.float32]
    roughness: NDArray[np.float32]
    domain: Literal["solid", "surface"] = "surface"
    arrangement: Arrangement = "photo"

    mode: Literal["displacement"] = "displacement"
    medium: None = None
    colour: None = None

    @property
    def name(self) -> str:
        """A name for people."""
        return self.record.name

    @property
    def seed(self) -> int:
        """The seed of the random places."""
        return self.record.seed

    @property
    def relief(self) -> ReliefParameters:
        """The amplitude."""
        return self.record.relief

    @property
    def reflectance(self) -> Reflectance:
        """Ka, Kd, Ks and N, and the tint (1, 1, 1): colour is the map's."""
        return self.record.reflectance

    @property
    def provenance(self) -> Provenance | None:
        """Where it came from."""
        return self.record.provenance

    def placed(self, domain: Literal["solid", "surface"], arrangement: Arrangement) -> MappedDetail:
        """Return it for a shape that has two parameters or none, as the photo is or endless."""
        return replace(self, domain=domain, arrangement=arrangement)


AnyDetail = Detail | MappedDetail
"""A detail of either kind: what is rendered, relit and exported."""


def domain_of(detail: AnyDetail) -> Literal["solid", "surface"]:
    """Return the domain in which a surface is to be given to ``detail``."""
    return detail.domain if isinstance(detail, MappedDetail) else detail.noise.domain


def placed(detail: AnyDetail, *, flat: bool) -> AnyDetail:
    """Return ``detail`` for a shape: the photo as it is on a plane, else endless from three sides.

    Two parameters of a shape would tear the maps at its seams and draw them out at its ends.

    A procedural detail is the same everywhere.
    """
    if not isinstance(detail, MappedDetail):
        return detail
    return detail.placed("surface", "photo") if flat else detail.placed("solid", "endless")
