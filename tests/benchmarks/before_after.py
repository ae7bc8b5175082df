"""Each photograph before and after: GD10 as published, and what is the default now.

Run with:  python -m tests.benchmarks.before_after -o results/fits [--only NAME ...]
Before: the paper's noise, metric and search (`--solver paper --metric published`), with at most as many evaluations as the
default has. After: the details that tests.benchmarks.photographs left in the same folder. Same zone, light and seed. Both are
compared with the photo under both metrics; "patches", which took part in neither fit, is a third judge.
"""

from __future__ import annotations

import argparse
import json
from pathlib import Path
from typing import Any

import numpy as np

from tests.benchmarks.photographs import PHOTOGRAPHS, Photograph, is_there, setup_of
from tests.benchmarks.relit import Picture, lit_picture, markdown, save_sheet
from tests.benchmarks.yardsticks import reference
from voldetail.backend import mitsuba
from voldetail.detail import Detail, load_detail, save_detail
from voldetail.files import write_text
from voldetail.fit import fit
from voldetail.fit.target import make_target
from voldetail.image import luminance
from voldetail.render.build import build
from voldetail.render.heightfield import HeightField
from voldetail.results import Target
from voldetail.setup.setup import Setup

METRICS = ("published", "combined", "patches")


def picture_of(detail: Detail, setup: Setup, target: Target) -> Picture:
    """Return a detail as the photo's zone, burnt out where the photo is."""
    surface = build(setup, target.shape, target.zone)
    assert isinstance(surface, HeightField)
    surface.update(detail)
    return np.minimum(lit_picture(surface, target.lamp, detail.reflectance), target.white).astype(np.float32)


def distances(picture: Picture, target: Target) -> dict[str, float]:
    """Return the distance of a picture from the photo under each of METRICS."""
    mask = None if target.mask.all() else target.mask
    found = {}
    for metric in METRICS:
        found[metric] = round(reference(target.luminance, metric, mask).distance(luminance(picture), mask), 4)
    return found


def run(photograph: Photograph, folder: Path, evaluations: int | None) -> tuple[dict[str, Any], list[Picture]]:
    """Fit one photograph as before, and compare; returns the record and photo, before and after."""
    after = load_detail(folder / photograph.name / "detail.json")
    assert after.provenance is not None
    setup = setup_of(photograph, solver="paper", metric="published", evaluations=evaluations or after.provenance.evaluations)
    result = fit(setup)
    save_detail(folder / photograph.name / "before.json", result.detail)
    target = make_target(setup)
    pictures = {"before": picture_of(result.detail, setup, target), "after": picture_of(after, setup, target)}
    record = {
        "name": photograph.name,
        "evaluations": result.evaluations,
        "seconds": {"before": round(result.seconds, 1), "after": after.provenance.seconds},
        "distances": {name: distances(picture, target) for name, picture in pictures.items()},
    }
    return record, [target.pixels, pictures["before"], pictures["after"]]


def table(records: list[dict[str, Any]]) -> str:
    """The distances of all photographs, before and after."""
    rows = []
    for record in records:
        pairs = [f"{record['distances']['before'][m]:.3g} / {record['distances']['after'][m]:.3g}" for m in METRICS]
        rows.append([record["name"], *pairs, f"{record['seconds']['before']:.0f} / {record['seconds']['after']:.0f}"])
    return markdown(["photograph", *(f"`{metric}`" for metric in METRICS), "seconds"], rows)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("-o", "--output", type=Path, default=Path("results/fits"))
    parser.add_argument("--unshown", type=Path)
    parser.add_argument("--only", action="append")
    parser.add_argument("--evaluations", type=int)
    arguments = parser.parse_args()
    mitsuba()
    records = []
    for photograph in PHOTOGRAPHS:
        if not is_there(photograph) or (arguments.only and photograph.name not in arguments.only):
            continue
        record, pictures = run(photograph, arguments.output, arguments.evaluations)
        records.append(record)
        print(json.dumps(record), flush=True)
        place = arguments.output if photograph.shown else arguments.unshown
        if place is not None:
            save_sheet(place / photograph.name / "before_after.jpg", [pictures])
    print(table(records))
    if not arguments.only:
        write_text(arguments.output / "before_after.json", json.dumps(records, indent=1) + "\n")
        write_text(arguments.output / "before_after.md", table(records))


if __name__ == "__main__":
    main()
