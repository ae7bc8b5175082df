"""Decoys that a search makes: renderings that the published metric likes, with everything free, the light included.

Run with:  python -m tests.benchmarks.searched_decoys [NAME ...]
Writes results/metric/searched/NAME.png, 192 x 192, and what was found to searched.json. About half a minute a photo on two
cores; with ../shared/data beside the repository all of DECOY_PHOTOS, else scikit-image's three.
"""

from __future__ import annotations

import json
import math
import sys
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image
from scipy.stats import qmc

from tests.benchmarks import texture_pictures as pictures
from voldetail.backend import mitsuba
from voldetail.detail import Detail, rounded, with_values
from voldetail.detail.parameters import CURVE_POINTS
from voldetail.files import write_text
from voldetail.fit.reflectance import solve
from voldetail.fit.search import CMAES, Memory, Vector, minimise
from voldetail.fit.session import derived_seed
from voldetail.image import to_srgb
from voldetail.metric import describe, distance
from voldetail.render.heightfield import HeightField
from voldetail.render.unit_components import components
from voldetail.setup.lamp import Lamp
from voldetail.setup.light import direction_of
from voldetail.setup.view import View

RESULTS = Path(__file__).resolve().parents[2] / "results" / "metric"
FOLDER = RESULTS / "searched"

KINDS = ((1, 50, "gaussian"), (1, 50, "exponential"), (1, 2, "exponential"), (2, 2, "gaussian"), (2, 3, "exponential"))
"""Ranks of feature points and envelopes, GD10's own."""

SAMPLES = 64
"""Points tried first, over all kinds alike."""

STARTS = 2
EVALUATIONS = 190
"""Searches for each photo, from the best points of different kinds, and what each may render."""

POPULATION = 16

RANGES: dict[str, tuple[float, float, bool]] = {
    "azimuth": (0, 2 * math.pi, False), "elevation": (math.radians(4), math.radians(80), False),
    "noise.scale": (1.0, 32.0, True), "roughness": (0.03, 1.5, True), "noise.anisotropy": (0.2, 5.0, True),
    "noise.angle": (0, math.pi, False), "noise.octaves": (1, 3.999, False), "noise.lacunarity": (1.5, 4.0, True),
    "noise.gain": (0.1, 1.5, True), "noise.stripe_frequency": (0.0, 4.0, False), "noise.stripe_spread": (0.0, math.pi, False),
    "reflectance.cell_albedo": (0.0, 0.5, False),
    **{f"curve.{i}": (0.0, 1.0, False) for i in range(CURVE_POINTS)},
}  # fmt: skip
"""Lower, upper and whether logarithmic. Scales from half the picture to three pixels a cell; H in all its eleven points."""

PERIODIC = ("azimuth", "noise.angle")

EXCLUDED: dict[str, str] = {}
"""Photos whose decoy a person would take for another crop, with the reason: not counted as decoys."""


def detail_at(vector: Vector, kind: tuple[int, int, str], seed: int) -> tuple[Detail, Lamp]:
    """The detail and the light at a point of the unit box."""
    values: dict[str, float] = {}
    for (name, (low, high, log)), unit in zip(RANGES.items(), vector, strict=True):
        unit = unit % 1.0 if name in PERIODIC else min(max(float(unit), 0.0), 1.0)
        values[name] = low * (high / low) ** unit if log else low + unit * (high - low)
    azimuth, elevation, roughness = (values.pop(name) for name in ("azimuth", "elevation", "roughness"))
    curve = tuple(values.pop(f"curve.{i}") for i in range(CURVE_POINTS))
    first, last, envelope = kind
    given: dict[str, Any] = values | {
        "noise.octaves": int(values["noise.octaves"]), "noise.first_neighbour": first, "noise.last_neighbour": last,
        "noise.envelope": envelope, "noise.curve": curve, "relief.amplitude": min(roughness / values["noise.scale"], 1.0),
    }  # fmt: skip
    direction = direction_of(math.degrees(azimuth), math.degrees(elevation))
    return rounded(with_values(Detail(seed=seed), given)), Lamp(direction=direction)


class Forger:
    """Makes pictures for one photo's crop, with its order statistics, and says how far the published metric sees them."""

    def __init__(self, crop: pictures.Picture) -> None:
        self.crop = crop
        self.surface = HeightField(View(-1.0, 1.0, -1.0, 1.0, pictures.SIDE, pictures.SIDE))
        self.reference = describe(crop, metric="published")
        self.mask = np.ones(crop.shape, bool)

    def picture(self, detail: Detail, lamp: Lamp) -> NDArray[np.float32]:
        """The rendering in 8 bits, linear again."""
        self.surface.update(detail)
        parts = components(self.surface, lamp)
        found = solve(self.crop, parts, self.mask)
        shown = parts.luminance(found.ambient, found.diffuse, found.specular, found.shininess)
        return pictures.in_8_bits(shown)

    def distance(self, picture: NDArray[np.float32]) -> float:
        return distance(self.reference, describe(picture, like=self.reference))


def forge(name: str, photo: pictures.Picture) -> tuple[NDArray[np.float32], dict[str, Any]]:
    """The nearest picture found for the first crop of a photo, and its record."""
    first, *others = pictures.corners(photo)
    forger = Forger(pictures.crop(photo, first))
    seed = derived_seed(5, f"decoy/{name}")
    points = qmc.Sobol(len(RANGES), seed=np.random.default_rng(seed)).random(SAMPLES)

    def value(vector: Vector, kind: tuple[int, int, str]) -> float:
        return forger.distance(forger.picture(*detail_at(vector, kind, seed)))

    tried = sorted((value(point, KINDS[i % len(KINDS)]), i) for i, point in enumerate(points))
    chosen: dict[tuple[int, int, str], Vector] = {}
    for _, i in tried:
        chosen.setdefault(KINDS[i % len(KINDS)], points[i])
    periodic = tuple(i for i, key in enumerate(RANGES) if key in PERIODIC)
    solutions = []
    for kind, start in list(chosen.items())[:STARTS]:
        found = minimise(
            CMAES(POPULATION, periodic), lambda vectors, step: [value(v, kind) for v in vectors], start,
            memory=Memory(0.2), seed=seed, budget=EVALUATIONS,
        )  # fmt: skip
        solutions.append((found.value, kind, found.vector))
    best, kind, vector = min(solutions, key=lambda s: s[0])
    detail, lamp = detail_at(vector, kind, seed)
    crops = float(np.mean([forger.distance(pictures.crop(photo, corner)) for corner in others]))
    assert lamp.direction is not None
    record = {
        "published": round(best, 4), "other_crop": round(crops, 4), "ratio": round(best / crops, 2),
        "evaluations": SAMPLES + STARTS * EVALUATIONS, "light": [round(v, 4) for v in lamp.direction],
        "seed": seed, "noise": detail.noise.model_dump(mode="json"), "amplitude": detail.relief.amplitude,
        "cell_albedo": detail.reflectance.cell_albedo,
    }  # fmt: skip
    return forger.picture(detail, lamp), record


def searched(name: str) -> NDArray[np.float32] | None:
    """The decoy that was made for a photo, linear; None where there is none or it is excluded."""
    path = FOLDER / f"{name}.png"
    if name in EXCLUDED or not path.is_file():
        return None
    return pictures.from_8_bits(np.asarray(Image.open(path)))


def main() -> None:
    mitsuba()
    shared = RESULTS.parents[2] / "shared" / "data"
    photos = pictures.textures(shared if shared.is_dir() else None)
    FOLDER.mkdir(parents=True, exist_ok=True)
    written = FOLDER / "searched.json"
    records = json.loads(written.read_text()) if written.is_file() else {}
    for name in sys.argv[1:] or [n for n in pictures.DECOY_PHOTOS if n in photos]:
        picture, records[name] = forge(name, photos[name])
        Image.fromarray(np.round(to_srgb(picture) * 255).astype(np.uint8)).save(FOLDER / f"{name}.png", optimize=True)
        print(name, {k: records[name][k] for k in ("published", "other_crop", "ratio")}, flush=True)
        write_text(written, json.dumps(dict(sorted(records.items())), indent=1) + "\n")


if __name__ == "__main__":
    main()
