"""What lies where in a library: a Zarr group, of format version 3, with a group for each source.

    LIB/zarr.json                     format, version, what vectors and norms were made with, names of the sources
    LIB/SOURCE/zarr.json              names of the numbers, seed, count, definition, SHA-256 of values and vectors
    LIB/SOURCE/values    (N, numbers) float64        an entry's numbers
    LIB/SOURCE/vectors   (N, 750)     float32        its descriptor; of reliefs, as many numbers as a row has, float16
    LIB/SOURCE/norms     (N, 12)      float32        what a query needs of it, see `tables`; none of reliefs
    LIB/SOURCE/outlines  (72, N)      float32

Chunks are stored as they are, little-endian and not compressed, so that each file can be mapped into memory.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import BaseModel, ConfigDict, Field

from voldetail.library.measures import MEASURES, MeasureName
from voldetail.library.tables import BLOCK, OUTLINED_ROWS
from voldetail.metric.gabor import SCALES

FORMAT = "voldetail library"
FORMAT_VERSION = 1

MOST_ENTRIES = 20_000_000
"""Of a source: twice the paper's largest exhaustive sampling."""

MOST_SOURCES = 100
MOST_KEYS = 100
MOST_METADATA = 2**20  # bytes of one zarr.json; a source's has about two thousand

NAME = r"[a-z0-9]([a-z0-9 _-]{0,62}[a-z0-9])?"
"""What a source may be called: also a folder's name, which leads nowhere else."""

_Hash = Annotated[str, Field(pattern="^[0-9a-f]{64}$")]
_Name = Annotated[str, Field(pattern=f"^{NAME}$")]


class _Record(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid", strict=True)


class LibraryRecord(_Record):
    """The attributes of a library."""

    format: Literal["voldetail library"]
    version: Literal[1]
    measure: MeasureName
    descriptor: dict[str, Any]
    descriptor_sha256: _Hash
    weights: dict[str, Any]
    sources: Annotated[list[_Name], Field(min_length=1, max_length=MOST_SOURCES)]


class SourceRecord(_Record):
    """The attributes of a source in a library."""

    keys: Annotated[list[Annotated[str, Field(min_length=1, max_length=100)]], Field(min_length=1, max_length=MOST_KEYS)]
    seed: Annotated[int, Field(ge=0)]
    entries: Annotated[int, Field(ge=1, le=MOST_ENTRIES)]
    definition: dict[str, Any]
    sha256: _Hash


@dataclass(frozen=True)
class ArrayLayout:
    """An array of a source: its folder, shape, the shape of a chunk, and its kind of number, "float16" to "float64"."""

    name: str
    shape: tuple[int, int]
    chunk: tuple[int, int]
    kind: str

    @property
    def chunk_bytes(self) -> int:
        """Bytes of each chunk's file; the last one is filled up."""
        return self.chunk[0] * self.chunk[1] * np.dtype(self.kind).itemsize

    @property
    def files(self) -> list[str]:
        """The chunks' files within the array's folder, in order."""
        rows, columns = (-(-whole // part) for whole, part in zip(self.shape, self.chunk, strict=True))
        return [f"c/{row}/{column}" for row in range(rows) for column in range(columns)]

    @property
    def metadata(self) -> dict[str, Any]:
        """What its zarr.json has to say."""
        return {
            "zarr_format": 3,
            "node_type": "array",
            "shape": list(self.shape),
            "data_type": self.kind,
            "chunk_grid": {"name": "regular", "configuration": {"chunk_shape": list(self.chunk)}},
            "chunk_key_encoding": {"name": "default", "configuration": {"separator": "/"}},
            "codecs": [{"name": "bytes", "configuration": {"endian": "little"}}],
            "fill_value": 0.0,
        }


def step_of(entries: int) -> int:
    """Return how many entries a chunk has: at most `tables.BLOCK`, and as even as can be, since the last one is filled up."""
    return -(-entries // -(-entries // BLOCK))


def arrays_of(entries: int, keys: int, measure: MeasureName) -> dict[str, ArrayLayout]:
    """Return the arrays by name of a source of so many entries and numbers."""
    step, used = step_of(entries), MEASURES[measure]
    columns = [("values", keys, "float64"), ("vectors", used.length(), used.kind)]
    columns += [("norms", 2 * SCALES, "float32")] if used.outlined else []
    found = {name: ArrayLayout(name, (entries, width), (step, width), kind) for name, width, kind in columns}
    if used.outlined:
        found["outlines"] = ArrayLayout("outlines", (OUTLINED_ROWS, entries), (OUTLINED_ROWS, step), "float32")
    return found


def bytes_on_disk(entries: Sequence[int], keys: Sequence[int], measure: MeasureName) -> int:
    """Return the bytes of a library's chunks, for the entries and numbers of each source."""
    arrays = [array for n, p in zip(entries, keys, strict=True) for array in arrays_of(n, p, measure).values()]
    return sum(len(array.files) * array.chunk_bytes for array in arrays)
