"""The record of a structure model: a procedural map s_a of GKHF14 equations 3 and 4, with its parameters' ranges.

    s_a : R^2 -> [0, 1],      a in [a_min, a_max]

(Gieseke, Koch, Hahn & Fuchs, "Interactive Parameter Retrieval for Two-Tone Procedural Textures", 2014.) Lengths are in
texels. The paper names its models and counts their parameters, but describes neither: those are chosen here and said in
each model's docstring. The stops of a grid multiply to the numbers of entries in the paper's Table 2.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Literal

from voldetail.errors import InputError

Values = Mapping[str, float]


@dataclass(frozen=True)
class StructureParameter:
    """One parameter: key, range, default, how it is spread over the range, stops of a grid, a sentence.

    spread: "linear", "log" (equal ratios, for lengths) or "integer". stops: places on a grid, both ends among them.
    """

    key: str
    lower: float
    upper: float
    default: float
    spread: Literal["linear", "log", "integer"]
    stops: int
    sentence: str

    def at(self, share: float) -> float:
        """Return the value at ``share`` (0 to 1) of the range; integers have equal parts of it."""
        if self.spread == "integer":
            return float(min(int(self.lower + share * (self.upper - self.lower + 1)), self.upper))
        if self.spread == "log":
            value = self.lower * (self.upper / self.lower) ** share
        else:
            value = self.lower + share * (self.upper - self.lower)
        return float(min(max(value, self.lower), self.upper))

    def stop(self, index: int) -> float:
        """Return the value of a grid's stop, 0 to stops - 1."""
        if self.spread == "integer":
            return self.lower + float(round(index * (self.upper - self.lower) / max(self.stops - 1, 1)))
        return self.at(index / max(self.stops - 1, 1))


@dataclass(frozen=True)
class StructureModel:
    """A model: its name, parameters, sentence and evaluation.

    evaluate(x, y, values, seed) takes float32 arrays of positions in texels (y up), all of the values and a seed (an
    integer), and returns an array of structure from 0 to 1. group: the paper's class of texture.
    """

    name: str
    group: Literal["noise", "grid", "tiled", "wood", "rings", "shapes"]
    parameters: tuple[StructureParameter, ...]
    sentence: str
    evaluate: Callable[[Any, Any, Values, int], Any]

    @property
    def grid_size(self) -> int:
        """How many entries a grid over all stops has."""
        count = 1
        for parameter in self.parameters:
            count *= parameter.stops
        return count

    def checked(self, values: Values) -> dict[str, float]:
        """Return all values, in the parameters' order, defaults where ``values`` has none.

        Raises InputError for an unknown key and for a value that is outside its range or not whole where it must be.
        """
        known = [p.key for p in self.parameters]
        for key in values:
            if key not in known:
                raise InputError(f"The model {self.name} has no parameter {key!r}; it has {', '.join(known)}.")
        within = {}
        for parameter in self.parameters:
            value = float(values.get(parameter.key, parameter.default))
            whole = parameter.spread != "integer" or value == int(value)
            if not (parameter.lower <= value <= parameter.upper and whole):
                kind = "a whole number, " if parameter.spread == "integer" else ""
                raise InputError(
                    f"{self.name}: {parameter.key} is {value:g}; {kind}{parameter.lower:g} to {parameter.upper:g} is allowed."
                )
            within[parameter.key] = value
        return within
