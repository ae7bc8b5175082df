"""Recovery: details drawn at random are rendered to "photos", and fitted again under the right light.

Run with:  python -m tests.benchmarks.recovery -o results/recovery
Named seeds, so that every case can be made again alone (--case NAME). Each solver gets the same evaluations.
"""

from __future__ import annotations

import argparse
import json
import math
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tests.benchmarks.kept import keep_linear
from tests.benchmarks.relit import height_record, heights_of
from voldetail.backend import mitsuba
from voldetail.detail import Detail, Reflectance, rounded
from voldetail.files import write_text
from voldetail.fit import fit
from voldetail.fit.session import derived_seed
from voldetail.fit.space import Kind, Space
from voldetail.image import Photo, luminance, to_linear, to_srgb
from voldetail.metric import describe, distance
from voldetail.render.build import build
from voldetail.render.heightfield import HeightField
from voldetail.render.unit_components import components
from voldetail.setup.file import setup_from
from voldetail.setup.light import lamp_of

NAMES = ("ash", "beech", "cedar", "elm", "fir", "hazel", "larch", "maple", "oak", "pine", "rowan", "willow")
SIDE = 192
OTHER_SEEDS = 3
RANKS = ((1, 50), (1, 2), (2, 2), (2, 3))


def truth_of(name: str) -> tuple[Detail, str]:
    """Return the detail and the light (as text) of a named case: ranks, stripes and numbers drawn from GD10's ranges."""
    draw = np.random.default_rng(derived_seed(2010, name))
    first, last = RANKS[draw.integers(4)]
    kind = Kind(first, last, str(draw.choice(["gaussian", "exponential"])), int(draw.integers(1, 4)), bool(draw.random() < 0.3))
    space = Space(domain="solid", scale=(6.0, 24.0), finest=1.0 / (1.6 * 2 / SIDE), roughness=(0.15, 0.8), anisotropy=(0.5, 2.0))
    vector = draw.random(len(space.names(kind)))
    detail = space.decode(kind, vector)
    reflectance = Reflectance(
        ambient=float(draw.uniform(0.05, 0.3)), diffuse=float(draw.uniform(0.3, 0.6)), specular=0.0, shininess=16.0
    )
    light = f"{draw.uniform(0, 360):.0f},{draw.uniform(30, 60):.0f}"
    seed = derived_seed(2010, f"{name}/truth")
    return rounded(detail.model_copy(update={"reflectance": reflectance, "seed": seed})), light


def photo_of(detail: Detail, light: str, seed: int | None = None) -> NDArray[np.float32]:
    """Return the 8-bit "photo" of a detail, decoded to linear light."""
    setup = _setup(light, "default", "combined", None)
    surface = build(setup, (SIDE, SIDE), (0, 0, SIDE, SIDE))
    surface.update(detail if seed is None else detail.model_copy(update={"seed": seed}))
    parts = components(surface, lamp_of(setup.light), subsamples=2, shininess=(detail.reflectance.shininess,))
    encoded = np.round(to_srgb(np.clip(parts.colour(detail.reflectance), 0, 1)) * 255) / 255
    return np.asarray(to_linear(encoded.astype(np.float32)), dtype=np.float32)


def _setup(light: str, solver: str, metric: str, evaluations: int | None) -> Any:
    return setup_from(
        {
            "photo": {"path": "rendered.png", "resolution": SIDE, "zone": [0, 0, SIDE, SIDE]},
            "light": light,
            "fit": {"solver": solver, "metric": metric, "evaluations": evaluations, "library": "none"},
        },
        "recovery",
    )


def run_case(name: str, solver: str, metric: str, evaluations: int | None) -> tuple[dict[str, Any], NDArray[np.float32]]:
    """Fit one case; returns its record and the photo and fit side by side."""
    truth, light = truth_of(name)
    pixels = photo_of(truth, light)
    result = fit(_setup(light, solver, metric, evaluations), photo=Photo(pixels, "0" * 64, ()))
    found = result.detail
    reference = describe(luminance(pixels), metric=metric)

    def mean_distance(detail: Detail) -> float:
        values = [
            distance(reference, describe(luminance(photo_of(detail, light, derived_seed(7, f"{name}/{i}"))), like=reference))
            for i in range(OTHER_SEEDS)
        ]
        return float(np.mean(values))

    fitted, floor = mean_distance(found), mean_distance(truth)
    record = {
        "case": name,
        "solver": solver,
        "metric": metric,
        "light": light,
        "ratio": round(fitted / floor, 3),
        "M_fit": round(fitted, 4),
        "M_other_seed": round(floor, 4),
        "seconds": round(result.seconds, 1),
        "evaluations": result.evaluations,
        "true": _numbers(truth),
        "found": _numbers(found),
    }
    if result.heights is not None:
        record["heights"] = height_record(
            result.heights, found.relief.amplitude, deviation(truth, light) / deviation(found, light)
        )
    return record, np.concatenate([pixels, photo_of(found, light)], axis=1)


def deviation(detail: Detail, light: str) -> float:
    """Return the standard deviation of the relief in scene units, which other ranks have at another amplitude."""
    surface = build(_setup(light, "default", "combined", None), (SIDE, SIDE), (0, 0, SIDE, SIDE))
    assert isinstance(surface, HeightField)
    surface.update(detail)
    return float(heights_of(surface).std())


def _numbers(detail: Detail) -> dict[str, Any]:
    noise = detail.noise
    # f along one axis and 1/f across it are the same stretch, turned by a quarter; the larger is reported.
    stretch = max(noise.anisotropy, 1 / noise.anisotropy)
    return {
        "ranks": [noise.first_neighbour, noise.last_neighbour],
        "octaves": noise.octaves,
        "envelope": noise.envelope,
        "scale": round(noise.scale * math.sqrt(noise.anisotropy), 2),
        "amplitude": round(detail.relief.amplitude, 4),
        "anisotropy": round(stretch, 3),
        "stripes": round(noise.stripe_frequency, 2),
    }


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("-o", "--output", type=Path, default=Path("results/recovery"))
    parser.add_argument("--case", choices=NAMES, action="append")
    parser.add_argument("--solver", action="append")
    parser.add_argument("--metric", default="combined")
    parser.add_argument("--evaluations", type=int)
    arguments = parser.parse_args()
    mitsuba()
    arguments.output.mkdir(parents=True, exist_ok=True)
    records, rows = [], []
    for solver in arguments.solver or ["default", "paper"]:
        for name in arguments.case or NAMES:
            record, pair = run_case(name, solver, arguments.metric, arguments.evaluations)
            records.append(record)
            print(json.dumps({k: record[k] for k in ("case", "solver", "ratio", "M_fit", "M_other_seed", "seconds")}), flush=True)
            if solver == "default":
                rows.append(pair)
    summary = {
        solver: {
            "median_ratio": round(float(np.median(ratios)), 3),
            "worst_ratio": round(max(ratios), 3),
            "median_seconds": round(float(np.median([r["seconds"] for r in records if r["solver"] == solver])), 1),
        }
        for solver in {r["solver"] for r in records}
        if (ratios := [r["ratio"] for r in records if r["solver"] == solver])
    }
    print(json.dumps(summary))
    if not arguments.case:
        write_text(arguments.output / "recovery.json", json.dumps({"summary": summary, "cases": records}, indent=1) + "\n")
        grid = [np.concatenate(rows[i : i + 3], axis=1) for i in range(0, len(rows), 3)]
        if grid:
            keep_linear(arguments.output / "recovery.jpg", np.concatenate(grid))


if __name__ == "__main__":
    main()
