"""The frozen record of a detail: what a fit finds, and all that a rendering of it needs besides a scene."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, Literal

from pydantic import (
    Field,
    ValidationError,
    field_validator,
    model_validator,
)

from voldetail.detail.detail_colour import DetailColour
from voldetail.detail.parameters import PARAMETERS, declared, limits, parameter
from voldetail.detail.provenance import NoiseFloor, Provenance, Record
from voldetail.errors import InputError
from voldetail.records.refusal import refusal

DETAIL_VERSION: Literal[1] = 1
LARGEST_SEED = 2**32 - 1  # the lattice hash takes 32-bit words

PAPER_NEIGHBOURS: tuple[tuple[int, int], ...] = ((1, 50), (1, 2), (2, 2), (2, 3))  # GD10 section 7
ALLOWED_NEIGHBOURS: tuple[tuple[int, int], ...] = ((1, 1), (1, 2), (1, 3), (2, 2), (2, 3), (3, 3), (1, 50))

LUMINANCE_WEIGHTS = (0.2126, 0.7152, 0.0722)  # ITU-R BT.709-6, item 3.2
TINT_TOLERANCE = 1e-3  # rounding in a file is 1e-7; a tint typed with four digits still passes


class NoiseParameters(Record):
    """The cellular-Gabor noise, GD10 equations 2 and 3."""

    domain: Literal["solid", "surface"] = declared("noise.domain")
    first_neighbour: int = declared("noise.first_neighbour")
    last_neighbour: int = declared("noise.last_neighbour")
    joining: Literal["sum", "highest"] = declared("noise.joining")
    facets: float = declared("noise.facets")
    elongation: float = declared("noise.elongation")
    size_spread: float = declared("noise.size_spread")
    weights: tuple[Annotated[float, limits("noise.weights")], ...] = declared("noise.weights")
    envelope: Literal["exponential", "gaussian"] = declared("noise.envelope")
    cell_height: float = declared("noise.cell_height")
    cell_tilt: float = declared("noise.cell_tilt")
    bevel: float = declared("noise.bevel")
    octaves: int = declared("noise.octaves")
    lacunarity: float = declared("noise.lacunarity")
    gain: float = declared("noise.gain")
    stripe_frequency: float = declared("noise.stripe_frequency")
    stripe_spread: float = declared("noise.stripe_spread")
    scale: float = declared("noise.scale")
    anisotropy: float = declared("noise.anisotropy")
    angle: float = declared("noise.angle")
    curve: tuple[Annotated[float, limits("noise.curve")], ...] = declared("noise.curve")

    @property
    def has_plates(self) -> bool:
        """Whether cells have planes of their own: where all points count there are no cells."""
        return self.last_neighbour != 50 and (self.cell_height > 0.0 or self.cell_tilt > 0.0)

    @model_validator(mode="after")
    def _neighbours(self) -> NoiseParameters:
        pair = (self.first_neighbour, self.last_neighbour)
        if pair not in ALLOWED_NEIGHBOURS:
            known = ", ".join(f"{k} and {k2}" for k, k2 in ALLOWED_NEIGHBOURS)
            raise ValueError(
                f"the neighbours {pair[0]} (first) and {pair[1]} (last) are not allowed; use {known}"
            )
        if self.joining == "highest" and pair != (1, 50):
            raise ValueError('joining "highest" takes all points: use the neighbours 1 (first) and 50 (last)')
        return self


class ReliefParameters(Record):
    """The displacement P' = P + A_d R(P) N_P, GD10 section 6."""

    amplitude: float = declared("relief.amplitude")


class Reflectance(Record):
    """The ambient, diffuse and Phong specular coefficients, GD10 section 6."""

    ambient: float = declared("reflectance.ambient")
    diffuse: float = declared("reflectance.diffuse")
    specular: float = declared("reflectance.specular")
    shininess: float = declared("reflectance.shininess")
    height_albedo: float = declared("reflectance.height_albedo")
    cell_albedo: float = declared("reflectance.cell_albedo")
    speckle: float = declared("reflectance.speckle")
    speckle_scale: float = declared("reflectance.speckle_scale")
    tint: tuple[Annotated[float, limits("reflectance.tint")], ...] = declared("reflectance.tint")

    @field_validator("tint")
    @classmethod
    def _luminance_one(cls, tint: tuple[float, ...]) -> tuple[float, ...]:
        luminance = sum(w * c for w, c in zip(LUMINANCE_WEIGHTS, tint, strict=False))
        if abs(luminance - 1) > TINT_TOLERANCE:
            raise ValueError(
                f"the tint's Rec. 709 luminance is {luminance:.4g} where it has to be 1:"
                " divide the three numbers by it"
            )
        return tint


class MediumParameters(Record):
    """A density that light passes through: GD10 section 6 (shell and th = d^d_h), and what it does to light."""

    thickness: float = declared("medium.thickness")
    exponent: float = declared("medium.exponent")
    extinction: float = declared("medium.extinction")
    asymmetry: float = declared("medium.asymmetry")
    albedo: float = declared("medium.albedo")


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
    reflectance: Reflectance = Field(
        default_factory=Reflectance, description="How the surface reflects light."
    )
    medium: MediumParameters | None = Field(
        default=None, description="Of a volume that light passes through; without it a volume is solid."
    )
    colour: DetailColour | None = Field(
        default=None, description="The colour of the surface, where it is more than one tint."
    )
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
            used = [name for name in own if getattr(self.reflectance, name) != 0.0]
            if used:
                raise ValueError(f"a medium has no highlight and no pattern of albedo: set reflectance.{used[0]} to 0")
            if self.colour is not None:
                raise ValueError("a medium has one tint and no colour of its surface: leave colour out")
        return self


def values_of(detail: Detail) -> dict[str, Any]:
    """The detail's parameters by key ("noise.scale" and so on), in the order of their declaration.

    Those of a medium are there where the detail has one.
    """
    found: dict[str, Any] = {}
    for declaration in PARAMETERS:
        group, name = declaration.key.split(".")
        record = getattr(detail, group)
        if record is not None:
            found[declaration.key] = getattr(record, name)
    return found


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
