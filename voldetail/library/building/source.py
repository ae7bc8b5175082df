"""What a library is made of: sources of entries, each a numbered row of values and descriptors.

A source is asked for chunks of its rows, in any order and by any process, and gives the same row for the same number each time:
a library can then be built in parts, by many, and again.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from voldetail.errors import InputError
from voldetail.library.entries import ENTRIES_VERSION, SIDE, Sampling, entries
from voldetail.library.measures import MeasureName
from voldetail.library.vectors import COMPLETE_SIDE
from voldetail.texture.structures import StructureModel

Chunk = tuple[NDArray[np.float64], NDArray[np.floating]]
"""Values (count, numbers) and descriptors (count, length of the measure)."""


class Source(Protocol):
    """Where entries of one kind come from; picklable, since it goes to the processes that compute.

    name: of the source in its library, small letters, digits, spaces, - and _. keys: names of an entry's numbers. seed: of the
    noise in its pictures. measure: what its pictures are described with, see `measures`. definition: all that decides an entry
    beside its number and the seed, as JSON has it. parallel: whether several processes of one machine may compute at once; a
    source that uses all cores itself says no.
    """

    @property
    def name(self) -> str: ...
    @property
    def keys(self) -> tuple[str, ...]: ...
    @property
    def seed(self) -> int: ...
    @property
    def measure(self) -> MeasureName: ...
    @property
    def definition(self) -> Mapping[str, Any]: ...
    @property
    def parallel(self) -> bool: ...

    def chunk(self, first: int, count: int) -> Chunk:
        """Return entries first to first + count - 1."""
        ...


@dataclass(frozen=True)
class StructureSource:
    """Entries of a structure model, see `entries`.

    seed: of random parameters and of the noise. sampling: "random" or "grid". side: of an entry's picture in pixels, at least
    103, so that all scales of the descriptor fit. Raises InputError for another.
    """

    model: StructureModel
    seed: int = 0
    sampling: Sampling = "random"
    side: int = SIDE

    def __post_init__(self) -> None:
        if self.seed < 0:
            raise InputError(f"The seed is {self.seed}; a whole number of at least 0 is needed.")
        if self.side < COMPLETE_SIDE:
            raise InputError(f"Pictures of {self.side} pixels a side lack scales; at least {COMPLETE_SIDE} are needed.")

    @property
    def name(self) -> str:
        """The model's name."""
        return self.model.name

    @property
    def measure(self) -> MeasureName:
        """Structures'."""
        return "structures"

    @property
    def keys(self) -> tuple[str, ...]:
        """The model's parameters."""
        return tuple(p.key for p in self.model.parameters)

    @property
    def definition(self) -> dict[str, Any]:
        """The model's ranges, the sampling, the side, and the version of pictures and draws."""
        ranges = [[p.key, p.lower, p.upper, p.spread, p.stops] for p in self.model.parameters]
        return {
            "kind": "structure", "model": self.model.name, "parameters": ranges, "sampling": self.sampling, "side": self.side,
            "version": ENTRIES_VERSION,
        }  # fmt: skip

    @property
    def parallel(self) -> bool:
        """True: a picture keeps one core busy."""
        return True

    @property
    def most(self) -> int | None:
        """How many entries there are at most: a grid's, else None."""
        return self.model.grid_size if self.sampling == "grid" else None

    def chunk(self, first: int, count: int) -> Chunk:
        """Return entries first to first + count - 1."""
        found = entries(self.model, first, count, self.seed, self.sampling, self.side)
        return found.values, found.vectors
