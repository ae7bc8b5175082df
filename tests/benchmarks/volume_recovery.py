"""Recovery of volumes: details drawn at random are rendered to "photos" and fitted again under the right light.

Run with:  python -m tests.benchmarks.volume_recovery -o results/volume [--case NAME] [--look surface|medium]
Named seeds; half of the cases are on a plane that fills the photo, half on an ellipsoid in front of a grey background, of
which the middle is used where it is solid, as a user would mark it (GD10 section 3).
The ratio is the mean distance of three other seeds of what was found from the photo, over that of the truth.
"""

from __future__ import annotations

import argparse
import json
import math
import tempfile
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from tests.benchmarks.kept import keep_linear
from tests.benchmarks.recovery import OTHER_SEEDS, RANKS, SIDE
from voldetail.backend import mitsuba
from voldetail.detail import Detail, Reflectance, rounded
from voldetail.files import write_text
from voldetail.fit import fit
from voldetail.fit.ranges import MEDIUM_ROUGHNESS
from voldetail.fit.resolvable import DEEPEST
from voldetail.fit.session import derived_seed
from voldetail.fit.space import Kind, Space
from voldetail.image import Photo, luminance, save_png, to_linear, to_srgb
from voldetail.metric import describe, distance
from voldetail.render.build import build
from voldetail.render.unit_components import components
from voldetail.setup.file import setup_from
from voldetail.setup.light import lamp_of
from voldetail.setup.setup import Setup

Look = Literal["surface", "medium"]
CASES: dict[Look, tuple[str, ...]] = {
    "surface": ("basalt", "chalk", "flint", "gneiss", "marl", "pumice", "slate", "tuff"),
    "medium": ("altus", "cirrus", "cumulus", "fog", "nimbus", "plume", "stratus", "veil"),
}
BACKGROUND = 0.25
ELLIPSOID = (1.8, 1.4, 1.4)
MIDDLE = 0.85


def truth_of(name: str, look: Look) -> tuple[Detail, Setup]:
    """Return the detail and the setup of a named case: ranks, stripes and numbers drawn at random."""
    draw = np.random.default_rng(derived_seed(2010, name))
    first, last = RANKS[draw.integers(4)] if look == "surface" else RANKS[draw.integers(2)]
    kind = Kind(first, last, str(draw.choice(["gaussian", "exponential"])), int(draw.integers(1, 4)), bool(draw.random() < 0.25))
    medium = look == "medium"
    space = Space(
        domain="solid",
        scale=(3.0, 8.0) if medium else (5.0, 16.0),
        finest=1.0 / (1.6 * 2 * (4 if medium else 2) / SIDE),
        roughness=(0.5, 1.8) if medium else (0.15, 1.0),
        anisotropy=(0.5, 2.0),
        mode="volume",
        medium=medium,
        highest=0.8 * DEEPEST * 2.0,
    )
    assert not medium or (MEDIUM_ROUGHNESS[0] <= space.roughness[0] and space.roughness[1] <= MEDIUM_ROUGHNESS[1])
    # Within the middle of what is searched, so that a truth is not beside a bound.
    vector = 0.15 + 0.7 * draw.random(len(space.names(kind)))
    detail = space.decode(kind, vector)
    reflectance = Reflectance(
        ambient=float(draw.uniform(0.05, 0.3)),
        diffuse=float(draw.uniform(0.3, 0.6) * (1.5 if medium else 1.0)),
        specular=0.0,
        shininess=16.0,
    )
    light = f"{draw.uniform(0, 360):.0f},{draw.uniform(30, 60):.0f}"
    round_one = CASES[look].index(name) % 2 == 1
    proxy = {"kind": "ellipsoid", "size": ELLIPSOID} if round_one else {"kind": "plane"}
    setup = setup_from(
        {
            "photo": {"path": "rendered.png", "resolution": SIDE, "zone": [0, 0, SIDE, SIDE]},
            "light": light,
            "proxy": proxy,
            "mode": "volume",
            "look": look,
        },
        "recovery",
    )
    seed = derived_seed(2010, f"{name}/truth")
    return rounded(detail.model_copy(update={"reflectance": reflectance, "seed": seed})), setup


def photo_of(detail: Detail, setup: Setup, seed: int | None = None) -> NDArray[np.float32]:
    """Return the 8-bit "photo" of a detail, decoded to linear light, its background BACKGROUND."""
    surface = build(setup, (SIDE, SIDE), (0, 0, SIDE, SIDE))
    surface.update(detail if seed is None else detail.model_copy(update={"seed": seed}))
    parts = components(surface, lamp_of(setup.light), subsamples=2, shininess=(detail.reflectance.shininess,))
    colour = parts.colour(detail.reflectance, BACKGROUND)
    encoded = np.round(to_srgb(np.clip(colour, 0, 1)) * 255) / 255
    return np.asarray(to_linear(encoded.astype(np.float32)), dtype=np.float32)


def run_case(name: str, look: Look, evaluations: int | None) -> tuple[dict[str, Any], NDArray[np.float32]]:
    """Fit one case; returns its record, and the photo and the fit side by side."""
    truth, setup = truth_of(name, look)
    pixels = photo_of(truth, setup)
    changed: dict[str, Any] = {"fit": setup.fit.model_copy(update={"evaluations": evaluations})}
    mask = None
    with tempfile.TemporaryDirectory() as folder:
        if look == "surface" and setup.proxy.kind != "plane":
            mask = middle_of(setup)
            changed["mask"] = Path(folder) / "mask.png"
            save_png(changed["mask"], np.repeat(mask[..., None].astype(np.float32), 3, axis=2))
        result = fit(setup.model_copy(update=changed), photo=Photo(pixels, "0" * 64, ()))
    found = result.detail
    reference = describe(luminance(pixels), mask, metric=setup.fit.metric)

    def mean_distance(detail: Detail) -> float:
        seeds = [derived_seed(7, f"{name}/{index}") for index in range(OTHER_SEEDS)]
        seen = [luminance(photo_of(detail, setup, seed)) for seed in seeds]
        return float(np.mean([distance(reference, describe(picture, mask, like=reference)) for picture in seen]))

    fitted, floor = mean_distance(found), mean_distance(truth)
    record = {
        "case": name, "look": look, "proxy": setup.proxy.kind, "ratio": round(fitted / floor, 3), "M_fit": round(fitted, 4),
        "M_other_seed": round(floor, 4), "seconds": round(result.seconds, 1), "evaluations": result.evaluations,
        "true": numbers_of(truth), "found": numbers_of(found),
    }  # fmt: skip
    return record, np.concatenate([pixels, photo_of(found, setup)], axis=1)


def middle_of(setup: Setup) -> NDArray[np.bool_]:
    """Return the pixels (H, W) in the middle of the ellipsoid, away from its outline."""
    place = (np.arange(SIDE) + 0.5) / SIDE * 2.0 - 1.0
    w, h, _ = setup.proxy.extent
    return np.asarray(np.hypot(place[None, :] / (w / 2), place[:, None] / (h / 2)) < MIDDLE)


def numbers_of(detail: Detail) -> dict[str, Any]:
    """Return what may be compared of a detail."""
    noise = detail.noise
    numbers: dict[str, Any] = {
        "ranks": [noise.first_neighbour, noise.last_neighbour], "octaves": noise.octaves,
        "scale": round(noise.scale * math.sqrt(noise.anisotropy), 2), "amplitude": round(detail.relief.amplitude, 4),
        "stripes": round(noise.stripe_frequency, 2),
    }  # fmt: skip
    if detail.medium is not None:
        numbers |= {name: round(value, 3) for name, value in detail.medium.model_dump().items() if name != "albedo"}
        numbers["depth"] = round(detail.medium.extinction * detail.relief.amplitude, 2)
    return numbers


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("-o", "--output", type=Path, default=Path("results/volume"))
    parser.add_argument("--case", action="append")
    parser.add_argument("--look", choices=list(CASES), action="append")
    parser.add_argument("--evaluations", type=int)
    arguments = parser.parse_args()
    mitsuba()
    arguments.output.mkdir(parents=True, exist_ok=True)
    summary: dict[str, Any] = {}
    records: list[dict[str, Any]] = []
    for look in arguments.look or CASES:
        rows, ratios, seconds = [], [], []
        for name in arguments.case or CASES[look]:
            if name not in CASES[look]:
                continue
            record, pair = run_case(name, look, arguments.evaluations)
            print(json.dumps(record), flush=True)
            records.append(record)
            rows.append(pair)
            ratios.append(record["ratio"])
            seconds.append(record["seconds"])
        if rows:
            summary[look] = {
                "median_ratio": round(float(np.median(ratios)), 3),
                "worst_ratio": max(ratios),
                "median_seconds": round(float(np.median(seconds)), 1),
            }
            grid = [np.concatenate(rows[i : i + 2], axis=1) for i in range(0, len(rows) - len(rows) % 2, 2)] or rows
            keep_linear(arguments.output / f"recovery_{look}.jpg", np.concatenate(grid))
    print(json.dumps(summary))
    if not arguments.case and not arguments.look:
        text = json.dumps({"summary": summary, "cases": records}, indent=1)
        write_text(arguments.output / "recovery.json", text + "\n")


if __name__ == "__main__":
    main()
