"""What an index of a library finds and how fast: `python -m tests.benchmarks.retrieval_index [ROWS [FOLDER]]` prints it.

A library of ROWS (300 000) mixtures of 180 entries of perlin, brick and rings, as in tests.benchmarks.retrieval, is built in
FOLDER (a temporary one). Queries: pictures of those models with other seeds, turned and swapped, twelve of each. Recall at 8: how
many of the eight nearest the index finds. A minute, and 7 kB of disk a row, half of it while building.
"""

import sys
import tempfile
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from statistics import mean, median
from typing import Any

import numpy as np

from tests.benchmarks.retrieval import NAMES, Array, library, mixtures
from voldetail.library import nearest, open_library, random_values, vector_of
from voldetail.library.building.build import build
from voldetail.library.building.source import Chunk
from voldetail.library.index import nearest_by_index, open_index, write_index
from voldetail.library.measures import MeasureName
from voldetail.library.span import span_of, spanned
from voldetail.texture.structures import MODELS, structure

EACH = 60
QUERIES = 12
TOP = 8
SETTINGS = ((4, 256), (4, 1024), (16, 256), (16, 1024), (64, 1024), (64, 4096))


@dataclass(frozen=True, eq=False)
class Mixtures:
    """Entries that are mixtures of others."""

    all: Array
    name: str = "mixtures"
    keys: tuple[str, ...] = ("number",)
    seed: int = 0
    measure: MeasureName = "structures"
    parallel: bool = False
    definition: Mapping[str, Any] = field(default_factory=dict)

    def chunk(self, first: int, count: int) -> Chunk:
        return np.arange(first, first + count, dtype=np.float64)[:, None], self.all[first : first + count]


def queries() -> list[Array]:
    rng = np.random.default_rng(2)
    found = []
    for name in NAMES:
        for k in range(QUERIES):
            values = random_values(MODELS[name], k, seed=1)
            s = structure(MODELS[name], values, rotation=float(rng.integers(16)) * np.pi / 16, seed=3)
            s = spanned(s, span_of(s))
            found.append(vector_of(1 - s if rng.integers(2) else s))
    return found


def timed(call: Callable[[], Any]) -> tuple[float, Any]:
    start = time.perf_counter()
    found = call()
    return time.perf_counter() - start, found


def main() -> None:
    rows = int(sys.argv[1]) if len(sys.argv) > 1 else 300_000
    with tempfile.TemporaryDirectory(dir=sys.argv[2] if len(sys.argv) > 2 else None) as folder:
        source = Mixtures(mixtures(library(EACH), rows))
        seconds, path = timed(lambda: build([source], rows, Path(folder) / "lib", workers=1, chunk=8192))
        print(f"{rows} entries kept and finished: {seconds:.1f} s")
        print(f"opened: {timed(lambda: open_library(path))[0] * 1e3:.0f} ms")
        seconds, _ = timed(lambda: write_index(open_library(path)))
        print(f"indexed: {seconds:.1f} s")
        opened = open_library(path)
        group, index, asked = opened.groups["mixtures"], open_index(opened)["mixtures"], queries()
        exact = [timed(lambda: nearest(group.table, query, TOP)) for query in asked]
        print(f"exact query: {median(t for t, _ in exact) * 1e3:.0f} ms")
        sets = [{match.entry for match in found} for _, found in exact]
        for cells, count in SETTINGS:
            found = [
                timed(lambda: nearest(group.table, query, TOP, among=index.candidates(query, cells=cells, count=count)))
                for query in asked
            ]
            recall = mean(len(those & {m.entry for m in these}) / TOP for those, (_, these) in zip(sets, found, strict=True))
            print(f"{cells} cells, {count} candidates: recall {recall:.3f}, {median(t for t, _ in found) * 1e3:.0f} ms")
        found = [timed(lambda: nearest_by_index(group, index, query, TOP)) for query in asked]
        recall = mean(len(those & {m.entry for m in these}) / TOP for those, (_, these) in zip(sets, found, strict=True))
        print(f"default: recall {recall:.3f}, {median(t for t, _ in found) * 1e3:.0f} ms")


if __name__ == "__main__":
    main()
