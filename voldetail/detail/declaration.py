"""How a parameter is declared: one field of a record, from which its bounds, help, schema and search follow."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, Literal

from pydantic import BaseModel, Field, JsonValue
from pydantic.fields import FieldInfo

Scale = Literal["linear", "log", "angle", "integer", "choice"]

Part = Literal["", "octaves", "stones", "plates", "stripes", "pigment"]
"""What a number belongs to: a fit searches it where the noise has that part; "" is searched always, or has rules of its own."""


@dataclass(frozen=True)
class Cover:
    """The values that the samples take which cover a fit's space: along one dimension of their sequence, u in [0, 1).

    Evenly from ``start`` over ``span``; where ``factor`` is given instead, evenly on a logarithmic scale up to start factor.
    """

    dimension: int
    start: float
    span: float = 0.0
    factor: float | None = None

    def at(self, u: float) -> float:
        """Return the value at ``u``."""
        return self.start + self.span * u if self.factor is None else self.start * self.factor**u


@dataclass(frozen=True)
class Parameter:
    """One parameter: key in a detail, symbol in GD10, unit, bounds, default, scale for a search, sentence.

    `count` is the number of values (1 for a scalar); `choices` is filled only where `scale` is "choice".
    `lower` and `upper` bound each value. `later`: it came after the first files; where one leaves it out, the default,
    which changes nothing, is meant. `part`: of the noise or the albedo, without which it has no effect. `searched`: the range
    that a fit searches, where narrower. `cover`: the first samples of a fit; without it, the middle of the range.
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
    part: Part = ""
    searched: tuple[float, float] | None = None
    cover: Cover | None = None

    @property
    def name(self) -> str:
        """The key without its group."""
        return self.key.rpartition(".")[2]

    @property
    def allowed(self) -> str:
        """The allowed values in words, e.g. "0.2 to 400 cells per scene unit"."""
        if self.choices:
            return "one of " + ", ".join(self.choices)
        many = f"{self.count} numbers, each " if self.count > 1 else ""
        whole = "a whole number, " if self.scale == "integer" else ""
        return f"{many}{whole}{self.lower:g} to {self.upper:g}" + (f" {self.unit}" if self.unit else "")


def declare(
    label: str, symbol: str, unit: str, lower: float, upper: float, default: Any, scale: Scale, sentence: str, **rest: Any
) -> Any:
    """Return the pydantic field of a parameter, which carries its `Parameter`; ``rest`` are that one's last fields."""
    return field_of(Parameter("", label, symbol, unit, lower, upper, default, scale, sentence, **rest))


def within(lower: float, upper: float) -> Any:
    """The pydantic constraint on each single value of a parameter that has several."""
    return Field(ge=lower, le=upper)


def field_of(declaration: Parameter) -> Any:
    """The pydantic field of a declaration: default, constraint, description, and unit in the schema."""
    constraint: dict[str, Any] = {}
    if declaration.count > 1:
        constraint = {"min_length": declaration.count, "max_length": declaration.count}
    elif declaration.scale != "choice":
        constraint = {"ge": declaration.lower, "le": declaration.upper}
    extra: dict[str, JsonValue] = {
        "unit": declaration.unit or "none", "symbol": declaration.symbol, "allowed": declaration.allowed,
    }  # fmt: skip
    field: FieldInfo = Field(default=declaration.default, description=declaration.sentence, json_schema_extra=extra, **constraint)
    field.metadata.append(declaration)
    return field


def declarations(group: str, record: type[BaseModel]) -> tuple[Parameter, ...]:
    """Return the parameters that the fields of ``record`` declare, in order, with their keys in ``group``."""
    return tuple(
        replace(declaration, key=f"{group}.{name}")
        for name, field in record.model_fields.items() for declaration in field.metadata if isinstance(declaration, Parameter)
    )  # fmt: skip
