"""What an even picture is worth to a fit: uneven photographs, fitted as they are and evened, held against an even part.

Run with:  python -m tests.benchmarks.stationarize_fits -o results/stationarize [--evaluations N]
Five photographs whose stains or shading differ from side to side. Of each a large zone is fitted twice, as it is and with
`stationarize`; both details are rendered on seeds of their own and compared by the metric with the photo's most even part of
half the size, at the same pixels per cell, in units of that part's own halves. The lights are guesses, the same for both.
"""

from __future__ import annotations

import argparse
import json
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tests.benchmarks.relit import SHARED, Picture, markdown, save_sheet
from voldetail.files import write_text
from voldetail.fit import fit
from voldetail.fit.evenness import unevenness
from voldetail.fit.objective import Objective
from voldetail.fit.session import derived_seed
from voldetail.fit.target import halves_apart, make_target
from voldetail.image import load_photo, luminance, resize
from voldetail.metric import describe, distance
from voldetail.render.build import build
from voldetail.setup.file import setup_from
from voldetail.setup.setup import Setup
from voldetail.setup.view import Zone

FOLDER = SHARED / "textures" / "nonstationary_zhou2018"
PHOTOGRAPHS = (("200", "135,45"), ("222", "135,45"), ("27", "135,45"), ("72", "135,45"), ("415", "135,45"))
"""Numbers in the collection, each with u from 0.44 to 0.73, and guessed lights."""

RESOLUTION = 192
PLACES = 7
SEEDS = 3


def most_even(pixels: NDArray[np.float32], side: int) -> tuple[int, int]:
    """Return the row and column of the most even square of ``side`` pixels."""
    rows, columns = pixels.shape[:2]
    best: tuple[float, int, int] = (np.inf, 0, 0)
    for y in np.linspace(0, rows - side, PLACES).astype(int):
        for x in np.linspace(0, columns - side, PLACES).astype(int):
            found = unevenness(pixels[y : y + side, x : x + side], np.ones((side, side), bool))
            best = min(best, (np.inf if found is None else found, int(y), int(x)))
    return best[1], best[2]


def run(name: str, light: str, evaluations: int | None) -> tuple[dict[str, Any], list[Picture]]:
    """Fit one photograph both ways; returns its numbers and its row: photo, even part, as it is, even picture, evened."""
    path = FOLDER / f"{name}.jpg"
    photo = load_photo(path)
    side = min(photo.pixels.shape[:2])
    zone: Zone = ((photo.pixels.shape[1] - side) // 2, (photo.pixels.shape[0] - side) // 2, side, side)

    def setup_of(even: bool) -> Setup:
        source = {"path": str(path), "zone": zone, "resolution": RESOLUTION, "stationarize": even}
        settings = {"evaluations": evaluations, "library": "none"}
        return setup_from({"photo": source, "light": light, "colour": "none", "fit": settings}, name)

    plain = make_target(setup_of(False), photo)
    half = RESOLUTION // 2
    y, x = most_even(plain.pixels, half)
    part = np.ascontiguousarray(luminance(plain.pixels[y : y + half, x : x + half]))
    own = describe(part, None)
    halves = halves_apart(part, np.ones_like(part, bool), "combined")
    assert halves is not None
    row, far, seconds = [plain.pixels, resize(plain.pixels[y : y + half, x : x + half], (RESOLUTION, RESOLUTION))], {}, {}
    for way, even in (("as it is", False), ("evened", True)):
        setup = setup_of(even)
        result = fit(setup, photo=photo)
        objective = Objective(result.target, build(setup, result.target.shape, result.target.zone), specular=setup.fit.specular)
        pictures = [objective.evaluate(result.detail, derived_seed(setup.seed, f"even/{i}")).picture for i in range(SEEDS)]
        crops = [p[a : a + half, b : b + half] for p in pictures for a in (0, half) for b in (0, half)]
        # At the part's own mean: that a photo's other parts are darker is not the relief's fault.
        values = [distance(own, describe(np.ascontiguousarray(c * (part.mean() / c.mean())), None, like=own)) for c in crops]
        far[way], seconds[way] = round(float(np.median(values)) / halves, 3), round(result.seconds, 1)
        row += ([result.target.pixels] if even else []) + [result.coloured]
    record = {
        "photo": name,
        "unevenness": round(plain.unevenness or 0.0, 3),
        "distance": far,
        "seconds": seconds,
        "part": [y, x, half],
    }
    return record, row


def table(records: list[dict[str, Any]]) -> str:
    """One row a photograph."""
    rows = [[r["photo"], f"{r['unevenness']:.2f}", *(f"{v:.2f}" for v in r["distance"].values())] for r in records]
    return markdown(["photo", "unevenness", "fitted as it is", "fitted evened"], rows)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("-o", "--output", type=Path, default=Path("results/stationarize"))
    parser.add_argument("--unshown", type=Path)
    parser.add_argument("--evaluations", type=int)
    arguments = parser.parse_args()
    records: list[dict[str, Any]] = []
    rows: list[list[Picture]] = []
    for name, light in PHOTOGRAPHS:
        if not (FOLDER / f"{name}.jpg").exists():
            continue
        record, row = run(name, light, arguments.evaluations)
        records.append(record)
        rows.append(row)
        print(json.dumps(record), flush=True)
    print(table(records))
    if arguments.unshown is not None:
        save_sheet(arguments.unshown / "fits.jpg", rows)
    write_text(arguments.output / "fits.json", json.dumps(records, indent=1) + "\n")
    write_text(arguments.output / "fits.md", table(records))


if __name__ == "__main__":
    main()
