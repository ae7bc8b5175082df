"""How alike a known picture and its first answer look, by the project's metric."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tests.benchmarks.retrieval_queries import QUERY_SEED, Queries, gaps, shares
from voldetail.image import to_linear
from voldetail.library import nearest, random_values, structure_map
from voldetail.library.answers import Answer
from voldetail.library.entries import SIDE
from voldetail.library.groups import Group
from voldetail.library.span import span_of, spanned
from voldetail.metric import describe, distance
from voldetail.texture.structures import MODELS, structure

SAMPLE = 12
"""Pictures of each model: a description takes the longest of all."""

OTHER_SEED = 2


def appearance(folder: Path, groups: dict[str, Group], asked: dict[str, Queries], sample: int = SAMPLE) -> dict[str, Any]:
    """Distances M from known pictures: of the first answer of their model, of the entry nearest in parameters, of a random
    one, and of the same parameters with another seed; medians by model. What is known is kept in ``folder``."""
    path = folder / "appearance.json"
    rows: dict[str, list[dict[str, float]]] = json.loads(path.read_text()) if path.exists() else {}
    for name, group in groups.items():
        done = rows.setdefault(name, [])
        for k in range(len(done), sample):
            done.append(_compared(group, asked[name], k))
            path.write_text(json.dumps(rows))
        print("looks of", name, flush=True)
    found = {name: {key: float(np.median([row[key] for row in done])) for key in done[0]} for name, done in rows.items()}
    every = [row for done in rows.values() for row in done]
    found["all"] = {key: float(np.median([row[key] for row in every])) for key in every[0]}
    nearer = [row["first_answer"] < row["nearest_entry"] for row in every]
    return {"pictures_each": sample, "first_nearer_than_nearest_entry": float(np.mean(nearer)), "median": found}


def _compared(group: Group, asked: Queries, k: int) -> dict[str, float]:
    model = MODELS[group.model]
    values = random_values(model, k, QUERY_SEED)
    reference = describe(to_linear(_shown(structure(model, values, SIDE, seed=QUERY_SEED))))
    first = nearest(group.table, asked.vectors[k], 1)[0]
    apart = np.sum(gaps(model, shares(model, group.values[:]), asked.shares[k]) ** 2, axis=1)
    near, chance = int(np.argmin(apart)), k
    answer = Answer(group.model, first.entry, group.seed, group.parameters(first.entry), first.rotation, first.swapped, 0.0)
    s = structure_map(answer)
    pictures: dict[str, NDArray[np.float32]] = {
        "first_answer": 1 - s if first.swapped else s,
        "nearest_entry": _shown(structure(model, group.parameters(near), SIDE, seed=group.seed)),
        "random_entry": _shown(structure(model, group.parameters(chance), SIDE, seed=group.seed)),
        "other_seed": _shown(structure(model, values, SIDE, seed=OTHER_SEED)),
    }
    return {key: distance(reference, describe(to_linear(s), like=reference)) for key, s in pictures.items()}


def _shown(s: NDArray[np.float32]) -> NDArray[np.float32]:
    """On a photo's scale, as pictures of answers are."""
    return spanned(s, span_of(s))
