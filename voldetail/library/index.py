"""An index of a library's entries by their outlines, so that a query looks at some of millions only (an inverted file).

Outlines (see `tables`), each number multiplied by its weight, are sorted into cells about centres found by k-means. A query looks
into the cells whose centres are nearest to its own outline, takes the entries with the nearest outlines there, and compares those
in full. What it misses are near entries in cells that it does not look into: the search without an index is exact.

    LIB/index    a line of JSON: format, version, SHA-256 of the library's header; zeros up to 4096 bytes;
                 of each source centres (cells, 60) float32, ends of its cells (cells,) int64, numbers of its entries (N,) int64
                 and their outlines (N, 60) float32, both in the order of the cells
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray

from voldetail.errors import InputError
from voldetail.files import atomic, readable
from voldetail.library.compare import Match, check_query, nearest
from voldetail.library.groups import Group
from voldetail.library.layout import step_of
from voldetail.library.store import Library
from voldetail.library.tables import BLOCK, OUTLINE, Array, outline, outlined
from voldetail.library.vectors import swapped
from voldetail.records.json_text import parsed

FORMAT, VERSION = "voldetail index", 1
"""The version counts changes of the cells' number as well, from which the lengths follow."""

HEAD = 4096  # bytes of the line

ENTRIES_A_CELL, MOST_CELLS = 1000, 4096
"""More cells than these make k-means longer than all queries will take."""

CELLS_TOGETHER = 2**22  # distances to centres found at once: 16 MB
SAMPLE = 64
"""Entries a cell from which its centre is found."""

ROUNDS = 8
"""Of k-means; tuned on mixtures of three models' entries, of which more rounds find none that eight do not."""

CELLS = 16
"""Looked into for each order of tones. Tuned on the same, see tests.benchmarks.retrieval_index."""

CANDIDATES = 1024
"""Compared in full."""


@dataclass(frozen=True, eq=False)
class Index:
    """One source's cells: centres (cells, 60), ends (cells,) of their parts of numbers (N,) and outlines (N, 60)."""

    weights: NDArray[np.float64]
    centres: Array
    ends: NDArray[np.int64]
    numbers: NDArray[np.int64]
    outlines: Array

    def candidates(self, query: Array, swap: bool = True, cells: int = CELLS, count: int = CANDIDATES) -> NDArray[np.intp]:
        """Return the numbers of about ``count`` entries that look nearest by their outlines, in order of their numbers."""
        known = ~np.isnan(query[outlined()])
        found: list[NDArray[np.int64]] = []
        for order in (query, swapped(query)) if swap else (query,):
            asked = (outline(np.nan_to_num(order)[None])[0] * self.weights)[known].astype(np.float32)
            gaps = ((self.centres[:, known] - asked) ** 2).sum(axis=1)
            near = np.sort(np.argsort(gaps, kind="stable")[:cells])
            starts = np.where(near > 0, self.ends[near - 1], 0)
            parts = [slice(int(a), int(b)) for a, b in zip(starts, self.ends[near], strict=True)]
            gaps = np.concatenate([((self.outlines[part][:, known] - asked) ** 2).sum(axis=1) for part in parts])
            numbers = np.concatenate([self.numbers[part] for part in parts])
            found.append(numbers if len(gaps) <= count else numbers[np.argpartition(gaps, count)[:count]])
        chosen = np.unique(np.concatenate(found)).astype(np.intp)
        if not (chosen[0] >= 0 and chosen[-1] < len(self.numbers)):
            raise InputError("The index names entries that its library lacks; make it again with: voldetail library index.")
        return chosen


def nearest_by_index(
    group: Group, index: Index, query: ArrayLike, top: int = 8, *, rotations: bool = True, swap: bool = True
) -> tuple[Match, ...]:
    """Return nearly always what `compare.nearest` does, of entries that the index thinks likely, and refuse the same."""
    asked = np.asarray(query, np.float32)
    check_query(asked, top)
    likely = index.candidates(asked, swap, count=max(CANDIDATES, top))
    return nearest(group.table, asked, top, rotations=rotations, swap=swap, among=likely)


def write_index(library: Library, on_entries: Callable[[int], None] = lambda entries: None) -> Path:
    """Write the index of a library into it and return its path; on_entries is told how many entries are done.

    Raises InputError where it cannot be written.
    """
    if not library.groups:
        raise InputError(f"The library {library.header.path} has reliefs, which are few: they need no index.")
    path, done = library.header.path / "index", 0
    head = json.dumps({"format": FORMAT, "version": VERSION, "library": library.header.sha256}) + "\n"
    with atomic(path) as temporary, open(temporary, "wb") as stream:
        stream.write(head.encode().ljust(HEAD, b"\0"))
        for group in library.groups.values():
            count = len(group.values)
            cells = _cells(count)
            rows = np.concatenate(list(_weighted(group)))
            centres = _centres(rows, cells)
            stream.write(centres.astype("<f4").tobytes())
            of = _cells_of(rows, centres)
            order = np.argsort(of, kind="stable")
            for numbers in (np.cumsum(np.bincount(of, minlength=cells)), order):
                stream.write(numbers.astype("<i8").tobytes())
            for first in range(0, count, BLOCK):
                stream.write(rows[order[first : first + BLOCK]].astype("<f4").tobytes())
            done += count
            on_entries(done)
    return path


def open_index(library: Library) -> dict[str, Index]:
    """Return the index of each source of a library, mapped and not read.

    Raises InputError where there is none, it is damaged, or it belongs to another library.
    """
    again = f"make it again with: voldetail library index {library.header.path}"
    path = library.header.path / "index"
    if not path.exists():
        raise InputError(f"The library {library.header.path} has no index; make one with: voldetail library index.")
    size = readable(path, "index", 2**40).lstat().st_size
    with open(path, "rb") as stream:
        line = stream.read(HEAD).rstrip(b"\0")
    head = parsed(line.decode("utf-8", "replace"), f"The index {path}", "index")
    if head.get("format") != FORMAT or head.get("version") != VERSION:
        raise InputError(f"The index {path} is none, or of another version; {again}.")
    if head.get("library") != library.header.sha256:
        raise InputError(f"The index {path} belongs to another library; {again}.")
    at, indexes = HEAD, {}
    for name, group in library.groups.items():
        count = len(group.values)
        cells = _cells(count)
        shapes = ((cells, OUTLINE), np.float32), ((cells,), np.int64), ((count,), np.int64), ((count, OUTLINE), np.float32)
        parts = []
        for shape, kind in shapes:
            length = int(np.prod(shape)) * np.dtype(kind).itemsize
            if at + length > size:
                raise InputError(f"The index {path} is cut short; {again}.")
            parts.append(np.asarray(np.memmap(path, kind, "r", at, shape)))
            at += length
        if np.any(np.diff(parts[1], prepend=0) < 0) or parts[1][-1] != count:
            raise InputError(f"The index {path} is damaged; {again}.")
        indexes[name] = Index(group.table.weights[outlined()], *parts)
    if at != size:
        raise InputError(f"The index {path} has {size} bytes where {at} are needed; {again}.")
    return indexes


def _cells(count: int) -> int:
    return min(max(1, count // ENTRIES_A_CELL), MOST_CELLS)


def _weighted(group: Group) -> Iterator[Array]:
    """The weighted outlines of a group's entries, block by block."""
    count, w = len(group.values), group.table.weights[outlined()].astype(np.float32)
    for first in range(0, count, step_of(count)):
        yield outline(group.table.vectors[first : min(first + step_of(count), count)]) * w


def _centres(rows: Array, count: int) -> Array:
    """k-means, of a sample; a centre that no entry is nearest to stays where it is."""
    rng = np.random.default_rng(0)
    sample = rows[rng.permutation(len(rows))[: count * SAMPLE]]
    centres = sample[:count].copy()
    for _ in range(ROUNDS):
        of = _cells_of(sample, centres)
        counts = np.bincount(of, minlength=count)
        sums = np.stack([np.bincount(of, sample[:, k], count) for k in range(sample.shape[1])], axis=1)
        centres = np.where(counts[:, None] > 0, sums / np.maximum(counts, 1)[:, None], centres).astype(np.float32)
    return centres


def _cells_of(rows: Array, centres: Array) -> NDArray[np.intp]:
    """The nearest centre of each row, by |c|^2 - 2 r.c."""
    squares = (centres**2).sum(axis=1)
    step = max(1, CELLS_TOGETHER // len(centres))
    parts = [rows[first : first + step] for first in range(0, len(rows), step)]
    return np.concatenate([np.argmin(squares - 2 * (part @ centres.T), axis=1) for part in parts])
