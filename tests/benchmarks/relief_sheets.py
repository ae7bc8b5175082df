"""Photographs relit from four sides by their own recovered relief, to be looked at.

Run with:  python -m tests.benchmarks.relief_sheets -o results/relief [--only NAME ...]
A row each: the photo, its maps under its own light, height, normals, and light from the right, above, the left and below. Those
of free licences (CC0, CC-BY, MIT) are kept.
"""

from __future__ import annotations

import argparse
import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from tests.benchmarks.kept import keep_linear
from tests.benchmarks.relit import SHARED
from voldetail.apply.relief_gallery import height_picture, normal_picture, under_lights
from voldetail.files import write_text
from voldetail.image import load_photo, luminance, resize
from voldetail.recover.recovery import recover
from voldetail.setup.light import parse_light
from voldetail.types import Picture

SIDE = 240
"""Pixels of a picture."""


@dataclass(frozen=True)
class Shown:
    """A photograph: its name in the sheet, file, light, zone (x, y, width, height; None for a square in its middle), credit."""

    name: str
    file: str
    light: str
    zone: tuple[int, int, int, int] | None = None
    credit: str = ""


PHOTOS = (
    Shown("gravel", "skimage:gravel", "70,50", credit="scikit-image, CC0"),
    Shown("brick", "skimage:brick", "140,45", credit="scikit-image, CC0"),
    Shown("grass", "skimage:grass", "140,55", credit="scikit-image, CC0"),
    Shown("pebble wall, from the left", "multilight/nmo_pebble_wall_4light/left.jpg", "180,40", credit="Christian Petry, MIT"),
    Shown("pebble wall, from above", "multilight/nmo_pebble_wall_4light/above.jpg", "90,40", credit="Christian Petry, MIT"),
)
"""Lights of the first three are estimates by eye; the pebble wall's azimuths are known, its elevation about 30 to 50 degrees."""


def row(photo: Shown) -> tuple[Picture, dict[str, object]]:
    """Return a row of pictures and what was found."""
    path = photo.file if photo.file.startswith("skimage:") else str(SHARED / photo.file)
    loaded = load_photo(path)
    rows, columns = loaded.pixels.shape[:2]
    side = min(rows, columns)
    zone = photo.zone or ((columns - side) // 2, (rows - side) // 2, side, side)
    found = recover(loaded, parse_light(photo.light), zone=zone, size=512)
    size = (SIDE, SIDE)
    level = 0.25 / max(float(luminance(found.photo).mean()), 1e-4)
    lights = [picture * (0.25 / max(float(luminance(picture).mean()), 1e-4)) for _, picture in under_lights(found.detail, size)]
    pictures = [
        resize(found.photo, size) * level, resize(found.again, size) * level, resize(height_picture(found.detail), size),
        resize(normal_picture(found.detail), size), *lights,
    ]  # fmt: skip
    record: dict[str, object] = {
        "photo": photo.name, "credit": photo.credit, "light": photo.light, "confidence": round(found.confidence, 3),
        "amplitude": round(found.detail.relief.amplitude, 4), "notes": list(found.notes), "seconds": round(found.seconds, 2),
    }  # fmt: skip
    return np.concatenate([np.clip(p, 0, 1) for p in pictures], axis=1).astype(np.float32), record


def main() -> None:
    """Make the sheet."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("-o", "--output", type=Path, default=Path("results/relief"))
    parser.add_argument("--only", nargs="+", default=None)
    given = parser.parse_args()
    made = [row(photo) for photo in PHOTOS if not given.only or photo.name in given.only]
    keep_linear(given.output / "relit.jpg", np.concatenate([picture for picture, _ in made]))
    write_text(given.output / "relit.json", json.dumps([record for _, record in made], indent=1) + "\n")


if __name__ == "__main__":
    main()
