"""The frozen record of a detail: what a fit finds, and all that a rendering of it needs besides a scene."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Literal

from pydantic import Field, ValidationError, model_validator

from voldetail.detail.detail_colour import DetailColour
from voldetail.detail.parameters import (
    PARAMETERS,
    MediumParameters,
    NoiseParameters,
    Reflectance,
    ReliefParameters,
    parameter,
)
from voldetail.detail.provenance import NoiseFloor, Provenance, Record
from voldetail.errors import InputError
from voldetail.records.refusal import refusal

DETAIL_VERSION: Literal[1] = 1
LARGEST_SEED = 2**32 - 1  # the lattice hash takes 32-bit words


class Detail(Record):
    """A procedural detail: noise, relief and reflectance, with where they came from.

    The relief displaces a surface, or, with ``mode`` "volume", shifts the points of space through an object's density
    (GD10 section 6): the surface of that density is seen, or, where there is a ``medium``, the density itself.
    """

    version: Literal[1] = Field(default=DETAIL_VERSION, description="The version of the file format.")
    mode: Literal["displacement", "volume"] = Field(
        default="displacement",
        description="Whether the relief displaces a surface, or shifts the points of space through an object's density.",
    )
    name: str = Field(default="detail", min_length=1, max_length=200, description="A name for people.")
    seed: int = Field(default=0, ge=0, le=LARGEST_SEED, description="The seed of the feature points.")
    noise: NoiseParameters = Field(default_factory=NoiseParameters, description="The noise.")
    relief: ReliefParameters = Field(default_factory=ReliefParameters, description="The displacement.")
    reflectance: Reflectance = Field(default_factory=Reflectance, description="How the surface reflects light.")
    medium: MediumParameters | None = Field(
        default=None, description="Of a volume that light passes through; without it a volume is solid."
    )
    colour: DetailColour | None = Field(default=None, description="The colour of the surface, where it is more than one tint.")
    provenance: Provenance | None = Field(default=None, description="Where the detail came from.")
    noise_floor: NoiseFloor = Field(default_factory=NoiseFloor, description="Distances that chance alone gives.")

    @model_validator(mode="after")
    def _volume(self) -> Detail:
        if self.mode == "displacement":
            if self.medium is not None:
                raise ValueError('a medium needs the mode "volume"; set it, or leave the medium out')
            return self
        if self.noise.domain != "solid":
            raise ValueError('the mode "volume" needs noise that fills space: set noise.domain to "solid"')
        if self.medium is not None:
            own = ("specular", "height_albedo", "cell_albedo", "speckle")
            unfit = [name for name in own if getattr(self.reflectance, name) != 0.0]
            if unfit:
                raise ValueError(f"a medium has no highlight and no pattern of albedo: set reflectance.{unfit[0]} to 0")
            if self.colour is not None:
                raise ValueError("a medium has one tint and no colour of its surface: leave colour out")
        return self


def values_of(detail: Detail) -> dict[str, Any]:
    """The detail's parameters by key ("noise.scale" and so on), in the order of their declaration.

    Those of a medium are there where the detail has one.
    """
    values: dict[str, Any] = {}
    for declaration in PARAMETERS:
        group, name = declaration.key.split(".")
        record = getattr(detail, group)
        if record is not None:
            values[declaration.key] = getattr(record, name)
    return values


def with_values(detail: Detail, values: Mapping[str, Any]) -> Detail:
    """A copy of `detail` with the parameters in `values` (by key) replaced and everything checked again.

    A number of the medium makes the detail one, whose other numbers are the defaults.
    Raises InputError for an unknown key or a value that is not allowed.
    """
    data = detail.model_dump()
    for key, value in values.items():
        group, name = parameter(key).key.split(".")
        if data[group] is None:
            data["mode"], data[group] = "volume", {}
        data[group][name] = value
    return detail_from(data)


def detail_from(data: Mapping[str, Any], where: str = "The detail") -> Detail:
    """A Detail from nested dictionaries; errors (InputError) start with `where`."""
    try:
        return Detail.model_validate(dict(data))
    except ValidationError as error:
        raise InputError(refusal(error, Detail, where) + ".") from None
