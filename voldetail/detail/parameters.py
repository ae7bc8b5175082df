"""Every parameter of a detail, declared once: record, bounds, defaults, help, file schema and the fit's search come from here.

Symbols are those of Gilet & Dischler 2010 (GD10), equations 2 and 3 and sections 6 and 7; a medium's sigma_t, g and omega are
those of radiative transfer. Ranges that are searched are narrower where a fit would else leave nature: wide pigment paints flat
ground instead of raising it (tuned on gravel and grass), long or unequal stones leave ground between them, and a wide bevel
leaves no plate between cracks (tuned by eye on mud, slate, bark and gravel).
"""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import BaseModel, field_validator, model_validator

from voldetail.detail.declaration import Cover, Parameter, declarations, declare, field_of, within
from voldetail.detail.provenance import Record
from voldetail.errors import InputError
from voldetail.records.nearest import nearest

HALF_TURN = 3.141593  # pi rounded UP to the seven digits of a detail file: a saved pi stays within its bounds
CURVE_POINTS = 11  # GD10 section 7: "we empirically fixed the amount of control points to 11"
STRAIGHT = tuple(i / 10 for i in range(CURVE_POINTS))

PAPER_NEIGHBOURS: tuple[tuple[int, int], ...] = ((1, 50), (1, 2), (2, 2), (2, 3))  # GD10 section 7
ALLOWED_NEIGHBOURS: tuple[tuple[int, int], ...] = ((1, 1), (1, 2), (1, 3), (2, 2), (2, 3), (3, 3), (1, 50))

LUMINANCE_WEIGHTS = (0.2126, 0.7152, 0.0722)  # ITU-R BT.709-6, item 3.2
TINT_TOLERANCE = 1e-3  # rounding in a file is 1e-7; a tint typed with four digits still passes


# fmt: off
class NoiseParameters(Record):
    """The cellular-Gabor noise, GD10 equations 2 and 3."""

    domain: Literal["solid", "surface"] = declare("Domain", "X", "", 0, 1, "solid", "choice",
        "Whether the noise fills 3D space (solid) or lives on the surface's two parameters (surface).",
        choices=("solid", "surface"))
    first_neighbour: int = declare("First neighbour", "k", "", 1, 50, 1, "integer",
        "The nearest feature point whose kernel counts: 1 for the closest.")
    last_neighbour: int = declare("Last neighbour", "k'", "", 1, 50, 2, "integer",
        "The farthest feature point whose kernel counts; few neighbours give cells, 50 plain noise.")
    joining: Literal["sum", "highest"] = declare("Joining", "J", "", 0, 1, "sum", "choice",
        "How kernels meet: added up (sum, as GD10), or the highest alone (highest: stones lying on each other).",
        choices=("sum", "highest"))
    facets: float = declare("Facets", "b", "", 0, 1, 0.0, "linear",
        "How angular stones are where the highest counts; 0 is round, 1 has flat faces.",
        part="stones", cover=Cover(11, 0.0, span=1.0))
    elongation: float = declare("Elongation", "e", "", 1, 4, 1.0, "linear",
        "How much longer than thick stones may be where the highest counts; 1 is as long as thick.",
        part="stones", searched=(1.0, 2.2), cover=Cover(12, 1.0, span=2.0))
    size_spread: float = declare("Size spread", "s_g", "", 0, 0.8, 0.0, "linear",
        "How much smaller than the largest the smallest stone is where the highest counts; 0 makes all alike.",
        part="stones", searched=(0.0, 0.55), cover=Cover(13, 0.0, span=0.7))
    weights: tuple[Annotated[float, within(-1, 1)], ...] = declare("Rank weights", "w", "", -1, 1, (1.0, 1.0, 1.0), "linear",
        "The signed weight of the closest, second and third point where it counts; 1, -1 makes separate grains.", count=3)
    envelope: Literal["exponential", "gaussian"] = declare("Envelope", "e", "", 0, 1, "exponential", "choice",
        "How a kernel falls off: exponential (pointed tops, as GD10 eq. 2) or gaussian (round tops).",
        choices=("exponential", "gaussian"))
    cell_height: float = declare("Plate height", "o", "", 0, 4, 0.0, "linear",
        "How much higher some cells of the coarsest octave lie than others, in kernel heights; no effect where all count.",
        later=True, part="plates", searched=(0.0, 4.0), cover=Cover(11, 0.0, span=4.0))
    cell_tilt: float = declare("Plate tilt", "t", "per cell", 0, 4, 0.0, "linear",
        "How steeply cells of the coarsest octave lean, each its own way; no effect where all points count.", later=True,
        part="plates", searched=(0.0, 4.0), cover=Cover(12, 0.0, span=4.0))
    bevel: float = declare("Bevel", "w", "cells", 0.01, 0.5, 0.12, "log",
        "How wide the edge is over which a raised or tilted cell falls to the crack around it.", later=True,
        part="plates", searched=(0.04, 0.35), cover=Cover(13, 0.05, factor=6.0))
    octaves: int = declare("Octaves", "n", "", 1, 8, 2, "integer",
        "How many copies of the noise, each finer and fainter than the one before, are added up.")
    lacunarity: float = declare("Lacunarity", "m", "", 1.2, 4.5, 2.0, "log",
        "How many times finer and fainter each octave is than the one before.", part="octaves", cover=Cover(4, 1.5, span=1.5))
    gain: float = declare("Gain", "q", "", 0.02, 2, 1.0, "log",
        "What each octave's strength is multiplied by on top of that: below 1 smoother, above 1 rougher; GD10 has 1.",
        part="octaves", searched=(0.05, 1.5))
    stripe_frequency: float = declare("Stripe frequency", "phi", "stripes per cell", 0, 8, 0.0, "linear",
        "How many stripes cross one cell; 0 for none.", part="stripes", cover=Cover(5, 0.5, factor=6.0))
    stripe_spread: float = declare("Stripe spread", "theta", "rad", 0, HALF_TURN, 0.0, "linear",
        "The range of directions that the stripes take; 0 when all run alike.", part="stripes")
    scale: float = declare("Scale", "s", "cells per scene unit", 0.2, 400, 10.0, "log",
        "How many cells of the coarsest octave fit in one scene unit; larger is finer.")
    anisotropy: float = declare("Anisotropy", "f", "", 0.1, 10, 1.0, "log",
        "How many times denser the cells are along their own x axis than across it; 1 is round.")
    angle: float = declare("Angle", "Q", "rad", 0, HALF_TURN, 0.0, "angle",
        "The turn of the cells' x axis in the surface plane, counter-clockwise.")
    curve: tuple[Annotated[float, within(0, 1)], ...] = declare("Profile", "H", "", 0, 1, STRAIGHT, "linear",
        "The height that each noise value from -1 to 1 becomes, at 11 equally spaced points.", count=CURVE_POINTS)

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

    amplitude: float = declare("Amplitude", "A_d", "scene units", 0, 1, 0.05, "linear",
        "The height of the highest relief above the proxy surface.")


class Reflectance(Record):
    """The ambient, diffuse and Phong specular coefficients, GD10 section 6."""

    ambient: float = declare("Ambient", "Ka", "", 0, 1, 0.1, "linear",
        "The share of light that reaches the surface from everywhere and is reflected.")
    diffuse: float = declare("Diffuse", "Kd", "", 0, 1, 0.5, "linear",
        "The share of the light's own beam that is scattered evenly.")
    specular: float = declare("Specular", "Ks", "", 0, 1, 0.0, "linear",
        "The share of the light's own beam that is reflected as a highlight.")
    shininess: float = declare("Shininess", "N", "", 1, 1000, 30.0, "log",
        "The exponent of the Phong highlight: larger is smaller and sharper.")
    height_albedo: float = declare("Albedo with height", "g", "", -1, 1, 0.0, "linear",
        "How albedo goes with the relief: above 0 hollows are darker and tops brighter, below 0 the reverse.",
        part="pigment", searched=(-0.1, 0.35), cover=Cover(6, 0.0, span=0.3))
    cell_albedo: float = declare("Albedo by grain", "v", "", 0, 1, 0.0, "linear",
        "How much grains differ in albedo, each cell of the coarsest octave having its own.",
        part="pigment", searched=(0.0, 0.35), cover=Cover(7, 0.0, span=0.4))
    speckle: float = declare("Speckle", "k_s", "", 0, 0.9, 0.0, "linear",
        "How strongly fine specks, mineral grains or dust, vary the albedo, whatever the relief.",
        part="pigment", searched=(0.0, 0.5), cover=Cover(13, 0.0, span=0.4))
    speckle_scale: float = declare("Speckle scale", "s_s", "specks per scene unit", 0.2, 1000, 60.0, "log",
        "How many specks fit in one scene unit; larger is finer.", part="pigment")
    tint: tuple[Annotated[float, within(0, 14)], ...] = declare("Tint", "c", "", 0, 14, (1.0, 1.0, 1.0), "linear",
        "Linear red, green and blue that multiply ambient and diffuse; their Rec. 709 luminance is 1.", count=3)

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

    thickness: float = declare("Shell thickness", "T", "scene units", 0.005, 4, 0.3, "log",
        "How far below and above its shape a medium goes from full density to none: larger is softer.")
    exponent: float = declare("Transfer exponent", "d_h", "", 0.1, 12, 1.0, "log",
        "The power to which density is raised: above 1 thinner and more ragged, below 1 fuller.", searched=(0.7, 8.0))
    extinction: float = declare("Extinction", "sigma_t", "per scene unit", 0.05, 2000, 20.0, "log",
        "How much light full density stops: of a beam, all but a 1/e-th part in 1/extinction scene units.")
    asymmetry: float = declare("Asymmetry", "g", "", -0.9, 0.95, 0.0, "linear",
        "The mean cosine of scattering: 0 is even, towards 1 light goes on forwards as in clouds.", searched=(0.0, 0.9))
    albedo: float = declare("Scattering albedo", "omega", "", 0, 1, 0.99, "linear",
        "The share of the stopped light that is scattered and not swallowed: near 1 for clouds, low for soot.")
# fmt: on


GROUPS: dict[str, type[BaseModel]] = {
    "noise": NoiseParameters, "relief": ReliefParameters, "reflectance": Reflectance, "medium": MediumParameters,
}  # fmt: skip

PARAMETERS: tuple[Parameter, ...] = tuple(p for group, record in GROUPS.items() for p in declarations(group, record))

BY_KEY: dict[str, Parameter] = {p.key: p for p in PARAMETERS}


def parameter(key: str) -> Parameter:
    """The declaration of `key`, e.g. "noise.scale"; an unknown key raises InputError with the nearest one."""
    if key not in BY_KEY:
        raise InputError(f"There is no parameter {key!r}; {nearest(key, list(BY_KEY))}.")
    return BY_KEY[key]


def parameters_of(part: str, group: str = "") -> tuple[Parameter, ...]:
    """The parameters that belong to a part of the noise, or of the albedo, in the order of their declaration."""
    return tuple(p for p in PARAMETERS if p.part == part and p.key.startswith(group))


def bounds(key: str) -> tuple[float, float]:
    """Lower and upper bound of the parameter `key` (of each value, where it has several), in its unit.

    Raises InputError for an unknown key and for a choice, which has none.
    """
    declaration = parameter(key)
    if declaration.scale == "choice":
        raise InputError(f"The parameter {key} has no bounds; it is {declaration.allowed}.")
    return declaration.lower, declaration.upper


def declared(key: str) -> Any:
    """The pydantic field of the parameter `key`, for a record that has it too."""
    return field_of(parameter(key))
