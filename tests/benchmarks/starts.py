"""Fits with and without the library of reliefs, in one run: how near, how long, and how soon they are as near as each other.

Run with:  python -m tests.benchmarks.starts -o results/starts [--only NAME ...]
The photographs are those of tests.benchmarks.photographs; the library is made in the user's cache where it is not there, which
is timed apart. Colours are not looked for. What is in the results already is not run again.
"""

from __future__ import annotations

import argparse
import json
import time
from pathlib import Path
from statistics import median
from typing import Any
from unittest.mock import patch

from PIL import Image

from tests.benchmarks.kept import keep
from tests.benchmarks.photographs import PHOTOGRAPHS, Photograph, is_there, setup_of
from voldetail.backend import mitsuba
from voldetail.files import write_text
from voldetail.fit import FitResult, fit
from voldetail.fit.session import Progress
from voldetail.fit.warmstart import starts_from
from voldetail.image import resize, to_srgb

SIDE = 150
"""Pixels of a picture on the sheet."""

Curve = list[tuple[float, float]]


def run(photograph: Photograph, library: str) -> tuple[dict[str, Any], FitResult]:
    """Fit a photograph; returns its record and the result."""
    setup = setup_of(photograph, library=library).model_copy(update={"colour": "none"})
    curve: Curve = []
    asked: list[float] = []

    def timed(*given: Any, **more: Any) -> Any:
        begun = time.perf_counter()
        starts = starts_from(*given, **more)
        asked.append(time.perf_counter() - begun)
        return starts

    def on_progress(progress: Progress) -> None:
        if progress.best < (curve[-1][1] if curve else float("inf")):
            curve.append((round(progress.seconds, 2), progress.best))

    begun = time.perf_counter()
    with patch("voldetail.fit.fitter.starts_from", timed):
        result = fit(setup, on_progress=on_progress)
    record = {
        "M": round(result.distance, 3), "seconds": round(time.perf_counter() - begun, 1), "evaluations": result.evaluations,
        "library": round(sum(asked), 2), "curve": [[at, round(best, 3)] for at, best in curve],
    }  # fmt: skip
    return record, result


def until(curve: Curve, distance: float) -> float:
    """Return the seconds until a search was as near as ``distance``."""
    return next((at for at, best in curve if best <= distance), curve[-1][0])


def summary(records: dict[str, dict[str, Any]]) -> dict[str, Any]:
    ratios, nearer, seconds = [], [], {"library": [], "none": []}  # type: ignore[var-annotated]
    for record in records.values():
        told, alone = record["library"], record["none"]
        same = max(told["curve"][-1][1], alone["curve"][-1][1])
        ratios.append(until(alone["curve"], same) / until(told["curve"], same))
        nearer.append(told["M"] / alone["M"])
        for how, numbers in seconds.items():
            numbers.append(round(record[how]["seconds"] - record[how]["library"], 1))
    return {
        "photographs": len(records),
        "seconds but for the library's, median": {how: median(numbers) for how, numbers in seconds.items()},
        "M with over M without, median": round(median(nearer), 3), "nearer with": sum(ratio < 1 for ratio in nearer),
        "time to the same distance without over with, median": round(median(ratios), 2),
        "of each": {name: round(ratio, 2) for name, ratio in zip(records, ratios, strict=True)},
    }  # fmt: skip


def strip(photograph: Photograph, results: list[FitResult]) -> Image.Image:
    """The photo's zone, the fit with and the fit without, side by side."""
    pictures = [results[0].target.luminance, *(result.picture for result in results)]
    sheet = Image.new("L", (len(pictures) * (SIDE + 4), SIDE + 4), 255)
    for k, picture in enumerate(pictures):
        small = to_srgb(resize(picture, (SIDE, SIDE)).clip(0, 1)) * 255
        sheet.paste(Image.fromarray(small.astype("uint8")), (k * (SIDE + 4), 0))
    return sheet


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("-o", "--output", type=Path, required=True)
    parser.add_argument("--only", nargs="+", help="names of photographs")
    options = parser.parse_args()
    mitsuba()
    options.output.mkdir(parents=True, exist_ok=True)
    path = options.output / "starts.json"
    records = json.loads(path.read_text())["photographs"] if path.exists() else {}
    for photograph in PHOTOGRAPHS:
        if not is_there(photograph) or photograph.name in records or photograph.name not in (options.only or [photograph.name]):
            continue
        told, with_library = run(photograph, "auto")
        alone, without = run(photograph, "none")
        records[photograph.name] = {"library": told, "none": alone}
        print(photograph.name, {how: {k: v for k, v in r.items() if k != "curve"} for how, r in records[photograph.name].items()})
        write_text(path, json.dumps({"summary": summary(records), "photographs": records}, indent=1) + "\n")
        if photograph.shown:
            keep(options.output / f"{photograph.name}.jpg", strip(photograph, [with_library, without]))
    print(json.dumps(summary(records), indent=1))


if __name__ == "__main__":
    main()
