"""The colour of fitted details: each kind beside the photograph, on the relief that was fitted to it.

Run with:  python -m tests.benchmarks.colour_details -o results/colour [--only NAME ...] [--unshown FOLDER]
The details of results/fits, which have one tint, are coloured by example, with height, by the cell, and as `auto` chooses.
A row: the photo, one tint, by example, with height, by the cell, and a sphere as chosen. Numbers: the distance of colours
(fit.colour) over seeds that nothing was fitted to, and that between the photo's halves.
"""

from __future__ import annotations

import argparse
import json
import time
from pathlib import Path
from typing import Any

import numpy as np

from tests.benchmarks.photographs import PHOTOGRAPHS, Photograph, is_there, setup_of
from tests.benchmarks.relit import Picture, markdown, save_sheet
from voldetail.apply import render
from voldetail.detail import load_detail, save_detail
from voldetail.files import write_text
from voldetail.fit.colour import ColourDistance, choose_colour
from voldetail.fit.fitter import COLOUR_SEEDS
from voldetail.fit.objective import Objective
from voldetail.fit.session import derived_seed
from voldetail.fit.target import make_target
from voldetail.image import resize
from voldetail.render.build import build

FITS = Path("results/fits")
KINDS = ("none", "by-example", "height", "cell")


def run(photograph: Photograph, output: Path | None) -> tuple[dict[str, Any], list[Picture]]:
    """Colour the detail of one photograph; returns its numbers and its row of the sheet."""
    setup = setup_of(photograph)
    target = make_target(setup)
    objective = Objective(target, build(setup, target.shape, target.zone), specular=setup.fit.specular)
    detail = load_detail(FITS / photograph.name / "detail.json")
    judges, shading = ([derived_seed(setup.seed, f"{name}/{i}") for i in range(COLOUR_SEEDS)] for name in ("colour", "shading"))
    row = [target.pixels]
    for kind in KINDS:
        row.append(choose_colour(objective, detail, kind, judges, shading).picture)
    began = time.monotonic()
    chosen = choose_colour(objective, detail, "auto", judges, shading, photograph.name)
    seconds = time.monotonic() - began
    rows, columns = target.mask.shape
    side = min(rows, columns)
    row.append(resize(render(chosen.detail, "sphere", size=(side, side)), (rows, columns)))
    if output is not None:
        save_detail(output / f"{photograph.name}.json", chosen.detail)
    half = columns // 2
    left, right = (np.ascontiguousarray(target.pixels[:, part]) for part in (slice(None, half), slice(-half, None)))
    marks = [np.ascontiguousarray(target.mask[:, part]) for part in (slice(None, half), slice(-half, None))]
    halves = ColourDistance(left, marks[0], setup.fit.metric)(right, marks[1])
    record = {
        "photo": photograph.name,
        "credit": photograph.credit,
        "chosen": chosen.chosen,
        "seconds": round(seconds, 2),
        "halves": round(halves, 3),
        "distances": {k: round(v, 3) for k, v in chosen.distances.items()},
    }
    return record, row


def table(records: list[dict[str, Any]]) -> str:
    """One row a photograph."""
    names = ("none", "noise", "height", "hollow", "cell")
    rows = []
    for r in records:
        far = (f"{r['distances'][n]:.2f}" if n in r["distances"] else "grey" for n in names)
        rows.append([r["photo"], r["chosen"], f"{r['halves']:.2f}", *far])
    return markdown(["photo", "chosen", "its halves", "one tint", "by example", "height", "hollows", "cell"], rows)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("-o", "--output", type=Path, default=Path("results/colour"))
    parser.add_argument("--unshown", type=Path)
    parser.add_argument("--only", action="append", choices=[p.name for p in PHOTOGRAPHS])
    arguments = parser.parse_args()
    records: list[dict[str, Any]] = []
    shown: list[list[Picture]] = []
    unshown: list[list[Picture]] = []
    (arguments.output / "details").mkdir(parents=True, exist_ok=True)
    for photograph in PHOTOGRAPHS:
        if (arguments.only and photograph.name not in arguments.only) or not is_there(photograph):
            continue
        record, row = run(photograph, arguments.output / "details" if photograph.shown else None)
        records.append(record)
        (shown if photograph.shown else unshown).append(row)
        print(json.dumps(record), flush=True)
    print(table(records))
    for folder, rows in ((arguments.output, shown), (arguments.unshown, unshown)):
        if folder is not None and rows:
            folder.mkdir(parents=True, exist_ok=True)
            save_sheet(folder / "details.jpg", rows)
    if not arguments.only:
        write_text(arguments.output / "details.json", json.dumps(records, indent=1) + "\n")
        write_text(arguments.output / "details.md", table(records))


if __name__ == "__main__":
    main()
