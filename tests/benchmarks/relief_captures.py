"""Registered captures: one light in, the others out, pixel by pixel.

Run with:  python -m tests.benchmarks.relief_captures -o results/relief [--every N]
Sets of ../shared/data/multilight whose photos lie on each other: each is recovered under its own light and rendered under those
of all others, in the photo's place. Beside it stand the photo itself (flat), brightness taken for height at the linear step's
steepness, and photometric stereo from all photos but the two: the ceiling. Pictures are compared within the mask after one gain:
PSNR (of the 99.9th percentile), correlation, and correlation of what is finer than HIGH_PASS pixels; medians over pairs."""

from __future__ import annotations

import argparse
import json
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image
from scipy.ndimage import binary_erosion, gaussian_filter

from tests.benchmarks.relit import SHARED
from voldetail.detail.photo_relief import MappedDetail
from voldetail.files import write_text
from voldetail.image import Photo, luminance, resize, resize_mask, with_mask
from voldetail.recover.recovery import recover
from voldetail.recover.slopes import Method
from voldetail.render.heightfield import HeightField
from voldetail.render.unit_components import components
from voldetail.setup.lamp import Lamp
from voldetail.setup.light import Light
from voldetail.setup.view import View
from voldetail.types import Mask, Picture

SETS = ("uw_psm_rock", "harvard_turtle")
LONGEST = 384
"""Pixels of the longest side."""

HIGH_PASS = 8.0
METHODS: tuple[Method, ...] = ("linear", "network")
FRONT = 0.97
"""z of a light from which it comes from the front: no pair begins with it."""


@dataclass(frozen=True, eq=False)
class Capture:
    """photos (N, H, W), linear luminance over the light's strength; directions (N, 3); mask (H, W)."""

    name: str
    photos: Picture
    directions: Picture
    mask: Mask


def capture(name: str) -> Capture:
    """Return a set, cut to its mask's box."""
    folder = SHARED / "multilight" / name
    lights = json.loads((folder / "lights.json").read_text())["lights"]
    photos, directions = [], []
    for light in lights:
        stored = np.asarray(Image.open(folder / light["file"]).convert("RGB"), np.float32) / 255.0
        vector = np.asarray(light["dir"], np.float32)
        strength = float(np.linalg.norm(vector))
        photos.append(luminance(stored) / strength)
        directions.append(vector / strength)
    stack = np.stack(photos)
    own = folder / "mask.png"
    mask = np.asarray(Image.open(own).convert("L")) > 127 if own.exists() else np.median(stack, axis=0) > 0.02
    rows, columns = np.flatnonzero(mask.any(1)), np.flatnonzero(mask.any(0))
    part = slice(rows[0], rows[-1] + 1), slice(columns[0], columns[-1] + 1)
    stack, mask = stack[(slice(None), *part)], mask[part]
    factor = min(1.0, LONGEST / max(mask.shape))
    size = round(mask.shape[0] * factor), round(mask.shape[1] * factor)
    return Capture(name, np.stack([resize(p, size) for p in stack]), np.stack(directions), resize_mask(mask, size))


def relighter(detail: MappedDetail) -> Callable[[Picture], Picture]:
    """Return what makes the luminance of a recovered relief, in the photo's place, under a distant light (3,)."""
    rows, columns = detail.height.shape
    unit = 1.0 / max(rows, columns)
    field = HeightField(View(-columns * unit, columns * unit, -rows * unit, rows * unit, columns, rows))
    field.update(detail)  # type: ignore[arg-type]

    def under(light: Picture) -> Picture:
        x, y, z = (float(v) for v in light)
        parts = components(field, Lamp(direction=(x, y, z)), subsamples=1, shininess=(detail.reflectance.shininess,))
        return luminance(parts.colour(detail.reflectance))

    return under


def stereo(found: Capture, without: tuple[int, int], light: Picture) -> Picture:
    """Return what photometric stereo (Woodham 1980) from all photos but those makes under ``light``: albedo max(0, n . l)."""
    used = [k for k in range(len(found.photos)) if k not in without]
    values = found.photos[used].reshape(len(used), -1)
    scaled, *_ = np.linalg.lstsq(found.directions[used].astype(np.float64), values.astype(np.float64), rcond=None)
    return np.asarray(np.maximum(light @ scaled, 0.0).reshape(found.mask.shape), np.float32)


def measures(made: Picture, wanted: Picture, mask: Mask) -> dict[str, float]:
    """Return PSNR in dB, correlation and correlation of what is fine, within ``mask``, after one gain."""
    gain = float((made[mask] * wanted[mask]).sum() / max(float((made[mask] ** 2).sum()), 1e-12))
    error = float(np.mean((gain * made[mask] - wanted[mask]) ** 2))
    peak = float(np.percentile(wanted[mask], 99.9))
    inner = binary_erosion(mask, iterations=4)

    def fine(picture: Picture) -> Picture:
        filled = np.where(mask, picture, float(picture[mask].mean()))
        return np.asarray((filled - gaussian_filter(filled, HIGH_PASS))[inner])

    return {
        "psnr": 10 * np.log10(peak**2 / max(error, 1e-12)),
        "correlation": float(np.corrcoef(made[mask], wanted[mask])[0, 1]),
        "fine": float(np.corrcoef(fine(made), fine(wanted))[0, 1]),
    }


def brightness(found: Capture, first: int, like: MappedDetail) -> MappedDetail:
    """Return the photo's brightness as height, as steep as ``like``, of an even albedo."""
    picture = found.photos[first]
    bumps = gaussian_filter(picture - gaussian_filter(picture, min(picture.shape) / 8), 1.0)

    def steepness(height: Picture) -> float:
        return float(np.sqrt(np.mean(np.square(np.gradient(height)))))

    amplitude = steepness(like.height) * like.relief.amplitude / max(steepness(bumps / np.ptp(bumps)), 1e-9)
    record = like.record.model_copy(
        update={"relief": like.relief.model_copy(update={"amplitude": float(np.clip(amplitude, 1e-4, 1.0))})}
    )
    height = np.asarray((bumps - bumps.min()) / np.ptp(bumps), np.float32)
    return MappedDetail(record, height, like.albedo, like.roughness)


def run(name: str, every: int) -> dict[str, Any]:
    """Return the record of one set; ``every``: each how manieth light is taken for the photo's."""
    found = capture(name)
    pairs: dict[str, list[dict[str, float]]] = {}
    best: list[str] = []
    for first in range(0, len(found.photos), every):
        if found.directions[first][2] > FRONT:
            continue
        grey = np.repeat(found.photos[first][..., None], 3, axis=2)
        photo = with_mask(Photo(np.minimum(grey / np.percentile(grey[found.mask], 99.9), 0.98), "0" * 64), found.mask)
        x, y, z = (float(v) for v in found.directions[first])
        zone = (0, 0, found.mask.shape[1], found.mask.shape[0])
        details: dict[str, MappedDetail] = {
            m: recover(photo, Light(direction=(x, y, z)), zone=zone, size=LONGEST, method=m).detail for m in METHODS
        }
        details["brightness"] = brightness(found, first, details["linear"])
        relit = {m: relighter(d) for m, d in details.items()}
        for second in range(len(found.photos)):
            if second == first:
                continue
            wanted, light = found.photos[second], found.directions[second]
            pictures = {"flat": found.photos[first]} | {m: under(light) for m, under in relit.items()}
            scores = {m: measures(p, wanted, found.mask) for m, p in pictures.items()}
            best.append(max(scores, key=lambda m: scores[m]["fine"]))
            scores["stereo"] = measures(stereo(found, (first, second), light), wanted, found.mask)
            for method, values in scores.items():
                pairs.setdefault(method, []).append(values)
    medians = {m: {k: round(float(np.median([v[k] for v in values])), 3) for k in values[0]} for m, values in pairs.items()}
    shares = {m: round(best.count(m) / len(best), 3) for m in sorted(set(best))}
    return {"set": name, "pairs": len(best), "medians": medians, "best_of_all_but_stereo_by_fine": shares}


def main() -> None:
    """Measure both sets."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("-o", "--output", type=Path, default=Path("results/relief"))
    parser.add_argument("--every", type=int, default=1)
    given = parser.parse_args()
    given.output.mkdir(parents=True, exist_ok=True)
    records = [run(name, given.every) for name in SETS]
    write_text(given.output / "captures.json", json.dumps(records, indent=1) + "\n")
    for record in records:
        print(json.dumps(record), flush=True)


if __name__ == "__main__":
    main()
