"""Unseen lights: a detail fitted under one light is compared with the real photographs under the others.

Run with:  python -m tests.benchmarks.heldout_light -o results/heldout [--only NAME ...] [--evaluations N]
Captures of the test data (../shared/data/multilight) show one surface under several lights. One photo is fitted; the
detail and its reflectance are then rendered under each other light and compared with the photo taken there, beside two
things that one has without a fit: the first photo as a flat picture, and its brightness taken for height. All three are
brought to the photo's mean luminance, since the strengths of a capture's lights differ. The turtle of that folder is
left out: it is an object, not a texture. Where a light is near, its slow fall-off in every photo is replaced by the
model's, as in the fit (see `make_target`): for all three alike. A sheet (photo, fit, flat, brightness as height) is
written where the licence lets it be shown, and for the others to --unshown FOLDER if one is given.

The flat picture keeps the photo's own grain and marks, so that under a light that has hardly moved, or on relief that
looks alike from either side, nothing is nearer by statistics. ``turned`` says by how many degrees the light moved, seen
from the middle of the zone.
"""

from __future__ import annotations

import argparse
import json
import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from tests.benchmarks.relit import (
    SHARED,
    Picture,
    Yardstick,
    exposed,
    heights_of,
    lit_picture,
    markdown,
    raise_by_brightness,
    reflectance_under,
    save_sheet,
    side,
    slopes,
)
from voldetail.errors import InputError
from voldetail.files import write_text
from voldetail.fit import fit
from voldetail.fit.target import make_target
from voldetail.image import Photo, load_photo, luminance
from voldetail.render.build import build
from voldetail.render.heightfield import HeightField
from voldetail.results import Target
from voldetail.setup.file import setup_from
from voldetail.setup.lamp import Lamp
from voldetail.setup.light import Light, parse_light
from voldetail.setup.setup import Setup
from voldetail.setup.view import Zone, view_of

METRICS = ("combined", "patches", "jets", "gradient-skew", "published")
"""The first is what was minimised; patches, jets and gradient-skew take no part in it, and gradient-skew alone sees the lit
side; the last is GD10's own."""

COLUMNS = (*METRICS, "side")
"""`side` is no distance between textures: how far apart they look lit from, the length of a difference of vectors."""

METHODS = ("fit", "flat", "brightness")

SHOWN_LIGHTS = 3
"""Rows of a sheet."""

FLASH_HEIGHT = 2.35
"""Height of the mosaics' flash in tile widths: their lights.json says 2.2 to 2.5."""

MULTILIGHT = SHARED / "multilight"


@dataclass(frozen=True)
class Shot:
    """One photo of a capture: the light's name, the light, and how to read the photo."""

    name: str
    light: Light
    load: Callable[[], Photo]
    at_camera: bool = False


@dataclass(frozen=True)
class Capture:
    """A capture: its shots, the one that is fitted, how sure its lights are, and the credit if it may be shown."""

    name: str
    shots: Callable[[], list[Shot]]
    trained: str
    about: str
    credit: str = ""
    zone: Zone | None = None


def _lights(folder: str) -> dict[str, Any]:
    return dict(json.loads((MULTILIGHT / folder / "lights.json").read_text()))


def _file(folder: str, name: str, encoding: Any = "auto") -> Callable[[], Photo]:
    return lambda: load_photo(MULTILIGHT / folder / name, encoding=encoding)


def _near(position: Sequence[float], unit: float) -> Light:
    """A light at a position in other units, of which ``unit`` go into the photo's longest side, 2 scene units."""
    return parse_light("point:" + ",".join(f"{v * 2 / unit:.6g}" for v in position))


def mosaic(folder: str) -> list[Shot]:
    """A 3 x 3 mosaic of near flashes; each tile becomes a photo of its own, 2 scene units wide."""

    def tile(k: int) -> Photo:
        whole = load_photo(MULTILIGHT / folder / "mosaic_3x3.jpg")
        side = whole.pixels.shape[0] // 3
        x, y = side * (k % 3), side * (k // 3)
        return Photo(np.ascontiguousarray(whole.pixels[y : y + side, x : x + side]), whole.sha256)

    return [
        Shot(
            f"{at['tile']} {at['nominal']}",
            _near((*at["xy_fit_tile_units"], FLASH_HEIGHT), 1.0),
            (lambda k: lambda: tile(k))(at["tile"]),
            at_camera=True,
        )
        for at in _lights(folder)["lights"]
    ]


def cards() -> list[Shot]:
    folder = "mgan_cards_blue"
    known = _lights(folder)
    return [
        Shot(at["file"], _near(at["pos_cm"], known["image_size_cm"]), _file(folder, at["file"]), at_camera=True)
        for at in known["lights"]
    ]


def pebbles() -> list[Shot]:
    folder, elevation = "nmo_pebble_wall_4light", 40
    return [
        Shot(at["file"], parse_light(f"{at['azimuth_deg']},{elevation}"), _file(folder, at["file"]))
        for at in _lights(folder)["lights"]
    ]


def squeeze() -> list[Shot]:
    # The azimuths go together (integrability), and are those under which the letters, readable, are sunk.
    folder, elevation = "dea_squeeze_1", 45
    return [
        Shot(name, parse_light(f"{azimuth},{elevation}"), _file(folder, name))
        for name, azimuth in (("h.jpg", 180), ("v.jpg", 270))
    ]


def rock() -> list[Shot]:
    folder = "uw_psm_rock"
    return [
        Shot(at["file"], parse_light(",".join(map(str, at["dir"]))), _file(folder, at["file"], "linear"))
        for at in _lights(folder)["lights"]
    ]


CAPTURES = (
    Capture("nmo_pebble_wall_4light", pebbles, "left.jpg", "azimuths known, elevation taken as 40 degrees",
            "MIT, Christian Petry"),
    Capture("mgan_wall-plaster-green", lambda: mosaic("mgan_wall-plaster-green"), "0 centre", "flash positions fitted"),
    Capture("mgan_leather-darkbrown", lambda: mosaic("mgan_leather-darkbrown"), "0 centre", "flash positions fitted"),
    Capture("mgan_cards_blue", cards, "00.jpg", "calibrated; metallic: hard for a matt model"),
    Capture("dea_squeeze_1", squeeze, "h.jpg", "axes known, signs inferred, elevation taken as 45 degrees",
            zone=(655, 145, 192, 192)),  # paper without letters
    Capture("uw_psm_rock", rock, "00.png", "calibrated; a fairly flat part of a rock", zone=(140, 100, 230, 150)),
)  # fmt: skip


def run(capture: Capture, evaluations: int | None, sheets: Path | None) -> dict[str, Any]:
    """Fit one photo of a capture and compare under its other lights; returns the record."""
    shots = capture.shots()
    first = next(shot for shot in shots if shot.name == capture.trained)

    def setup_of(light: Light, zone: Zone | None) -> Setup:
        return setup_from(
            {
                "photo": {"path": f"{capture.name}.png", "zone": zone},
                "light": light,
                "mask": mask_of(capture.name),
                "fit": {"evaluations": evaluations, "library": "none"},
            },
            capture.name,
        )

    setup = setup_of(flash(first), capture.zone)
    result = fit(setup, photo=first.load())
    target, detail = result.target, result.detail
    surface, bumps = build(setup, target.shape, target.zone), build(setup, target.shape, target.zone)
    assert isinstance(surface, HeightField)
    assert isinstance(bumps, HeightField)
    surface.update(detail)
    x, y = view_of(setup.camera, target.shape, target.zone, setup.photo.resolution).coordinates(1)

    def on_plane(lamp: Lamp) -> Picture:
        return lamp.on_plane(x, y).reshape(target.mask.shape)

    shading = on_plane(target.lamp)
    steepness = float(np.sqrt(np.mean(slopes(heights_of(surface), surface.step) ** 2)))
    raise_by_brightness(bumps, target.luminance / shading * float(shading.mean()), steepness)
    bumps_reflectance = reflectance_under(bumps, target, specular=setup.fit.specular)

    lights: list[dict[str, Any]] = []
    rows: list[list[Picture]] = []
    for shot in shots:
        seen = make_target(setup_of(shot.light, target.zone), shot.load())
        lamp = Lamp(seen.lamp.direction, seen.lamp.position, seen.lamp.strength, shot.at_camera)
        pictures = {
            "fit": lit_picture(surface, lamp, detail.reflectance),
            "flat": target.pixels * (on_plane(lamp) / shading)[..., None],
            "brightness": lit_picture(bumps, lamp, bumps_reflectance),
        }
        yardstick = Yardstick(seen.luminance, seen.mask, METRICS)
        own_side, ratios = side(seen.luminance, seen.mask), {}
        for method, picture in pictures.items():
            grey = exposed(luminance(picture), seen.luminance, seen.mask, seen.white)
            away = float(np.linalg.norm(side(grey, seen.mask) - own_side))
            ratios[method] = {**yardstick.ratios(grey), "side": round(away, 3)}
        lights.append(
            {
                "light": shot.name,
                "held_out": shot.name != first.name,
                "turned": round(_turned(target.lamp, lamp, float(x.mean()), float(y.mean())), 1),
                "halves": {metric: round(value, 4) for metric, value in yardstick.halves.items()},
                "ratios": ratios,
            }
        )
        rows.append([seen.pixels, *(_toned(picture, seen) for picture in pictures.values())])
    if sheets is not None:
        held = sorted((i for i, light in enumerate(lights) if light["held_out"]), key=lambda i: -lights[i]["turned"])
        save_sheet(sheets / f"heldout_light_{capture.name}.jpg", [rows[i] for i in held[:SHOWN_LIGHTS]])
    return {
        "capture": capture.name,
        "about": capture.about,
        "credit": capture.credit,
        "zone": list(target.zone),
        "trained": first.name,
        "evaluations": result.evaluations,
        "seconds": round(result.seconds, 1),
        "lights": lights,
        "fit_nearest": share(light for light in lights if light["held_out"]),
    }


def flash(shot: Shot) -> Light:
    """The light to fit under: a near one that moves with the camera is a flash, as long as its foot is in the photo."""
    if not shot.at_camera or shot.light.position is None:
        return shot.light
    x, y, z = shot.light.position
    # The photos are square, 2 scene units wide.
    try:
        return parse_light(f"flash@{0.5 + x / 2:.6g},{0.5 - y / 2:.6g},{z / 2:.6g}")
    except InputError:
        return shot.light


def mask_of(name: str) -> str | None:
    path = MULTILIGHT / name / "mask.png"
    return str(path) if path.exists() else None


def _toned(picture: Picture, seen: Target) -> Picture:
    """The picture at the photo's mean, for the sheet."""
    return np.asarray(picture * (seen.luminance[seen.mask].mean() / luminance(picture)[seen.mask].mean()), dtype=np.float32)


def _turned(one: Lamp, other: Lamp, x: float, y: float) -> float:
    """Degrees between two lights seen from a point of the plane."""
    away = [np.array(lamp.direction) if lamp.position is None else np.array(lamp.position) - (x, y, 0.0) for lamp in (one, other)]
    cosine = float(away[0] @ away[1] / (np.linalg.norm(away[0]) * np.linalg.norm(away[1])))
    return math.degrees(math.acos(min(1.0, cosine)))


def share(lights: Iterable[dict[str, Any]]) -> dict[str, str]:
    """Say by each metric on how many of the lights the fit is nearer than both others."""
    ratios = [light["ratios"] for light in lights]
    won = {m: sum(r["fit"][m] < min(r["flat"][m], r["brightness"][m]) for r in ratios) for m in COLUMNS}
    return {metric: f"{count} of {len(ratios)}" for metric, count in won.items()}


def table(records: list[dict[str, Any]]) -> str:
    """Medians over each capture's held-out lights, and how often the fit is nearest."""
    rows = []
    for record in records:
        held = [light["ratios"] for light in record["lights"] if light["held_out"]]
        for metric in COLUMNS:
            medians = [f"{float(np.median([r[method][metric] for r in held])):.2f}" for method in METHODS]
            rows.append([record["capture"], metric, *medians, record["fit_nearest"][metric]])
    header = ["capture", "metric", "fit", "photo, flat", "brightness as height", "fit nearest"]
    return (
        "Distance from the photo under lights not fitted, over the distance between that photo's halves: medians. Side: how far"
        " apart photo and picture look lit from, 0 to about 2.\n\n" + markdown(header, rows)
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("-o", "--output", type=Path, default=Path("results/heldout"))
    parser.add_argument("--unshown", type=Path)
    parser.add_argument("--only", action="append", choices=[capture.name for capture in CAPTURES])
    parser.add_argument("--evaluations", type=int)
    arguments = parser.parse_args()
    records = []
    for capture in CAPTURES:
        if arguments.only and capture.name not in arguments.only:
            continue
        if not (MULTILIGHT / capture.name).exists():
            print(f"{capture.name}: skipped, it is not there")
            continue
        records.append(run(capture, arguments.evaluations, arguments.output if capture.credit else arguments.unshown))
        print(json.dumps({key: value for key, value in records[-1].items() if key != "lights"}), flush=True)
    everything = share(light for record in records for light in record["lights"] if light["held_out"])
    print(json.dumps(everything))
    print(table(records))
    if not arguments.only:
        whole = {"fit_nearest": everything, "captures": records}
        write_text(arguments.output / "heldout_light.json", json.dumps(whole, indent=1) + "\n")
        counts = ", ".join(f"{metric} {count}" for metric, count in everything.items())
        write_text(arguments.output / "heldout_light.md", f"{table(records)}\nThe fit is nearest on: {counts}.\n")


if __name__ == "__main__":
    main()
