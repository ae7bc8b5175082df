"""Every parameter of a detail, declared once: bounds, defaults, help and file schema all come from here.

Symbols are those of Gilet & Dischler 2010 (GD10), equations 2 and 3 and sections 6 and 7; a medium's sigma_t, g and omega are
those of radiative transfer.
"""

from __future__ import annotations

import difflib
from dataclasses import dataclass
from typing import Any, Literal

from pydantic import Field, JsonValue

from voldetail.errors import InputError

Scale = Literal["linear", "log", "angle", "integer", "choice"]

HALF_TURN = 3.141593  # pi rounded UP to the seven digits of a detail file: a saved pi stays within its bounds
CURVE_POINTS = 11  # GD10 section 7: "we empirically fixed the amount of control points to 11"


@dataclass(frozen=True)
class Parameter:
    """One parameter: key in a detail, symbol in GD10, unit, bounds, default, scale for a search, sentence.

    `count` is the number of values (1 for a scalar); `choices` is filled only where `scale` is "choice".
    `lower` and `upper` bound each value. `later`: it came after the first files; where one leaves it out, the default,
    which changes nothing, is meant.
    """

    key: str
    label: str
    symbol: str
    unit: str
    lower: float
    upper: float
    default: Any
    scale: Scale
    sentence: str
    count: int = 1
    choices: tuple[str, ...] = ()
    later: bool = False

    @property
    def allowed(self) -> str:
        """The allowed values in words, e.g. "0.2 to 400 cells per scene unit"."""
        if self.choices:
            return "one of " + ", ".join(self.choices)
        many = f"{self.count} numbers, each " if self.count > 1 else ""
        whole = "a whole number, " if self.scale == "integer" else ""
        return f"{many}{whole}{self.lower:g} to {self.upper:g}" + (f" {self.unit}" if self.unit else "")


# fmt: off
PARAMETERS: tuple[Parameter, ...] = (
    Parameter("noise.domain", "Domain", "X", "", 0, 1, "solid", "choice",
              "Whether the noise fills 3D space (solid) or lives on the surface's two parameters (surface).",
              choices=("solid", "surface")),
    Parameter("noise.first_neighbour", "First neighbour", "k", "", 1, 50, 1, "integer",
              "The nearest feature point whose kernel counts: 1 for the closest."),
    Parameter("noise.last_neighbour", "Last neighbour", "k'", "", 1, 50, 2, "integer",
              "The farthest feature point whose kernel counts; few neighbours give cells, 50 plain noise."),
    Parameter("noise.joining", "Joining", "J", "", 0, 1, "sum", "choice",
              "How kernels meet: added up (sum, as GD10), or the highest alone (highest: stones lying on each other).",
              choices=("sum", "highest")),
    Parameter("noise.facets", "Facets", "b", "", 0, 1, 0.0, "linear",
              "How angular stones are where the highest counts; 0 is round, 1 has flat faces."),
    Parameter("noise.elongation", "Elongation", "e", "", 1, 4, 1.0, "linear",
              "How much longer than thick stones may be where the highest counts; 1 is as long as thick."),
    Parameter("noise.size_spread", "Size spread", "s_g", "", 0, 0.8, 0.0, "linear",
              "How much smaller than the largest the smallest stone is where the highest counts; 0 makes all alike."),
    Parameter("noise.weights", "Rank weights", "w", "", -1, 1, (1.0, 1.0, 1.0), "linear",
              "The signed weight of the closest, second and third point where it counts; 1, -1 makes separate grains.",
              count=3),
    Parameter("noise.envelope", "Envelope", "e", "", 0, 1, "exponential", "choice",
              "How a kernel falls off: exponential (pointed tops, as GD10 eq. 2) or gaussian (round tops).",
              choices=("exponential", "gaussian")),
    Parameter("noise.cell_height", "Plate height", "o", "", 0, 4, 0.0, "linear",
              "How much higher some cells of the coarsest octave lie than others, in kernel heights; no effect where all count.",
              later=True),
    Parameter("noise.cell_tilt", "Plate tilt", "t", "per cell", 0, 4, 0.0, "linear",
              "How steeply cells of the coarsest octave lean, each its own way; no effect where all points count.",
              later=True),
    Parameter("noise.bevel", "Bevel", "w", "cells", 0.01, 0.5, 0.12, "log",
              "How wide the edge is over which a raised or tilted cell falls to the crack around it.", later=True),
    Parameter("noise.octaves", "Octaves", "n", "", 1, 8, 2, "integer",
              "How many copies of the noise, each finer and fainter than the one before, are added up."),
    Parameter("noise.lacunarity", "Lacunarity", "m", "", 1.2, 4.5, 2.0, "log",
              "How many times finer and fainter each octave is than the one before."),
    Parameter("noise.gain", "Gain", "q", "", 0.02, 2, 1.0, "log",
              "What each octave's strength is multiplied by on top of that: below 1 smoother, above 1 rougher; GD10 has 1."),
    Parameter("noise.stripe_frequency", "Stripe frequency", "phi", "stripes per cell", 0, 8, 0.0, "linear",
              "How many stripes cross one cell; 0 for none."),
    Parameter("noise.stripe_spread", "Stripe spread", "theta", "rad", 0, HALF_TURN, 0.0, "linear",
              "The range of directions that the stripes take; 0 when all run alike."),
    Parameter("noise.scale", "Scale", "s", "cells per scene unit", 0.2, 400, 10.0, "log",
              "How many cells of the coarsest octave fit in one scene unit; larger is finer."),
    Parameter("noise.anisotropy", "Anisotropy", "f", "", 0.1, 10, 1.0, "log",
              "How many times denser the cells are along their own x axis than across it; 1 is round."),
    Parameter("noise.angle", "Angle", "Q", "rad", 0, HALF_TURN, 0.0, "angle",
              "The turn of the cells' x axis in the surface plane, counter-clockwise."),
    Parameter("noise.curve", "Profile", "H", "", 0, 1, tuple(i / 10 for i in range(CURVE_POINTS)), "linear",
              "The height that each noise value from -1 to 1 becomes, at 11 equally spaced points.",
              count=CURVE_POINTS),
    Parameter("relief.amplitude", "Amplitude", "A_d", "scene units", 0, 1, 0.05, "linear",
              "The height of the highest relief above the proxy surface."),
    Parameter("reflectance.ambient", "Ambient", "Ka", "", 0, 1, 0.1, "linear",
              "The share of light that reaches the surface from everywhere and is reflected."),
    Parameter("reflectance.diffuse", "Diffuse", "Kd", "", 0, 1, 0.5, "linear",
              "The share of the light's own beam that is scattered evenly."),
    Parameter("reflectance.specular", "Specular", "Ks", "", 0, 1, 0.0, "linear",
              "The share of the light's own beam that is reflected as a highlight."),
    Parameter("reflectance.shininess", "Shininess", "N", "", 1, 1000, 30.0, "log",
              "The exponent of the Phong highlight: larger is smaller and sharper."),
    Parameter("reflectance.height_albedo", "Albedo with height", "g", "", -1, 1, 0.0, "linear",
              "How albedo goes with the relief: above 0 hollows are darker and tops brighter, below 0 the reverse."),
    Parameter("reflectance.cell_albedo", "Albedo by grain", "v", "", 0, 1, 0.0, "linear",
              "How much grains differ in albedo, each cell of the coarsest octave having its own."),
    Parameter("reflectance.speckle", "Speckle", "k_s", "", 0, 0.9, 0.0, "linear",
              "How strongly fine specks, mineral grains or dust, vary the albedo, whatever the relief."),
    Parameter("reflectance.speckle_scale", "Speckle scale", "s_s", "specks per scene unit", 0.2, 1000, 60.0, "log",
              "How many specks fit in one scene unit; larger is finer."),
    Parameter("reflectance.tint", "Tint", "c", "", 0, 14, (1.0, 1.0, 1.0), "linear",
              "Linear red, green and blue that multiply ambient and diffuse; their Rec. 709 luminance is 1.",
              count=3),
    Parameter("medium.thickness", "Shell thickness", "T", "scene units", 0.005, 4, 0.3, "log",
              "How far below and above its shape a medium goes from full density to none: larger is softer."),
    Parameter("medium.exponent", "Transfer exponent", "d_h", "", 0.1, 12, 1.0, "log",
              "The power to which density is raised: above 1 thinner and more ragged, below 1 fuller."),
    Parameter("medium.extinction", "Extinction", "sigma_t", "per scene unit", 0.05, 2000, 20.0, "log",
              "How much light full density stops: of a beam, all but a 1/e-th part in 1/extinction scene units."),
    Parameter("medium.asymmetry", "Asymmetry", "g", "", -0.9, 0.95, 0.0, "linear",
              "The mean cosine of scattering: 0 is even, towards 1 light goes on forwards as in clouds."),
    Parameter("medium.albedo", "Scattering albedo", "omega", "", 0, 1, 0.99, "linear",
              "The share of the stopped light that is scattered and not swallowed: near 1 for clouds, low for soot."),
)
# fmt: on

BY_KEY: dict[str, Parameter] = {p.key: p for p in PARAMETERS}


def nearest(word: str, known: list[str]) -> str:
    """The clause that ends a refusal of an unknown word: the closest known one, or all of them."""
    close = difflib.get_close_matches(word, known, n=1, cutoff=0.5)
    return f"the nearest one is {close[0]}" if close else "known here: " + ", ".join(known)


def parameter(key: str) -> Parameter:
    """The declaration of `key`, e.g. "noise.scale"; an unknown key raises InputError with the nearest one."""
    if key not in BY_KEY:
        raise InputError(f"There is no parameter {key!r}; {nearest(key, list(BY_KEY))}.")
    return BY_KEY[key]


def bounds(key: str) -> tuple[float, float]:
    """Lower and upper bound of the parameter `key` (of each value, where it has several), in its unit.

    Raises InputError for an unknown key and for a choice, which has none.
    """
    found = parameter(key)
    if found.scale == "choice":
        raise InputError(f"The parameter {key} has no bounds; it is {found.allowed}.")
    return found.lower, found.upper


def help_text(key: str) -> str:
    """One line for a command's help: the sentence, the symbol, what is allowed and the default."""
    found = parameter(key)
    default = "" if found.count > 1 else f"; default {found.default}"
    return f"{found.sentence} ({found.symbol}: {found.allowed}{default})"


def limits(key: str) -> Any:
    """The pydantic constraint on each single value of the parameter `key`."""
    lower, upper = bounds(key)
    return Field(ge=lower, le=upper)


def declared(key: str) -> Any:
    """The pydantic field of the parameter `key`: default, constraint, description, and unit in the schema."""
    found = parameter(key)
    constraint: dict[str, Any] = {}
    if found.count > 1:
        constraint = {"min_length": found.count, "max_length": found.count}
    elif found.scale != "choice":
        constraint = {"ge": found.lower, "le": found.upper}
    unit = found.unit or "none"
    extra: dict[str, JsonValue] = {"unit": unit, "symbol": found.symbol, "allowed": found.allowed}
    return Field(default=found.default, description=found.sentence, json_schema_extra=extra, **constraint)
