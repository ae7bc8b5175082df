"""Whether known pictures are found again, in parameters, model and looks:

    python -m tests.benchmarks.retrieval_models [FOLDER [ENTRIES [PLAIN [DISTURBED]]]]

A library of ENTRIES (400) random entries of each of the 12 models; PLAIN (200) random pictures of each that are not in it, with
another seed of the noise, as they are, and DISTURBED (200) of them in each of six ways. FOLDER (a temporary one by default) keeps
descriptors, so that a run that was stopped goes on; give another for other numbers. Writes results/retrieval/models.json and
confusion.png; most of the time goes to descriptors, some 15 a second on two free cores.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path
from tempfile import gettempdir
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tests.benchmarks.retrieval_appearance import appearance
from tests.benchmarks.retrieval_confusion import draw_confusion
from tests.benchmarks.retrieval_queries import CHANGES, Queries, gaps, queries, shares
from voldetail.library import entries, nearest, rank, table
from voldetail.library.groups import Group
from voldetail.texture.structures import MODELS, StructureModel

RESULTS = Path(__file__).resolve().parents[2] / "results" / "retrieval"
ENTRIES, PLAIN, DISTURBED = 400, 200, 200
Floats = NDArray[np.float64]


def kept(folder: Path, name: str, make: Any) -> dict[str, NDArray[Any]]:
    """Arrays of a file in ``folder``, made if it is not there."""
    path = folder / f"{name.replace(' ', '_')}.npz"
    if not path.exists():
        print("making", name, flush=True)
        # Beside and renamed: a run that is stopped leaves no half of a file.
        np.savez(path.with_suffix(".part.npz"), **make())
        path.with_suffix(".part.npz").rename(path)
    with np.load(path, allow_pickle=False) as stored:
        return dict(stored)


def library(folder: Path, count: int = ENTRIES) -> dict[str, Group]:
    """The models' groups."""
    found = {}
    for name, model in MODELS.items():

        def made(model: StructureModel = model) -> dict[str, Any]:
            chunk = entries(model, 0, count)
            return {"values": chunk.values, "vectors": chunk.vectors}

        stored = kept(folder, f"lib {name}", made)
        found[name] = Group(name, tuple(p.key for p in model.parameters), stored["values"], table(stored["vectors"]), 0)
    return found


def asked(folder: Path, change: str, count: int) -> dict[str, Queries]:
    """Each model's first ``count`` queries under a disturbance."""
    found = {}
    for name in MODELS:

        def made(name: str = name) -> dict[str, Any]:
            q = queries(name, change, count)
            return {"shares": q.shares, "vectors": q.vectors}

        stored = kept(folder, f"q {name} {change}", made)
        found[name] = Queries(stored["shares"][:count], stored["vectors"][:count])
    return found


def parameters_found(group: Group, asked_for: Queries) -> dict[str, Any]:
    """Rank of the entry nearest in parameters among its model's, and errors of parameters, as shares of their ranges."""
    model = MODELS[group.model]
    stored = shares(model, group.values[:])
    ranks, first, closest, chance = [], [], [], []
    rng = np.random.default_rng(0)
    for wanted, vector in zip(asked_for.shares, asked_for.vectors, strict=True):
        matches = nearest(group.table, vector, top=len(stored))
        apart = gaps(model, stored, wanted)
        near = int(np.argmin(np.sum(apart**2, axis=1)))
        ranks.append([match.entry for match in matches].index(near))
        first.append(apart[matches[0].entry])
        closest.append(apart[near])
        chance.append(apart[rng.integers(len(stored))])
    of = {"first_answer": first, "nearest_entry": closest, "random_entry": chance}
    errors = {name: np.median(rows, axis=0) for name, rows in of.items()}
    return {
        "rank_of_nearest_entry": {
            "median": float(np.median(ranks)) + 1, "among_8": float(np.mean(np.array(ranks) < 8)),
            "among_32": float(np.mean(np.array(ranks) < 32)),
        },
        "error": {name: float(np.median(rows)) for name, rows in errors.items()},
        "error_by_parameter": {
            p.key: {name: float(errors[name][k]) for name in errors} for k, p in enumerate(model.parameters)
        },
    }  # fmt: skip


def typical_distances(groups: dict[str, Group], sample: int = 100) -> dict[str, float]:
    """Median over a model's entries of D to the nearest other one of the same model."""
    of = {name: [nearest(g.table, v, 2)[1].distance for v in g.table.vectors[:sample]] for name, g in groups.items()}
    return {name: float(np.median(found)) for name, found in of.items()}


def nearest_of_each(groups: dict[str, Group], of: dict[str, Queries]) -> tuple[NDArray[np.intp], Floats]:
    """Return the model (N,) of each query and D (N, models) to the nearest entry of each model."""
    truth, distances = [], []
    for number, name in enumerate(groups):
        for vector in of[name].vectors:
            found = rank(groups, vector, 1)
            truth.append(number)
            distances.append([found.by_model[other][0].distance for other in groups])
    return np.array(truth), np.array(distances)


def confusion(truth: NDArray[np.intp], distances: Floats) -> NDArray[np.intp]:
    """Counts (models, models): rows the model asked for, columns that of the first answer."""
    count = distances.shape[1]
    found = np.zeros((count, count), np.intp)
    np.add.at(found, (truth, np.argmin(distances, axis=1)), 1)
    return found


def right(counts: NDArray[np.intp]) -> float:
    """Share of queries whose first answer is of their model."""
    return float(np.trace(counts) / counts.sum())


def main() -> None:
    folder = Path(sys.argv[1]) if len(sys.argv) > 1 else Path(gettempdir()) / "voldetail-retrieval"
    given = [int(word) for word in sys.argv[2:5]]
    count, plain, disturbed = [*given, *(ENTRIES, PLAIN, DISTURBED)[len(given) :]]
    folder.mkdir(parents=True, exist_ok=True)
    RESULTS.mkdir(parents=True, exist_ok=True)
    groups = library(folder, count)
    typical = typical_distances(groups)
    report: dict[str, Any] = {
        "entries": count, "pictures": [plain, disturbed], "models": list(groups), "typical_distance": typical, "changes": {},
    }  # fmt: skip
    pictures = {}
    for change in CHANGES:
        of = asked(folder, change, plain if change == "plain" else disturbed)
        truth, distances = nearest_of_each(groups, of)
        counts = confusion(truth, distances)
        calibrated = confusion(truth, distances / np.array(list(typical.values())))
        own = distances[np.arange(len(truth)), truth]
        pictures[change] = counts
        report["changes"][change] = {
            "right_model": right(counts), "right_model_calibrated": right(calibrated), "confusion": counts.tolist(),
            "own_model_distance": {
                str(q): float(np.quantile(own, q)) for q in (0.05, 0.5, 0.9, 0.95, 0.99, 1.0)
            },
            "first_answer_distance": {
                str(q): float(np.quantile(distances.min(axis=1), q)) for q in (0.05, 0.5, 0.9, 0.95, 0.99, 1.0)
            },
            "models": {name: parameters_found(groups[name], of[name]) for name in groups},
        }  # fmt: skip
        print(change, f"{right(counts):.1%} of models right, calibrated {right(calibrated):.1%}", flush=True)
    report["appearance"] = appearance(folder, groups, asked(folder, "plain", plain))
    (RESULTS / "models.json").write_text(json.dumps(_rounded(report), indent=1) + "\n")
    shown = {name: pictures[name] for name in ("plain", "turned", "two tones", "jpeg")}
    draw_confusion(RESULTS / "confusion.png", list(groups), shown)


def _rounded(value: Any) -> Any:
    if isinstance(value, float):
        return float(f"{value:.4g}")
    if isinstance(value, dict):
        return {key: _rounded(v) for key, v in value.items()}
    return [_rounded(v) for v in value] if isinstance(value, list) else value


if __name__ == "__main__":
    main()
