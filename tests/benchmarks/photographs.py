"""Fits of real photographs: sheets, details and numbers.

Run with:  python -m tests.benchmarks.photographs -o results/fits [--only NAME ...]
Photographs of the test data are read from ../shared/data. Where their licence does not allow to show them, only the
detail and the numbers are written, and the sheets go to --unshown FOLDER if one is given.
"""

from __future__ import annotations

import argparse
import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from tests.benchmarks.kept import keep, keep_linear
from tests.benchmarks.relit import SHARED
from voldetail.apply import gallery
from voldetail.detail import save_detail
from voldetail.files import write_text
from voldetail.fit import fit
from voldetail.image import resize
from voldetail.report import write_report
from voldetail.setup.file import setup_from
from voldetail.setup.setup import Setup


@dataclass(frozen=True)
class Photograph:
    """A photograph, its light, how sure that is, and whether its licence lets a report show it (then with credit)."""

    name: str
    path: str
    light: str
    about: str
    shown: bool
    credit: str = ""
    zone: tuple[int, int, int, int] | None = None


PHOTOGRAPHS = (
    Photograph("gravel", "skimage:gravel", "70,50", "azimuth measured, elevation guessed", True, "CC0, scikit-image"),
    Photograph("grass", "skimage:grass", "140,55", "guessed", True, "CC0, linolafett, scikit-image"),
    Photograph("brick", "skimage:brick", "90,60", "guessed; structured: a control", True, "CC0, scikit-image"),
    Photograph(
        "rock_plants",
        "photos/duion_rock_rough_plants_01/photo.jpg",
        "90,45",
        "daylight from above",
        True,
        "CC-BY 3.0, Christian Femmer aka Duion",
    ),
    Photograph(
        "rock_weathered",
        "photos/duion_rock_rough_weathered_01/photo.jpg",
        "90,45",
        "daylight from above",
        True,
        "CC-BY 3.0, Christian Femmer aka Duion",
    ),
    Photograph("stone_slab", "photos/nmo_stone_slab/photo.jpg", "90,60", "overcast, guessed", True, "MIT, Christian Petry"),
    Photograph(
        "pebble_wall",
        "multilight/nmo_pebble_wall_4light/left.jpg",
        "180,40",
        "azimuth known, elevation about 30 to 50 degrees",
        True,
        "MIT, Christian Petry",
    ),
    Photograph("roughcast", "photos/flash_train_2062/flash.jpg", "flash", "flash at the camera", False),
    Photograph("pitted_rock", "photos/flash_test_2020/flash.jpg", "flash", "flash at the camera", False),
    Photograph("sandy_lichen", "photos/flash_train_2041/flash.jpg", "flash", "flash at the camera", False),
    Photograph("sand_ripples", "photos/ns_sand_ripples/photo.jpg", "90,30", "one light, direction guessed", False),
    Photograph("bark", "photos/ns_bark/photo.jpg", "180,40", "side light, direction guessed", False),
    Photograph(
        "plaster",
        "multilight/mgan_wall-plaster-green/mosaic_3x3.jpg",
        "flash@0.1975,0.1545,0.785",
        "flash at the camera, foot and height from lights.json",
        False,
        zone=(128, 128, 768, 768),
    ),
    Photograph(
        "leather",
        "multilight/mgan_leather-darkbrown/mosaic_3x3.jpg",
        "flash@0.2215,0.1525,0.785",
        "flash at the camera, foot and height from lights.json",
        False,
        zone=(64, 64, 384, 384),
    ),
)


OVERVIEW = ("gravel", "rock_plants", "stone_slab", "pebble_wall", "rock_weathered", "grass")


def setup_of(photograph: Photograph, **fit_settings: Any) -> Setup:
    """Return the Setup of one photograph, with settings of the fit that are not the default's; without a library."""
    path = photograph.path if photograph.path.startswith("skimage:") else str(SHARED / photograph.path)
    return setup_from(
        {"photo": {"path": path, "zone": photograph.zone}, "light": photograph.light, "fit": {"library": "none"} | fit_settings},
        photograph.name,
    )


def is_there(photograph: Photograph) -> bool:
    """Whether the photograph can be read here."""
    return photograph.path.startswith("skimage:") or (SHARED / photograph.path).exists()


def run(photograph: Photograph, output: Path, unshown: Path | None) -> dict[str, Any]:
    """Fit one photograph and write what may be shown; returns its numbers."""
    result = fit(setup_of(photograph))
    folder = output / photograph.name
    folder.mkdir(parents=True, exist_ok=True)
    save_detail(folder / "detail.json", result.detail)
    place = folder if photograph.shown else (unshown / photograph.name if unshown else None)
    if place is not None:
        place.mkdir(parents=True, exist_ok=True)
        pictures = gallery(result)
        _, sheet = write_report(place, result, pictures)
        # The page is as large as all its pictures; the sheet, with fewer colours, is what is kept.
        (place / "report.html").unlink()
        keep(place / "sheet.jpg", Image.open(sheet))
        sheet.unlink()
        if photograph.shown:
            sphere = _fitting(pictures.sphere, pictures.photo)
            keep_linear(place / "fit.jpg", np.concatenate([pictures.photo, pictures.fitted, sphere], axis=1))
    floor = result.detail.noise_floor
    return {
        "name": photograph.name,
        "light": photograph.light,
        "light_is": photograph.about,
        "credit": photograph.credit,
        "M": round(result.distance, 3),
        "photo_halves": floor.photo_halves,
        "other_seed": floor.other_seed,
        "seconds": round(result.seconds, 1),
        "evaluations": result.evaluations,
        "zone": list(result.target.zone),
    }


def _fitting(picture: NDArray[np.float32], like: NDArray[np.float32]) -> NDArray[np.float32]:
    """Return a square ``picture`` as high as ``like``."""
    return resize(picture, (like.shape[0], like.shape[0]))


def overview(folder: Path, names: tuple[str, ...]) -> None:
    """Write overview.jpg: photo, fit and sphere of each name, two to a row."""
    tiles = [Image.open(folder / name / "fit.jpg").convert("RGB") for name in names if (folder / name / "fit.jpg").exists()]
    if not tiles:
        return
    width, height = max(t.width for t in tiles), max(t.height for t in tiles)
    page = Image.new("RGB", (2 * width + 24, (len(tiles) + 1) // 2 * (height + 12)), "white")
    for index, tile in enumerate(tiles):
        page.paste(tile, ((index % 2) * (width + 24), index // 2 * (height + 12)))
    keep(folder / "overview.jpg", page)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("-o", "--output", type=Path, default=Path("results/fits"))
    parser.add_argument("--unshown", type=Path)
    parser.add_argument("--only", action="append")
    arguments = parser.parse_args()
    records = []
    for photograph in PHOTOGRAPHS:
        if arguments.only and photograph.name not in arguments.only:
            continue
        if not is_there(photograph):
            print(f"{photograph.name}: skipped, {photograph.path} is not there")
            continue
        records.append(run(photograph, arguments.output, arguments.unshown))
        print(json.dumps(records[-1]), flush=True)
    table = arguments.output / "fits.json"
    known = {record["name"]: record for record in json.loads(table.read_text())} if table.exists() else {}
    known |= {record["name"]: record for record in records}
    ordered = [known[photograph.name] for photograph in PHOTOGRAPHS if photograph.name in known]
    write_text(table, json.dumps(ordered, indent=1) + "\n")
    overview(arguments.output, OVERVIEW)


if __name__ == "__main__":
    main()
