"""The space that is searched: a few choices, and numbers in a box.

A Kind holds what is discrete. The numbers of a Kind are mapped to [0, 1] each, on the scale that the parameter's
declaration names, so a solver needs to know nothing about details.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from voldetail.detail import (
    Detail,
    MediumParameters,
    NoiseParameters,
    Reflectance,
    ReliefParameters,
    bounds,
    parameter,
    parameters_of,
)
from voldetail.fit.profiles import SHAPE_COUNT, fold, profile
from voldetail.fit.ranges import (
    BORDERED_PENALTY,
    DEPTH,
    FINEST_SPECKS,
    FOLD_PENALTY,
    LOGARITHMIC,
    OF_PLATES,
    OF_STONES,
    PIGMENT_PENALTY,
    PLAIN_NAME,
    PLATE_DUST,
    PLATE_GAIN,
    PLATES_PENALTY,
    ROUGHNESS,
    SHAPE_RANGE,
    SOFTNESS,
    STONE_GAIN,
    STONE_HEIGHT,
    STONE_STRETCH,
    STONES_PENALTY,
    STRIPED_CELLS_PENALTY,
)
from voldetail.render.volume import CELL_DEPTH, thinnest_edge
from voldetail.types import Vector

BORDERED = (1.0, -1.0, 1.0)
"""Weights of the closest points by which the noise is F2 - F1: zero on the borders of cells."""

PAPER_OCTAVES = ("noise.lacunarity",)
"""What GD10's octaves have; the gain is ours."""

MEDIUM_NAMES = ("softness", "medium.exponent", "depth", "medium.asymmetry")


@dataclass(frozen=True)
class Kind:
    """What is discrete: ranks of feature points, envelope, octaves, whether there are stripes, how H is folded.

    bordered: the second point counts against the first (F2 - F1), so that the noise vanishes on the border of cells. stones: the
    highest kernel alone counts, each a body of its own shape. plates: cells have planes of their own. pigment: albedo
    varies with height, from cell to cell and by specks. fold: "none" keeps H monotone; "ridge" is 1 - |2H - 1| of a
    monotone H, "billow" |2H - 1|.
    """

    first: int
    last: int
    envelope: str
    octaves: int
    striped: bool
    fold: str = "none"
    bordered: bool = False
    pigment: bool = False
    stones: bool = False
    plates: bool = False

    @property
    def penalty(self) -> float:
        """Factor on the distance by which what goes beyond GD10, or seldom looks like nature, has to pay for itself."""
        return math.prod(
            factor
            for applies, factor in (
                (self.fold != "none", FOLD_PENALTY),
                (self.striped and (self.first, self.last) != (1, 50), STRIPED_CELLS_PENALTY),
                (self.stones, STONES_PENALTY),
                (self.pigment, PIGMENT_PENALTY),
                (self.bordered, BORDERED_PENALTY),
                (self.plates, PLATES_PENALTY),
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
            out += PAPER_OCTAVES if self.plain else _keys("octaves")
        for part, there in (("stones", kind.stones), ("plates", kind.plates), ("stripes", kind.striped)):
            out += _keys(part) if there else []
        out += MEDIUM_NAMES if self.medium else ()
        out += _keys("pigment") if kind.pigment else []
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
            "noise.scale": self.scale,
            "roughness": self.roughness,
            "stone_height": STONE_HEIGHT,
            "stone_stretch": STONE_STRETCH,
            "stone_profile": (0.0, SHAPE_RANGE),
            "stone_gain": STONE_GAIN,
            "plate_gain": PLATE_GAIN,
            "plate_dust": PLATE_DUST,
            "noise.anisotropy": self.anisotropy,
            "noise.stripe_frequency": self.stripes,
            "reflectance.speckle_scale": (specks / FINEST_SPECKS, specks),
            "softness": SOFTNESS,
            "depth": DEPTH,
        }.get(name)
        low, high = own or parameter(name).searched or bounds(name)
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
        resolvable = 1 + int(max(0.0, math.log(self.finest / values["noise.scale"]) / math.log(lacunarity)))
        noise = NoiseParameters(
            domain=self.domain,  # type: ignore[arg-type]
            first_neighbour=kind.first,
            last_neighbour=kind.last,
            envelope=kind.envelope,  # type: ignore[arg-type]
            weights=BORDERED if kind.bordered else (1.0, 1.0, 1.0),
            joining="highest" if kind.stones else "sum",
            octaves=min(kind.octaves, resolvable),
            curve=tuple(float(v) for v in fold(profile(shape), kind.fold)),
            **_of_group(values, "noise"),
        )
        amplitude = self.amplitude
        if amplitude is None:
            amplitude = min(values["roughness"] / values["noise.scale"], self.highest)
        return Detail(
            mode=self.mode,
            noise=noise,
            relief=ReliefParameters(amplitude=amplitude),
            reflectance=Reflectance().model_copy(update=_of_group(values, "reflectance")),
            medium=self._medium(values, amplitude) if self.medium else None,
        )

    def _medium(self, values: dict[str, float], amplitude: float) -> MediumParameters:
        # What changes faster than the grid's cells would not be seen as it is.
        thickness = max(values["softness"] * amplitude, thinnest_edge(self.cell, values["medium.exponent"]))
        extinction = min(values["depth"] / amplitude, CELL_DEPTH / self.cell if self.cell else math.inf)
        return MediumParameters(
            thickness=float(np.clip(thickness, *bounds("medium.thickness"))),
            exponent=values["medium.exponent"],
            extinction=float(np.clip(extinction, *bounds("medium.extinction"))),
            asymmetry=values["medium.asymmetry"],
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


def _keys(part: str) -> list[str]:
    """The numbers that are searched where the noise has a part."""
    return [p.key for p in parameters_of(part)]


def _of_group(values: dict[str, float], group: str) -> dict[str, Any]:
    """The numbers of one group of a detail, by their names there."""
    return {name.removeprefix(f"{group}."): value for name, value in values.items() if name.startswith(f"{group}.")}
