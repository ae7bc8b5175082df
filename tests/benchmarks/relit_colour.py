"""Colour under unseen lights: what a detail's colour by example is worth, with the relief's shading taken out of it or left in.

Run with:  python -m tests.benchmarks.relit_colour -o results/colour [--only NAME ...] [--evaluations N]
The coloured captures of `heldout_light`: one photo is fitted, its colour learnt in four ways on the one relief (one tint;
by example; by example from the photo as it is, "undivided"; what `auto` chooses), and each rendered under the capture's
other lights, at the photo's mean luminance. Compared with the photo there: `chromaticity`, how far apart the mean colours
are in CIE 1976 u'v' (0.004 is just seen); `contrast`, the ratio of the deviations of log luminance, 1 is right, above it
shading is there twice; `colour`, the metric channel by channel in units of the photo's own halves.
"""

from __future__ import annotations

import argparse
import json
from pathlib import Path
from typing import Any

import numpy as np

from tests.benchmarks.heldout_light import CAPTURES, MULTILIGHT, Capture, flash, mask_of
from tests.benchmarks.relit import SUBSAMPLES, Picture, markdown, save_sheet
from voldetail.detail import Detail
from voldetail.files import write_text
from voldetail.fit import fit
from voldetail.fit.colour import ColourDistance, choose_colour
from voldetail.fit.fitter import COLOUR_SEEDS
from voldetail.fit.objective import Objective
from voldetail.fit.session import derived_seed
from voldetail.fit.target import make_target
from voldetail.image import luminance
from voldetail.render.build import build
from voldetail.render.unit_components import components
from voldetail.results import Target
from voldetail.setup.file import setup_from
from voldetail.setup.lamp import Lamp
from voldetail.setup.light import Light
from voldetail.setup.setup import Setup
from voldetail.setup.view import Zone

WAYS = ("one tint", "by example", "undivided", "auto")
COLOURED = tuple(c for c in CAPTURES if c.name not in ("dea_squeeze_1",))
MEASURES = ("chromaticity", "contrast", "colour")


def uv(pixels: Picture) -> np.ndarray[Any, Any]:
    """Return the CIE 1976 u'v' of a mean colour, from linear sRGB (IEC 61966-2-1's matrix)."""
    matrix = np.array([[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]])
    x, y, z = matrix @ pixels.reshape(-1, 3).mean(axis=0)
    return np.array([4.0 * x, 9.0 * y]) / (x + 15.0 * y + 3.0 * z)


def ways_of(objective: Objective, detail: Detail, seed: int) -> dict[str, tuple[Detail, str]]:
    """Return the detail in each way's colour, and what was chosen."""
    judges, shading = ([derived_seed(seed, f"{name}/{i}") for i in range(COLOUR_SEEDS)] for name in ("colour", "shading"))
    found = {"one tint": (detail, "none")}
    for way, colour, shadings in (
        ("by example", "by-example", shading),
        ("undivided", "by-example", []),
        ("auto", "auto", shading),
    ):
        choice = choose_colour(objective, detail, colour, judges, shadings)
        found[way] = choice.detail, choice.chosen
    return found


def run(capture: Capture, evaluations: int | None, sheets: Path | None) -> dict[str, Any]:
    """Fit one photo of a capture, colour it in each way, and compare under its other lights."""
    shots = capture.shots()
    first = next(shot for shot in shots if shot.name == capture.trained)

    def setup_of(light: Light, zone: Zone | None) -> Setup:
        return setup_from(
            {
                "photo": {"path": f"{capture.name}.png", "zone": zone},
                "light": light,
                "colour": "none",
                "mask": mask_of(capture.name),
                "fit": {"evaluations": evaluations, "library": "none"},
            },
            capture.name,
        )

    setup = setup_of(flash(first), capture.zone)
    result = fit(setup, photo=first.load())
    target = result.target
    surface = build(setup, target.shape, target.zone)
    ways = ways_of(Objective(target, surface, specular=setup.fit.specular), result.detail, setup.seed)
    seen = {shot.name: make_target(setup_of(shot.light, target.zone), shot.load()) for shot in shots}
    lights: dict[str, dict[str, Any]] = {shot.name: {} for shot in shots if shot.name != first.name}
    rows: dict[str, list[Picture]] = {name: [seen[name].pixels] for name in lights}
    for way, (detail, _) in ways.items():
        surface.update(detail)
        for shot in shots:
            if shot.name not in lights:
                continue
            there = seen[shot.name]
            lamp = Lamp(there.lamp.direction, there.lamp.position, there.lamp.strength, shot.at_camera)
            parts = components(surface, lamp, subsamples=SUBSAMPLES, shininess=(detail.reflectance.shininess,))
            picture = toned(parts.colour(detail.reflectance), there)
            lights[shot.name][way] = compared(picture, there)
            rows[shot.name].append(picture)
    if sheets is not None:
        save_sheet(sheets / f"relit_{capture.name}.jpg", list(rows.values())[:3])
    return {
        "capture": capture.name,
        "credit": capture.credit,
        "trained": first.name,
        "chosen": {w: c for w, (_, c) in ways.items()},
        "medians": {
            way: {m: round(float(np.median([light[way][m] for light in lights.values()])), 4) for m in MEASURES} for way in WAYS
        },
        "lights": lights,
    }


def toned(picture: Picture, seen: Target) -> Picture:
    """Return the picture at the photo's mean luminance."""
    gain = seen.luminance[seen.mask].mean() / max(float(luminance(picture)[seen.mask].mean()), 1e-9)
    return np.asarray(np.minimum(picture * gain, seen.white), dtype=np.float32)


def compared(picture: Picture, seen: Target) -> dict[str, float]:
    """Return the measures of a picture against the photo under the same light."""
    mask = seen.mask
    judge = ColourDistance(seen.pixels, mask, seen.descriptor.metric)
    half = mask.shape[1] // 2
    left, right = (np.ascontiguousarray(seen.pixels[:, part]) for part in (slice(None, half), slice(-half, None)))
    marks = [np.ascontiguousarray(mask[:, part]) for part in (slice(None, half), slice(-half, None))]
    halves = ColourDistance(left, marks[0], seen.descriptor.metric)(right, marks[1])
    spread = [float(np.log(np.maximum(luminance(p)[mask], 1e-3)).std()) for p in (picture, seen.pixels)]
    return {
        "chromaticity": round(float(np.linalg.norm(uv(picture[mask]) - uv(seen.pixels[mask]))), 5),
        "contrast": round(spread[0] / max(spread[1], 1e-9), 3),
        "colour": round(judge(picture) / halves, 3),
    }


def table(records: list[dict[str, Any]]) -> str:
    """Medians over each capture's held-out lights."""
    rows = [
        [r["capture"], way, r["chosen"][way], *(f"{r['medians'][way][m]:.3g}" for m in MEASURES)] for r in records for way in WAYS
    ]
    return "Medians over the lights that were not fitted.\n\n" + markdown(["capture", "colour", "chosen", *MEASURES], rows)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("-o", "--output", type=Path, default=Path("results/colour"))
    parser.add_argument("--unshown", type=Path)
    parser.add_argument("--only", action="append", choices=[capture.name for capture in COLOURED])
    parser.add_argument("--evaluations", type=int)
    arguments = parser.parse_args()
    records = []
    for capture in COLOURED:
        if (arguments.only and capture.name not in arguments.only) or not (MULTILIGHT / capture.name).exists():
            continue
        records.append(run(capture, arguments.evaluations, arguments.output if capture.credit else arguments.unshown))
        print(json.dumps({key: value for key, value in records[-1].items() if key != "lights"}), flush=True)
    print(table(records))
    if not arguments.only:
        write_text(arguments.output / "relit_colour.json", json.dumps(records, indent=1) + "\n")
        write_text(arguments.output / "relit_colour.md", table(records))


if __name__ == "__main__":
    main()
