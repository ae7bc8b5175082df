"""The space that is searched: a few choices, and numbers in a box.

A Kind holds what is discrete. The numbers of a Kind are mapped to [0, 1] each, on the scale that the parameter's
declaration names, so a solver needs to know nothing about details.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from voldetail.detail import Detail, bounds, parameter
from voldetail.detail.record import MediumParameters, NoiseParameters, Reflectance, ReliefParameters
from voldetail.fit.profiles import SHAPE_COUNT, fold, profile
from voldetail.fit.ranges import (
    ASYMMETRY,
    CELL_ALBEDO,
    DEPTH,
    ELONGATION,
    EXPONENT,
    FINEST_SPECKS,
    FOLD_HANDICAP,
    GAIN,
    GRAINS_HANDICAP,
    HEIGHT_ALBEDO,
    LOGARITHMIC,
    OF_PLATES,
    OF_STONES,
    PIGMENT_HANDICAP,
    PLAIN_NAME,
    PLATE_BEVEL,
    PLATE_DUST,
    PLATE_GAIN,
    PLATE_HEIGHT,
    PLATE_TILT,
    PLATES_HANDICAP,
    ROUGHNESS,
    SHAPE_RANGE,
    SIZE_SPREAD,
    SOFTNESS,
    SPECKLE,
    STONE_GAIN,
    STONE_HEIGHT,
    STONE_STRETCH,
    STONES_HANDICAP,
    STRIPED_CELLS_HANDICAP,
)
from voldetail.render.volume import CELL_DEPTH, thinnest_edge

Vector = NDArray[np.float64]

GRAINS = (1.0, -1.0, 1.0)

PIGMENT = ("height_albedo", "cell_albedo", "speckle", "speckle_scale")

MEDIUM_NAMES = ("softness", "medium.exponent", "depth", "medium.asymmetry")



@dataclass(frozen=True)
class Kind:
    """What is discrete: ranks of feature points, envelope, octaves, whether there are stripes, how H is folded.

    grains: the second point counts against the first, so that the noise vanishes on the border of cells. stones: the
    highest kernel alone counts, each a body of its own shape. plates: cells have planes of their own. pigment: albedo
    varies with height, from grain to grain and by specks. fold: "none" keeps H monotone; "ridge" is 1 - |2H - 1| of a
    monotone H, "billow" |2H - 1|.
    """

    first: int
    last: int
    envelope: str
    octaves: int
    striped: bool
    fold: str = "none"
    grains: bool = False
    pigment: bool = False
    stones: bool = False
    plates: bool = False

    @property
    def handicap(self) -> float:
        """Factor on the distance by which what goes beyond GD10, or seldom looks like nature, has to pay for itself."""
        return math.prod(
            factor
            for applies, factor in (
                (self.fold != "none", FOLD_HANDICAP),
                (self.striped and (self.first, self.last) != (1, 50), STRIPED_CELLS_HANDICAP),
                (self.stones, STONES_HANDICAP), (self.pigment, PIGMENT_HANDICAP),
                (self.grains, GRAINS_HANDICAP), (self.plates, PLATES_HANDICAP),
            )
            if applies
        )


@dataclass(frozen=True)
class Space:
    """Bounds of the numbers for a photo, and the mapping to details.

    domain: of the noise. scale: bounds of the cells per scene unit that the picture can show. finest: cells per scene
    unit above which an octave would be finer than the pixels. amplitude: the user's, or None if it is searched.
    anisotropy, roughness, stripes: bounds; roughness is the amplitude in cells, A_d s, which is better conditioned than
    A_d: the slopes of the relief, and so its shading, go with it. plain: GD10's own numbers only. mode, medium: of the
    details. highest: the largest amplitude. cell: edge of the grid's, 0 without one. A medium's lengths are searched in
    amplitudes (softness T / A_d, depth
    sigma_t A_d), for the same reason.
    """

    domain: str
    scale: tuple[float, float]
    finest: float
    amplitude: float | None = None
    roughness: tuple[float, float] = ROUGHNESS
    anisotropy: tuple[float, float] = (0.2, 5.0)
    stripes: tuple[float, float] = (0.2, 4.0)
    plain: bool = False
    mode: Literal["displacement", "volume"] = "displacement"
    medium: bool = False
    highest: float = bounds("relief.amplitude")[1]
    cell: float = 0.0

    @property
    def pigmented(self) -> bool:
        """Whether albedo may vary: the grid of a volume knows of density alone."""
        return self.mode == "displacement" and not self.plain

    def names(self, kind: Kind) -> list[str]:
        """Return the names of the numbers of ``kind``, in order."""
        out = ["noise.scale", "noise.anisotropy", "noise.angle"]
        if self.amplitude is None:
            out.append("roughness")
        if kind.octaves > 1:
            out += ["noise.lacunarity"] if self.plain else ["noise.lacunarity", "noise.gain"]
        if kind.stones:
            out += ["noise.facets", "noise.elongation", "noise.size_spread"]
        if kind.plates:
            out += ["noise.cell_height", "noise.cell_tilt", "noise.bevel"]
        if kind.striped:
            out += ["noise.stripe_frequency", "noise.stripe_spread"]
        if self.medium:
            out += MEDIUM_NAMES
        if kind.pigment:
            out += [f"reflectance.{name}" for name in PIGMENT]
        if kind.stones:
            return [OF_STONES.get(name, name) for name in (*out, "shape.0")]
        if kind.plates:
            out = [OF_PLATES.get(name, name) for name in out]
        return out + [f"shape.{i}" for i in range(SHAPE_COUNT)]

    def range_of(self, name: str) -> tuple[float, float, bool]:
        """Return (lower, upper, logarithmic) of a number."""
        if name.startswith("shape."):
            return -SHAPE_RANGE, SHAPE_RANGE, False
        specks = min(self.finest, bounds("reflectance.speckle_scale")[1])
        own = {
            "noise.scale": self.scale, "roughness": self.roughness, "stone_height": STONE_HEIGHT,
            "stone_stretch": STONE_STRETCH,
            "stone_profile": (0.0, SHAPE_RANGE), "noise.gain": GAIN, "stone_gain": STONE_GAIN,
            "plate_gain": PLATE_GAIN, "plate_dust": PLATE_DUST,
            "noise.cell_height": PLATE_HEIGHT, "noise.cell_tilt": PLATE_TILT, "noise.bevel": PLATE_BEVEL,
            "noise.elongation": ELONGATION, "noise.size_spread": SIZE_SPREAD, "noise.anisotropy": self.anisotropy,
            "noise.stripe_frequency": self.stripes, "reflectance.height_albedo": HEIGHT_ALBEDO,
            "reflectance.cell_albedo": CELL_ALBEDO, "reflectance.speckle": SPECKLE,
            "reflectance.speckle_scale": (specks / FINEST_SPECKS, specks),
            "softness": SOFTNESS, "depth": DEPTH, "medium.exponent": EXPONENT, "medium.asymmetry": ASYMMETRY,
        }.get(name)
        low, high = own or bounds(name)
        return low, high, name in LOGARITHMIC or (name.startswith("noise.") and parameter(name).scale == "log")

    def at(self, name: str, unit: float) -> float:
        """Return the value of a number at ``unit``, 0 to 1, of its range."""
        low, high, log = self.range_of(name)
        return low * (high / low) ** unit if log else low + unit * (high - low)

    def decode(self, kind: Kind, vector: Vector) -> Detail:
        """Return the Detail at ``vector`` (each number in [0, 1]; angles wrap, the rest is clipped)."""
        values: dict[str, float] = {}
        for name, unit in zip(self.names(kind), vector, strict=True):
            unit = unit % 1.0 if name == "noise.angle" else min(max(float(unit), 0.0), 1.0)
            values[PLAIN_NAME.get(name, name)] = self.at(name, unit)
        shape = np.array([values.get(f"shape.{i}", 0.0) for i in range(SHAPE_COUNT)])
        lacunarity = values.get("noise.lacunarity", parameter("noise.lacunarity").default)
        shown = 1 + int(max(0.0, math.log(self.finest / values["noise.scale"]) / math.log(lacunarity)))
        noise = NoiseParameters(
            domain=self.domain, first_neighbour=kind.first, last_neighbour=kind.last, envelope=kind.envelope,  # type: ignore[arg-type]
            weights=GRAINS if kind.grains else (1.0, 1.0, 1.0), joining="highest" if kind.stones else "sum",
            facets=values.get("noise.facets", 0.0), elongation=values.get("noise.elongation", 1.0),
            size_spread=values.get("noise.size_spread", 0.0), octaves=min(kind.octaves, shown), lacunarity=lacunarity,
            cell_height=values.get("noise.cell_height", 0.0), cell_tilt=values.get("noise.cell_tilt", 0.0),
            bevel=values.get("noise.bevel", parameter("noise.bevel").default),
            gain=values.get("noise.gain", 1.0), stripe_frequency=values.get("noise.stripe_frequency", 0.0),
            stripe_spread=values.get("noise.stripe_spread", 0.0),
            scale=values["noise.scale"], anisotropy=values["noise.anisotropy"], angle=values["noise.angle"],
            curve=tuple(float(v) for v in fold(profile(shape), kind.fold)),
        )
        amplitude = self.amplitude
        if amplitude is None:
            amplitude = min(values["roughness"] / values["noise.scale"], self.highest)
        pigment = Reflectance()
        if kind.pigment:
            pigment = pigment.model_copy(update={name: values[f"reflectance.{name}"] for name in PIGMENT})
        medium = None
        if self.medium:
            # What changes faster than the grid's cells would not be seen as it is.
            thickness = max(values["softness"] * amplitude, thinnest_edge(self.cell, values["medium.exponent"]))
            extinction = min(values["depth"] / amplitude, CELL_DEPTH / self.cell if self.cell else math.inf)
            medium = MediumParameters(
                thickness=float(np.clip(thickness, *bounds("medium.thickness"))), exponent=values["medium.exponent"],
                extinction=float(np.clip(extinction, *bounds("medium.extinction"))), asymmetry=values["medium.asymmetry"],
            )
        return Detail(
            mode=self.mode, noise=noise, relief=ReliefParameters(amplitude=amplitude), reflectance=pigment, medium=medium
        )

    def encode(self, kind: Kind, values: dict[str, float]) -> Vector:
        """Return the vector with the given numbers; those that are missing are in the middle."""
        out = []
        for name in self.names(kind):
            low, high, log = self.range_of(name)
            if name not in values:
                out.append(0.5)
                continue
            value = min(max(values[name], low), high)
            out.append(math.log(value / low) / math.log(high / low) if log else (value - low) / (high - low))
        return np.array(out)
