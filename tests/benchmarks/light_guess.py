"""The guessed light against the known one, for every light of the multi-light captures and for renderings.

Run with:  python -m tests.benchmarks.light_guess -o results/light
The captures are read from ../shared/data; what is missing there is left out, and the table says so. The constants of
voldetail.fit.lightguess were tuned on these captures and on other renderings, so only the renderings are unseen.
"""

from __future__ import annotations

import argparse
import json
import math
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tests.benchmarks.recovery import photo_of, truth_of
from tests.benchmarks.relit import SHARED
from voldetail.backend import mitsuba
from voldetail.files import write_text
from voldetail.fit.lightguess import FAIRLY_SURE, FLOOR, guess_light
from voldetail.image import load_photo, luminance
from voldetail.setup.light import angles_of, direction_of

RENDERED = 100
NEAR = 30.0  # degrees: an azimuth this near is a hit
MOSAIC_HEIGHT = 2.35  # tile widths, the middle of the range in lights.json
ROCK = (slice(100, 250), slice(140, 370))  # the nearly plane patch of uw_psm_rock, from its record

CAPTURES = (
    "uw_psm_rock",
    "harvard_turtle",
    "nmo_pebble_wall_4light",
    "mgan_cards_blue",
    "mgan_leather-darkbrown",
    "mgan_wall-plaster-green",
    "dea_squeeze_1",
)
MOON = ("skimage_moon", 195.0)

CONTROLS = (
    "flash_test_2009",
    "flash_test_2014",
    "flash_test_2020",
    "flash_test_2029",
    "flash_test_2061",
    "flash_train_0253",
    "flash_train_2041",
    "flash_train_2062",
)
"""Photos with the flash at the camera: there is no azimuth to find."""


@dataclass(frozen=True)
class Case:
    """One guess; azimuths and errors in degrees, None where not known. axis_error: up to a half turn."""

    set: str
    light: str
    azimuth: float | None
    elevation: float | None
    guessed: tuple[float, float]
    confidence: float
    sign_confidence: float
    azimuth_error: float | None
    axis_error: float | None
    angle_error: float | None


def case(
    name: str, light: str, picture: NDArray[np.float32], azimuth: float | None, elevation: float | None, *, axis: bool = False
) -> Case:
    """Return the Case of one picture; ``axis``: the azimuth is known up to a half turn only."""
    guess = guess_light(picture)
    off = None if azimuth is None else abs((guess.azimuth - azimuth + 180) % 360 - 180)
    angle = None
    if azimuth is not None and elevation is not None:
        cosine = np.dot(direction_of(azimuth, elevation), direction_of(guess.azimuth, guess.elevation))
        angle = round(math.degrees(math.acos(min(1.0, float(cosine)))), 1)
    return Case(
        name,
        light,
        None if azimuth is None else round(azimuth, 1),
        None if elevation is None else round(elevation, 1),
        (guess.azimuth, guess.elevation),
        guess.confidence,
        guess.sign_confidence,
        None if off is None or axis else round(off, 1),
        None if off is None else round(min(off, 180 - off), 1),
        angle,
    )


def rendered() -> Iterator[Case]:
    """Details drawn at random, as in tests.benchmarks.recovery, under random lights of 30 to 60 degrees."""
    for index in range(RENDERED):
        detail, light = truth_of(f"unseen-{index}")
        azimuth, elevation = map(float, light.split(","))
        yield case("rendered", str(index), luminance(photo_of(detail, light)), azimuth, elevation)


def captured(name: str) -> Iterator[Case]:
    """Every light of a capture."""
    folder = SHARED / "multilight" / name
    record = json.loads((folder / "lights.json").read_text(encoding="utf-8"))
    linear = record.get("pixel_encoding", "").startswith("treat as linear")
    mosaic = luminance(load_photo(folder / "mosaic_3x3.jpg").pixels) if "layout" in record else None
    for light in record["lights"]:
        if mosaic is not None:
            side, tile = mosaic.shape[0] // 3, light["tile"]
            row, column = divmod(tile, 3)
            picture = mosaic[side * row : side * (row + 1), side * column : side * (column + 1)]
            azimuth, elevation = angles_of((*light["xy_fit_tile_units"], MOSAIC_HEIGHT))
            yield case(name, str(tile), picture, azimuth, elevation)
            continue
        picture = luminance(load_photo(folder / light["file"], encoding="linear" if linear else "srgb").pixels)
        picture = picture[ROCK] if name == "uw_psm_rock" else picture
        if "axis" in light:
            yield case(name, light["file"], picture, 0.0 if light["axis"].startswith("x") else 90.0, None, axis=True)
        elif "azimuth_deg" in light:
            yield case(name, light["file"], picture, float(light["azimuth_deg"]), None)
        else:
            yield case(name, light["file"], picture, *angles_of(tuple(light.get("dir") or light["dir_at_centre"])))


def single(name: str, azimuth: float | None) -> Case:
    folder = SHARED / "photos" / name
    file = next(p for p in sorted(folder.iterdir()) if p.suffix in (".png", ".jpg"))
    return case(name if azimuth is not None else "flash (no azimuth)", name, luminance(load_photo(file).pixels), azimuth, None)


def summary(cases: list[Case]) -> dict[str, Any]:
    """Medians, hits and hits among the confident ones."""
    known = [c for c in cases if c.azimuth_error is not None]
    sure = [c for c in known if c.confidence >= FAIRLY_SURE]
    angles = [c.angle_error for c in cases if c.angle_error is not None]

    def share(chosen: list[Case], limit: float) -> float | None:
        hits = [c.azimuth_error < limit for c in chosen if c.azimuth_error is not None]
        return round(float(np.mean(hits)), 2) if hits else None

    axes = [c.axis_error for c in cases if c.axis_error is not None]
    return {
        "lights": len(cases),
        "axis_median": round(float(np.median(axes)), 1) if axes else None,
        "azimuth_median": round(float(np.median([c.azimuth_error for c in known])), 1) if known else None,
        "angle_median": round(float(np.median(angles)), 1) if angles else None,
        "within_30": share(known, NEAR),
        "right_end": share(known, 90.0),
        "median_confidence": round(float(np.median([c.confidence for c in cases])), 2),
        "confident": sum(c.confidence >= FAIRLY_SURE for c in cases),
        "confident_within_30": share(sure, NEAR),
        "refused": sum(c.confidence < FLOOR for c in cases),
    }


def table(groups: dict[str, list[Case]]) -> str:
    """The results as Markdown."""
    heads = (
        "lights",
        "axis_median",
        "azimuth_median",
        "angle_median",
        "within_30",
        "right_end",
        "median_confidence",
        "confident",
        "confident_within_30",
        "refused",
    )
    lines = [
        "# Guessed lights",
        "",
        "Made by `python -m tests.benchmarks.light_guess -o results/light`. Errors in degrees (medians);"
        f" confident: {FAIRLY_SURE:g} or more; refused: below {FLOOR:g}, where `--light auto` stops.",
        "",
        "| set | " + " | ".join(h.replace("_", " ") for h in heads) + " |",
        "|---|" + "---|" * len(heads),
    ]
    for name, cases in groups.items():
        found = summary(cases)
        lines.append(f"| {name} | " + " | ".join("" if found[h] is None else str(found[h]) for h in heads) + " |")
    columns = ("set", "light", "azimuth, elevation", "guessed", "azimuth error", "angle", "confidence", "of the end")
    lines += ["", "| " + " | ".join(columns) + " |", "|---" * len(columns) + "|"]
    for c in (c for name, cases in groups.items() if not name.startswith("all ") for c in cases):
        true = "" if c.azimuth is None else f"{c.azimuth:g}, " + ("?" if c.elevation is None else f"{c.elevation:g}")
        off = c.azimuth_error if c.azimuth_error is not None else f"{c.axis_error} (axis)" if c.axis_error is not None else ""
        angle = "" if c.angle_error is None else c.angle_error
        guessed = f"{c.guessed[0]:g}, {c.guessed[1]:g}"
        sure = f"{c.confidence:.2f} | {c.sign_confidence:.2f}"
        lines.append(f"| {c.set} | {c.light} | {true} | {guessed} | {off} | {angle} | {sure} |")
    return "\n".join(lines) + "\n"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("-o", "--output", type=Path, default=Path("results/light"))
    arguments = parser.parse_args()
    mitsuba()
    groups = {"rendered": list(rendered())}
    real: list[Case] = []
    for name in CAPTURES:
        if (SHARED / "multilight" / name).is_dir():
            groups[name] = list(captured(name))
            real += groups[name]
    if (SHARED / "photos" / MOON[0]).is_dir():
        groups[MOON[0]] = [single(*MOON)]
        real += groups[MOON[0]]
    flash = [single(name, None) for name in CONTROLS if (SHARED / "photos" / name).is_dir()]
    groups |= {"flash (no azimuth)": flash} if flash else {}
    groups |= {"all real": real} if real else {}
    arguments.output.mkdir(parents=True, exist_ok=True)
    record = {
        "summary": {name: summary(cases) for name, cases in groups.items()},
        "cases": [asdict(c) for name, cases in groups.items() if not name.startswith("all ") for c in cases],
    }
    write_text(arguments.output / "light.json", json.dumps(record, indent=1) + "\n")
    write_text(arguments.output / "light.md", table(groups))
    print("\n".join(table(groups).splitlines()[: 7 + len(groups)]))


if __name__ == "__main__":
    main()
