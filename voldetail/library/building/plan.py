"""What a library is to be made of, and the chunks that its entries are computed in."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Any

from voldetail.errors import InputError
from voldetail.library.building.source import Source
from voldetail.library.layout import FORMAT_VERSION, MOST_ENTRIES, MOST_KEYS, MOST_SOURCES, NAME, bytes_on_disk
from voldetail.library.measures import MEASURES, MeasureName
from voldetail.library.vectors import weights_definition
from voldetail.metric.gabor import GLOBAL

SMALLEST_CHUNK, LARGEST_CHUNK, CHUNKS = 8, 128, 32
"""Entries of a chunk: a thirty-second of a source, within these, so that a few workers share a small library and a large one
has not too many files. A structure takes some 50 ms."""


@dataclass(frozen=True)
class Task:
    """Some entries of a source, by its place among the sources."""

    source: int
    first: int
    count: int


@dataclass(frozen=True)
class Plan:
    """What is built: sources, how many entries of each, entries a chunk, and the weight of brightness and contrast.

    Raises InputError for no sources, too many, two of one name, names and numbers of entries that are not allowed.
    """

    sources: tuple[Source, ...]
    counts: tuple[int, ...]
    chunk: int | None = None
    w_global: float = GLOBAL

    def __post_init__(self) -> None:
        names = [source.name for source in self.sources]
        if not 1 <= len(names) <= MOST_SOURCES:
            raise InputError(f"A library of {len(names)} sources is not possible; 1 to {MOST_SOURCES} are allowed.")
        if len(self.counts) != len(names):
            raise InputError(f"{len(self.counts)} numbers of entries are given for {len(names)} sources; give one for each.")
        for source, count in zip(self.sources, self.counts, strict=True):
            if not re.fullmatch(NAME, source.name):
                raise InputError(f"A source cannot be called {source.name!r}; small letters, digits, space, - and _ are allowed.")
            if names.count(source.name) > 1:
                raise InputError(f"{source.name} is there twice; name each source once.")
            if not 1 <= len(source.keys) <= MOST_KEYS:
                raise InputError(f"Entries of {source.name} have {len(source.keys)} numbers; 1 to {MOST_KEYS} are allowed.")
            if not 1 <= count <= MOST_ENTRIES:
                raise InputError(f"{count} entries of {source.name} are asked for; 1 to {MOST_ENTRIES} are allowed.")
            most = getattr(source, "most", None)
            if most is not None and count > most:
                raise InputError(f"{count} entries of {source.name} are asked for, and it has {most}; ask for fewer.")
        if len({source.measure for source in self.sources}) > 1:
            raise InputError("A library has either structures or reliefs; build one library for each.")
        if self.chunk is not None and self.chunk < 1:
            raise InputError(f"A chunk of {self.chunk} entries is not possible; at least 1 is needed.")

    @property
    def measure(self) -> MeasureName:
        """What all pictures are described with."""
        return self.sources[0].measure

    @property
    def entries(self) -> int:
        """How many entries there are in all."""
        return sum(self.counts)

    @property
    def bytes(self) -> int:
        """Size of the finished library's chunks; as much again is needed while it is built."""
        return bytes_on_disk(self.counts, [len(source.keys) for source in self.sources], self.measure)

    @property
    def definition(self) -> dict[str, Any]:
        """All that decides the library, as JSON has it."""
        parts = [
            {"name": s.name, "keys": list(s.keys), "seed": s.seed, "entries": n, "definition": dict(s.definition)}
            for s, n in zip(self.sources, self.counts, strict=True)
        ]
        return {
            "version": FORMAT_VERSION, "measure": self.measure, "descriptor": MEASURES[self.measure].definition(),
            "weights": weights_definition(self.w_global), "sources": parts,
        }  # fmt: skip

    def tasks(self) -> list[Task]:
        """Return all chunks, of each source some in turn: what is done is then a fair sample of what is left."""
        found = []
        for place, count in enumerate(self.counts):
            size = self._size(count)
            found += [(first / count, Task(place, first, min(size, count - first))) for first in range(0, count, size)]
        return [task for _, task in sorted(found, key=lambda pair: (pair[0], pair[1].source))]

    def _size(self, count: int) -> int:
        return self.chunk or max(SMALLEST_CHUNK, min(LARGEST_CHUNK, count // CHUNKS))
