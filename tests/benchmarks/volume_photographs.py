"""Fits of real photographs as volumes, put on three shapes under three lights and an environment map.

Run with:  python -m tests.benchmarks.volume_photographs -o results/volume [--only NAME ...] [--again]
A sheet for each: photo and fit on the left, then a row for each shape; the last column is path-traced under the map.
--again draws the sheets of the details that are there without fitting anew. Photographs, map and meshes are read from
../shared/data.
"""

from __future__ import annotations

import argparse
import json
import resource
import tempfile
import time
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from tests.benchmarks.kept import keep, keep_linear
from tests.benchmarks.relit import SHARED
from voldetail.apply import render
from voldetail.detail import Detail, load_detail, save_detail
from voldetail.files import write_text
from voldetail.fit import FitResult, fit
from voldetail.image import load_photo, resize, save_image
from voldetail.setup.file import setup_from
from voldetail.setup.light import parse_light

CLOUDS = "photos/clouds_kloofendal/clouds.png"
SHAPES = ("sphere", "cylinder", "meshes/spot/spot.obj")
LIGHTS = ("135,40", "20,30", "270,60")
BEHIND = "60,-25"
"""The third light of a medium: low behind it."""

MAP = "hdri/kloofendal_partly_cloudy/env.exr"
SIDE, SAMPLES = 240, 96
MEDIUM_SAMPLES, SMALLER = 32, 3
"""For each pixel, and times that the path-traced picture of a medium is smaller: dense clouds are traced at no more than some
ten thousand paths a second."""

TURN = (0.0, 150.0, 0.0)
SKY = (0.08, 0.16, 0.36)


@dataclass(frozen=True)
class Case:
    """A photograph fitted as a volume."""

    name: str
    path: str
    light: str
    look: str
    credit: str
    fields: dict[str, Any] = field(default_factory=dict)


CASES = (
    Case("gravel_solid", "skimage:gravel", "70,50", "surface", "CC0, scikit-image"),
    Case("grass_solid", "skimage:grass", "140,55", "surface", "CC0, linolafett, scikit-image"),
    Case("rock_solid", "photos/duion_rock_rough_plants_01/photo.jpg", "90,45", "surface",
         "CC-BY 3.0, Christian Femmer aka Duion"),
    Case("cloud_bank", CLOUDS, "60,40", "medium", "CC0, Greg Zaal, Poly Haven",
         {"photo": {"zone": [175, 10, 145, 75]}}),
    Case("cloud_heap", CLOUDS, "60,40", "medium", "CC0, Greg Zaal, Poly Haven",
         {"photo": {"zone": [364, 86, 104, 58]},
          "proxy": {"kind": "ellipsoid", "size": [0.3, 0.15, 0.2], "position": [0.6, -0.1, 0.0]}}),
    Case("grass_medium", "skimage:grass", "140,55", "medium", "CC0, linolafett, scikit-image"),
)  # fmt: skip


def is_there(case: Case) -> bool:
    return case.path.startswith("skimage:") or (SHARED / case.path).exists()


def run(case: Case) -> FitResult:
    """Fit one photograph."""
    path = case.path if case.path.startswith("skimage:") else str(SHARED / case.path)
    fields = dict(case.fields)
    photo = {"path": path, **fields.pop("photo", {})}
    setup = setup_from({"photo": photo, "light": case.light, "mode": "volume", "look": case.look, **fields}, case.name)
    return fit(setup)


def sheet(detail: Detail, case: Case, photo: NDArray[np.float32], fitted: NDArray[np.float32]) -> NDArray[np.float32]:
    """Return photo and fit, and a row of lights for each shape."""
    medium = detail.medium is not None
    lights = (*LIGHTS[:2], BEHIND if medium else LIGHTS[2])
    behind = SKY if medium else (0.0, 0.0, 0.0)
    rows = []
    for shape in SHAPES:
        mesh = str(SHARED / shape) if "/" in shape else shape
        turn = TURN if "/" in shape else (0.0, 0.0, 0.0)
        common: dict[str, Any] = {"size": (SIDE, SIDE), "rotation": turn, "background": behind}
        row = [render(detail, mesh, light=parse_light(light), **common) for light in lights]
        if medium:
            common["size"] = (SIDE // SMALLER, SIDE // SMALLER)
        traced = render(detail, mesh, envmap=SHARED / MAP, samples=MEDIUM_SAMPLES if medium else SAMPLES, **common)
        row.append(resize(traced, (SIDE, SIDE)) if medium else traced)
        rows.append(np.concatenate(row, axis=1))
    shapes = np.concatenate(rows)
    wide = round(1.5 * SIDE)
    left = np.ones((shapes.shape[0], wide, 3), dtype=np.float32)
    high = min(round(wide * photo.shape[0] / photo.shape[1]), left.shape[0] // 2 - 4)
    for index, picture in enumerate((photo, fitted)):
        part = resize(picture, (high, min(round(high * photo.shape[1] / photo.shape[0]), wide)))
        top = index * (left.shape[0] // 2)
        left[top : top + part.shape[0], : part.shape[1]] = part
    return np.concatenate([left, np.ones((shapes.shape[0], 8, 3), dtype=np.float32), shapes], axis=1)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("-o", "--output", type=Path, default=Path("results/volume"))
    parser.add_argument("--only", action="append")
    parser.add_argument("--again", action="store_true")
    arguments = parser.parse_args()
    records = []
    for case in CASES:
        if (arguments.only and case.name not in arguments.only) or not is_there(case):
            continue
        folder = arguments.output / case.name
        folder.mkdir(parents=True, exist_ok=True)
        if arguments.again:
            detail = load_detail(folder / "detail.json")
            pair = load_photo(folder / "pair.jpg").pixels
            photo, fitted = np.split(pair, 2, axis=1)
        else:
            result = run(case)
            detail, photo, fitted = result.detail, result.target.pixels, result.coloured
            save_detail(folder / "detail.json", detail)
            keep_linear(folder / "pair.jpg", np.concatenate([photo, fitted], axis=1))
            floor = detail.noise_floor
            records.append({
                "name": case.name, "look": case.look, "light": case.light, "credit": case.credit, "M": round(result.distance, 3),
                "photo_halves": floor.photo_halves, "other_seed": floor.other_seed, "seconds": round(result.seconds, 1),
                "evaluations": result.evaluations,
                "peak_mb_so_far": round(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024),
                "settings": detail.provenance.settings if detail.provenance else {},
            })  # fmt: skip
            print(json.dumps(records[-1]), flush=True)
        with tempfile.TemporaryDirectory() as scratch:
            path = Path(scratch) / "sheet.png"
            begun = time.monotonic()
            save_image(path, sheet(detail, case, photo, fitted))
            print(f"{case.name}: sheet in {time.monotonic() - begun:.0f} s", flush=True)
            keep(folder / "sheet.jpg", Image.open(path))
    table = arguments.output / "photographs.json"
    known = {record["name"]: record for record in json.loads(table.read_text())} if table.exists() else {}
    known |= {record["name"]: record for record in records}
    ordered = [known[case.name] for case in CASES if case.name in known]
    write_text(table, json.dumps(ordered, indent=1) + "\n")


if __name__ == "__main__":
    main()
