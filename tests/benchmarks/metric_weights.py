"""Whether weights learned from the photographs would better the default's, scored on photographs that were left out.

Run with:  python -m tests.benchmarks.metric_weights
Writes results/metric/weights.json; about four minutes, nearly all of it for measuring.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize
from scipy.special import expit, logsumexp

from tests.benchmarks import texture_pictures as pictures
from tests.benchmarks.metric_table import RESULTS, retrieval
from tests.benchmarks.rivals import RIVALS, Rival
from tests.benchmarks.searched_decoys import searched
from voldetail.files import write_text
from voldetail.metric.floors import noise_floors
from voldetail.metric.ingredients import COMBINED, INGREDIENTS, Ingredient
from voldetail.metric.layers import Layers, layers

Array = NDArray[np.float64]
Part = tuple[str, str]

MEASURED: dict[str, Ingredient | Rival] = {
    **{n: m for n, m in INGREDIENTS.items() if n not in ("published", "gabor")},
    **{n: RIVALS[n] for n in ("patches", "jets", "contours")},
}
"""What may be weighed: all but the published metric, which has to stay apart, and what sees hardly more than tone."""

FOLDS = 6
SEEDS = (0, 1)
"""Of the photos' order, and so of what is left out together."""

HOLD = 3.0
"""How strongly learned weights are held to the default's; between 0.3 and 10 scores hardly change."""

SHARES = {"granulometry": 1 / 6, "low-pass": 0.04}
"""Shares of the weight that fits need, whatever photographs say."""

POWERS = (0.5, 1.5, 2.0, 3.0, 4.0)
"""Of power means in the place of the default's plain one."""

SHARPNESS = 0.15
"""Ratio of distances, as a logarithm, that counts as clearly in order."""

NEGATIVES = 5
"""Decoys that other photographs' crops, some 130 a photo, together count as."""

SHAPES: dict[str, Callable[[Array], Array]] = {
    "plain": lambda v: v,
    "soft floor": lambda v: np.sqrt(1 + v * v) - 1,  # quadratic within the noise floor, straight beyond
}


def _apart(way: Ingredient | Rival, a: Any, b: Any, basis: Any) -> float:
    return way.compare(a, b, basis) if hasattr(way, "compare") else float(way.apart(a, b, basis))


@dataclass(frozen=True)
class Sample:
    """One photo as reference: parts, in its noise floors, of accepted pictures, decoys and every crop there is."""

    accepted: dict[str, Array]
    decoys: dict[str, Array]
    crops: Array


def collect(photos: dict[str, pictures.Picture]) -> tuple[list[Part], list[str], dict[str, Sample]]:
    """The parts' names, the owner of each crop, and a Sample for each photo."""
    gallery = [(name, layers(pictures.crop(p, corner))) for name, p in photos.items() for corner in pictures.corners(p)]
    crops = [_measured(seen) for _, seen in gallery]  # no feature depends on the reference, see `yardsticks`
    samples, parts = {}, []
    for name, photo in photos.items():
        first = pictures.crop(photo, pictures.corners(photo)[0])
        seen = layers(first)
        basis = {n: m.basis(seen) for n, m in MEASURED.items()}
        own = _measured(seen)

        def apart(a: Any, b: Any, basis: Any = basis) -> dict[Part, float]:
            return {
                (n, part): _apart(MEASURED[n], value, b[n][part], basis[n].get(part))
                for n, found in a.items() for part, value in found.items()
            }  # fmt: skip

        floors = noise_floors(first, None, seen, lambda a, b, apart=apart: apart(_measured(a), _measured(b)))  # type: ignore[misc]
        parts = list(floors)
        unit = np.array([floors[part] for part in parts])

        def row(other: Any, own: Any = own, unit: Array = unit, apart: Any = apart) -> Array:
            return np.array(list(apart(own, other).values())) / unit

        wrong = pictures.decoys(first) if name in pictures.DECOY_PHOTOS else {}
        forged = searched(name) if wrong else None
        if forged is not None:
            wrong["searched"] = forged
        samples[name] = Sample(
            {kind: row(_measured(layers(p))) for kind, p in pictures.accepted(photo).items()},
            {kind: row(_measured(layers(p))) for kind, p in wrong.items()}, np.array([row(c) for c in crops]),
        )  # fmt: skip
    return parts, [name for name, _ in gallery], samples


def _measured(seen: Layers) -> Any:
    return {name: metric.measure(seen, {}) for name, metric in MEASURED.items()}


def learn(parts: list[Part], owners: list[str], samples: dict[str, Sample]) -> Array:
    """Weights for which accepted pictures are nearer than decoys and other photos' crops, by logistic loss.

    They are held to the start, the default's weights with some for every part, by the relative entropy.
    """
    default = np.array([COMBINED.get(n, {}).get(part, 0.0) for n, part in parts])
    start = 0.7 * default + 0.3 / len(parts)
    groups = [np.array([n == name for n, _ in parts]) for name in SHARES]
    groups.append(~np.any(groups, axis=0))
    shares = [*SHARES.values(), 1 - sum(SHARES.values())]
    pairs = list(_pairs(owners, samples))

    def weights(t: Array) -> Array:
        w = np.zeros(len(t))
        for group, share in zip(groups, shares, strict=True):
            w[group] = share * np.exp(t[group] - logsumexp(t[group]))
        return w

    def loss(t: Array) -> tuple[float, Array]:
        w = weights(t)
        total, slope = HOLD * float(np.sum(start * np.log(start / w))), -HOLD * start / w
        for near, far, scale in pairs:
            a, b = near @ w, far @ w
            margin = (np.log(b)[None] - np.log(a)[:, None]) / SHARPNESS
            wrong = expit(-margin)
            total += scale * float(np.logaddexp(0, -margin).sum())
            slope += scale / SHARPNESS * ((wrong.sum(1) / a) @ near - (wrong.sum(0) / b) @ far)
        down = np.zeros(len(t))
        for group in groups:
            inside = w[group]
            down[group] = inside * (slope[group] - inside @ slope[group] / inside.sum())
        return total, down

    return weights(minimize(loss, np.log(start), jac=True, method="L-BFGS-B", options={"maxiter": 150}).x)


def _pairs(owners: list[str], samples: dict[str, Sample]) -> Iterator[tuple[Array, Array, float]]:
    for name, sample in samples.items():
        near = np.array(list(sample.accepted.values()))
        others = np.array([owner != name and owner in samples for owner in owners])
        yield near, sample.crops[others], NEGATIVES / (len(near) * int(others.sum()))
        if sample.decoys:
            yield near, np.array(list(sample.decoys.values())), 1 / len(near)


def scores(owners: list[str], samples: dict[str, Sample], weights: dict[str, Array], power: float = 1.0) -> dict[str, Any]:
    """The table's scores of distances by each photo's ``weights``, as power means."""

    def mean(parts: Array, name: str) -> Array:
        return (parts**power @ weights[name]) ** (1 / power)

    found: dict[str, Any] = retrieval(np.array([mean(samples[n].crops, n) for n in samples]), list(samples), owners)
    right, clean, ratios = [], 0, {}
    for name, sample in samples.items():
        if not sample.decoys:
            continue
        near = {kind: float(mean(v, name)) for kind, v in sample.accepted.items()}
        far = {kind: float(mean(v, name)) for kind, v in sample.decoys.items()}
        crops = np.mean([value for kind, value in near.items() if kind.startswith("crop")])
        ratios[name] = far["phase"] / crops
        right += [a < d for a in near.values() for d in far.values()]
        clean += max(near.values()) < min(far.values())
    return found | {
        "pairs_right": round(100 * float(np.mean(right)), 1), "photos_clean": f"{clean}/{len(ratios)}",
        "phase": [round(float(np.median(list(ratios.values()))), 2), round(min(ratios.values()), 2)],
    }  # fmt: skip


def report(parts: list[Part], owners: list[str], samples: dict[str, Sample]) -> dict[str, Any]:
    """Scores of the default, and of learned weights on the photos that each fold left out and on all that they saw."""
    default = np.array([COMBINED.get(n, {}).get(part, 0.0) for n, part in parts])
    out: dict[str, Any] = {
        f"default, power mean of {power:g}": scores(owners, samples, dict.fromkeys(samples, default), power) for power in POWERS
    }
    for shape, bend in SHAPES.items():
        everything = _bent(samples, lambda v, bend=bend: bend(v))  # type: ignore[misc]
        out[f"default, {shape}"] = scores(owners, everything, dict.fromkeys(samples, default))
        for which, used in (("its parts", default > 0), ("all parts", default >= 0)):
            bent = _bent(everything, lambda v, used=used: v[..., used])  # type: ignore[misc]
            named = [part for part, u in zip(parts, used, strict=True) if u]
            seen = learn(named, owners, bent)
            out[f"learned, {which}, {shape}"] = {
                **{f"left out {seed}": scores(owners, bent, _left_out(named, owners, bent, seed)) for seed in SEEDS},
                "seen": scores(owners, bent, dict.fromkeys(samples, seen)),
                "weights": {": ".join(part): round(float(w), 3) for part, w in zip(named, seen, strict=True)},
            }
    return out


def _bent(samples: dict[str, Sample], bend: Callable[[Array], Array]) -> dict[str, Sample]:
    return {
        name: Sample({k: bend(v) for k, v in s.accepted.items()}, {k: bend(v) for k, v in s.decoys.items()}, bend(s.crops))
        for name, s in samples.items()
    }


def _left_out(parts: list[Part], owners: list[str], samples: dict[str, Sample], seed: int) -> dict[str, Array]:
    """For each photo the weights learned without its fold, neither as reference nor as another's crop."""
    mixed = np.random.default_rng(seed).permutation(list(samples))
    ordered = sorted(mixed, key=lambda name: not samples[name].decoys)  # so that every fold has photos with decoys
    held: dict[str, Array] = {}
    for fold in range(FOLDS):
        without = set(ordered[fold::FOLDS])
        found = learn(parts, owners, {n: s for n, s in samples.items() if n not in without})
        held |= dict.fromkeys(without, found)
    return held


def main() -> None:
    shared = RESULTS.parents[2] / "shared" / "data"
    found = report(*collect(pictures.textures(shared if shared.is_dir() else None)))
    write_text(RESULTS / "weights.json", json.dumps(found, indent=1) + "\n")
    print(json.dumps(found, indent=1))


if __name__ == "__main__":
    main()
