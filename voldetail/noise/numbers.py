"""Numbers of one part of the noise, by the names that a detail has for them: a field more is a number more."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, fields
from typing import Any, Self


@dataclass(frozen=True)
class Numbers:
    """Base of the records of numbers, floats or float arrays of width 1."""

    @classmethod
    def of(cls, parameters: Any, number: Callable[[float], Any] = lambda value: value) -> Self:
        """Return those of ``parameters``, an object with an attribute for each, as ``number`` makes arrays of them."""
        return cls(**{field.name: number(getattr(parameters, field.name)) for field in fields(cls)})

    @property
    def numbers(self) -> tuple[Any, ...]:
        """All, in order."""
        return tuple(getattr(self, field.name) for field in fields(self))
