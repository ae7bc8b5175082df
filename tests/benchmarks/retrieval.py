"""How well and how fast parameters are retrieved: `python -m tests.benchmarks.retrieval [ENTRIES [ROWS]]` prints it.

Self-retrieval: a library of ENTRIES (200) random entries of perlin, brick and rings; every tenth is drawn with another seed,
turned and perhaps swapped, and looked for. Speed: a table of ROWS (100 000) mixtures of those entries, and one of random
numbers, the worst there is since no outline rules anything out. About a minute on two cores.
"""

import sys
import time
from collections.abc import Callable
from statistics import median

import numpy as np
from numpy.typing import NDArray

from voldetail.library import entries, nearest, published_w_global, random_values, table, vector_of
from voldetail.library.span import span_of, spanned
from voldetail.metric.gabor import GLOBAL
from voldetail.texture.structures import MODELS, structure

Array = NDArray[np.float32]
NAMES = ("perlin", "brick", "rings")
QUERIES = 20


def library(count: int) -> Array:
    start = time.perf_counter()
    found = np.concatenate([entries(MODELS[name], 0, count).vectors for name in NAMES])
    print(f"entries a second, one process: {len(found) / (time.perf_counter() - start):.1f}")
    return found


def queries(count: int) -> list[tuple[int, int, bool, Array]]:
    """(entry, steps turned, swapped, vector) of pictures with another seed."""
    rng = np.random.default_rng(1)
    found = []
    for k in range(0, len(NAMES) * count, max(count // QUERIES, 1)):
        model, step, swap = MODELS[NAMES[k // count]], int(rng.integers(16)), bool(rng.integers(2))
        s = structure(model, random_values(model, k % count), rotation=step * np.pi / 16, seed=1)
        s = spanned(s, span_of(s))  # as a photo's structure is
        found.append((k, step, swap, vector_of(1 - s if swap else s)))
    return found


def self_retrieval(vectors: Array, count: int, w_global: float) -> None:
    searched = table(vectors, w_global)
    ranks: dict[str, list[int]] = {name: [] for name in NAMES}
    models = []
    for k, _, _, query in queries(count):
        found = nearest(searched, query, top=len(vectors))
        ranks[NAMES[k // count]].append([match.entry for match in found].index(k))
        models.append(found[0].entry // count == k // count)
    every = np.concatenate(list(ranks.values()))
    print(
        f"w_global {w_global:.1f}: first {np.mean(every == 0):.0%}, among 8 {np.mean(every < 8):.0%}, "
        f"the model {np.mean(models):.0%}; median and worst rank, from 0: "
        + ", ".join(f"{name} {median(found):g} and {max(found)}" for name, found in ranks.items())
    )


def seconds(call: Callable[[], object], times: int = 5) -> float:
    found = []
    for _ in range(times):
        start = time.perf_counter()
        call()
        found.append(time.perf_counter() - start)
    return median(found)


def mixtures(vectors: Array, rows: int) -> Array:
    rng = np.random.default_rng(0)
    found = np.empty((rows, vectors.shape[1]), np.float32)
    for first in range(0, rows, 20_000):
        part = found[first : first + 20_000]
        share = rng.random((len(part), 1), dtype=np.float32)
        one, other = (vectors[rng.integers(len(vectors), size=len(part))] for _ in range(2))
        part[:] = (share * one + (1 - share) * other) * (1 + 0.05 * rng.standard_normal(part.shape, dtype=np.float32))
    return found


def speed(vectors: Array, rows: int) -> None:
    s = structure(MODELS["brick"])
    print(f"descriptor of 256 x 256: {seconds(lambda: vector_of(s)) * 1e3:.0f} ms")
    query = vector_of(structure(MODELS["rings"], seed=2))
    for name, searched in (
        ("mixtures", table(mixtures(vectors, rows))),
        ("random", table(np.random.default_rng(0).random((rows, vectors.shape[1]), dtype=np.float32))),
    ):
        print(f"query of {rows} {name}: {seconds(lambda: nearest(searched, query)) * 1e3:.0f} ms")


def main() -> None:
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 200
    rows = int(sys.argv[2]) if len(sys.argv) > 2 else 100_000
    vectors = library(count)
    for w_global in (GLOBAL, published_w_global()):
        self_retrieval(vectors, count, w_global)
    speed(vectors, rows)


if __name__ == "__main__":
    main()
