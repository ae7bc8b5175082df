"""Stationary tiles against plain toroidal PatchMatch: the costs of MJHRW17 figures 3 and 4, and sheets to look at.

Run with:  python -m tests.benchmarks.stationarize -o results/stationarize [--photos N] [--seeds K] [--size S]
           [--only NAME ...] [--sheets] [--summary-only]
Each photograph's numbers are written when they are known, and what is there already is not computed again: the whole
(about 50 photographs, 10 seeds, two ways) takes several hours on two cores and can be run in parts. The photographs are
read from ../shared/data. Sheets are drawn only of those whose licence lets them be shown.
"""

from __future__ import annotations

import argparse
import json
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tests.benchmarks.stationarize_photos import ONLY_SHOWN, Photograph, pixels, there
from tests.benchmarks.stationarize_sheets import sheet
from tests.benchmarks.stationarize_summary import summarise
from voldetail.files import write_text
from voldetail.stationary.colour import to_lab
from voldetail.stationary.measure import Measure, mean_difference
from voldetail.stationary.tile import Tile, TileProgress, stationarize

WAYS: dict[str, Measure | None] = {"plain": None, "histogram": "histogram"}
SAMPLE = 4096  # pixels of a photograph, for the scale of the stationarity cost


def scales(picture: NDArray[np.float32]) -> dict[str, float]:
    """What the two costs are divided by before they are added (their units differ, and the paper names no weights).

    The texture cost by the photo's variance: 1 is a tile that has nothing of it. The stationarity cost by the mean
    difference of two of its pixels: 1 is the earth mover's distance if no two places had a colour in common.
    """
    lab = to_lab(picture).reshape(-1, 3).astype(np.float64)
    some = lab[np.random.default_rng(0).integers(0, len(lab), SAMPLE)]
    share = np.full(SAMPLE, 1 / SAMPLE)
    spread = sum(float((mean_difference(some[:, c], share) * share).sum()) for c in range(3))
    return {"texture": float(lab.var(axis=0).sum()), "stationarity": spread}


def make(picture: NDArray[np.float32], way: str, seed: int, size: int, trace: list[TileProgress] | None = None) -> Tile:
    """A tile by one of WAYS; with `trace`, all progress with its costs is appended to it."""
    tell = trace.append if trace is not None else None
    return stationarize(picture, size, WAYS[way], seed=seed, with_costs=trace is not None, on_progress=tell)


def measured(photograph: Photograph, path: Path, seeds: int, size: int) -> dict[str, Any]:
    """The record of one photograph, from `path` as far as it is there, and written to it after each seed."""
    record: dict[str, Any] = json.loads(path.read_text()) if path.exists() else {}
    picture = pixels(photograph)
    if record.get("size") != size:
        record = {"name": photograph.name, "size": size, "scales": scales(picture), "seeds": {}, "trace": {}}
    for seed in range(seeds):
        if str(seed) in record["seeds"]:
            continue
        found = {}
        for way in WAYS:
            trace: list[TileProgress] | None = [] if seed == 0 else None
            tile = make(picture, way, seed, size, trace)
            found[way] = {
                "texture": round(tile.costs.texture, 4), "stationarity": round(tile.costs.stationarity, 4),
                "seconds": round(tile.seconds, 1),
            }  # fmt: skip
            if trace:
                record["trace"][way] = [
                    [round(p.costs.texture, 3), round(p.costs.stationarity, 3)] for p in trace if p.costs is not None
                ]
        record["seeds"][str(seed)] = found
        write_text(path, json.dumps(record, indent=1) + "\n")
        print(photograph.name, seed, found, flush=True)
    return record


def best_seed(record: dict[str, Any]) -> int:
    """The seed with which plain PatchMatch is most stationary (MJHRW17 section 5.2: its advantage)."""
    return int(min(record["seeds"], key=lambda seed: record["seeds"][seed]["plain"]["stationarity"]))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("-o", "--output", type=Path, default=Path("results/stationarize"))
    parser.add_argument("--photos", type=int, help="so many, evenly chosen (default: all)")
    parser.add_argument("--seeds", type=int, default=10)
    parser.add_argument("--size", type=int, default=256)
    parser.add_argument("--only", nargs="+", default=[], help="names of photographs")
    parser.add_argument("--sheets", action="store_true", help="draw the sheets too (two more tiles a photograph)")
    parser.add_argument("--summary-only", action="store_true", help="of the records that are there")
    options = parser.parse_args()
    records = options.output / "records"
    records.mkdir(parents=True, exist_ok=True)
    chosen = [p for p in there(options.size) if not options.only or p.name in options.only]
    # What is drawn only keeps its numbers apart: the figures are of the same photographs whatever is shown.
    drawn = [p for p in ONLY_SHOWN if p.name in options.only]
    (records / "drawn").mkdir(exist_ok=True)
    if options.photos and options.photos < len(chosen):
        chosen = [chosen[i] for i in np.linspace(0, len(chosen) - 1, options.photos).round().astype(int)]
    for photograph in [] if options.summary_only else [*chosen, *drawn]:
        folder = records / "drawn" if options.only else records
        record = measured(photograph, folder / f"{photograph.name}.json", options.seeds, options.size)
        if options.sheets and photograph.credit:
            picture, seed = pixels(photograph), best_seed(record)
            tiles = {way: make(picture, way, seed, options.size).tile for way in WAYS}
            sheet(options.output / f"{photograph.name}.jpg", photograph, picture, tiles, seed)
    found = [json.loads(path.read_text()) for path in sorted(records.glob("*.json"))]
    if found:
        summarise(options.output, found, best_seed)


if __name__ == "__main__":
    main()
