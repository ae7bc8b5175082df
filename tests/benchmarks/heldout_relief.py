"""Scanned reliefs: photos rendered from them are fitted, and the fitted relief is compared with the true one.

Run with:  python -m tests.benchmarks.heldout_relief -o results/heldout [--only NAME ...] [--evaluations N]
Height maps are those of ../shared/data/pbr, but for cc0textures_sand, whose height was made from its albedo. A cut is
rendered with a uniform albedo under one light and fitted under that light. Fitted and true relief are compared by the
distribution of heights (about their mean, which no photo shows), of slopes, by octave bands of the spectrum, and by
renderings under lights that the fit never saw. Beside the fit stand the photo's brightness taken for height, scaled to
the fit's slopes, and another cut of the same scan, which says how near one can hope to come.
"""

from __future__ import annotations

import argparse
import itertools
import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image
from scipy.ndimage import gaussian_filter
from scipy.stats import wasserstein_distance

from tests.benchmarks.relit import (
    SHARED,
    Picture,
    Yardstick,
    height_record,
    heights_of,
    lit_picture,
    markdown,
    raise_by_brightness,
    raise_to,
    reflectance_under,
    save_sheet,
    slopes,
)
from voldetail.detail import Reflectance
from voldetail.files import write_text
from voldetail.fit import fit
from voldetail.image import Photo, luminance, resize, to_linear, to_srgb
from voldetail.render.build import build
from voldetail.render.heightfield import HeightField
from voldetail.setup.file import setup_from
from voldetail.setup.lamp import Lamp
from voldetail.setup.light import direction_of

SIDE = 192
"""Pixels of a photo, the fit's default."""

PBR = SHARED / "pbr"

LIGHT = "60,40"
OTHER_LIGHTS = tuple((45.0 * k, 40.0) for k in range(8))
"""Azimuth and elevation of lights from all sides, none of them the photo's."""

GRAZING = (150.0, 10.0)
"""Low and across the photo's light: what is wrong with the relief shows here first."""

TRUE_REFLECTANCE = Reflectance(ambient=0.15, diffuse=0.5, specular=0.0, shininess=16.0)

BLUR = 1.5
"""Pixels of the scan: 8-bit heights are steps, and their slopes noise, without."""

BANDS = (2, 4, 8, 16, 32, 64)
"""Wavelengths in pixels between which the spectrum is compared; longer ones are too few in a cut to have a mean."""


@dataclass(frozen=True)
class Scan:
    """A height map: its file, its amplitude in pixels of its own width, the width it is reduced to, its credit if free."""

    name: str
    amplitude: float
    width: int = 512
    credit: str = ""
    file: str = "height.jpg"


SCANS = (
    Scan("ambientCG_Bark014", 13.0, credit="CC0, ambientCG"),
    Scan("ambientCG_Rock058", 51.0, credit="CC0, ambientCG"),
    Scan("polyhaven_grave_stone", 18.5, credit="CC0, Poly Haven"),
    Scan("polyhaven_gray_rocks", 35.0, credit="CC0, Poly Haven"),
    # Structured, a control: all of it, since a smaller cut holds no two stones.
    Scan("polyhaven_stone_brick_wall_001", 64.0, 256, credit="CC0, Poly Haven"),
    # The amplitude is not recorded; this is the middle of what its set's note proposes.
    Scan("yiweihu_ground_height16", 25.0, file="height.png"),
)  # fmt: skip
"""Amplitudes are those that the manifest of ../shared/data measured against the normal maps."""


def cut(scan: Scan, surface: HeightField, *, other: bool = False) -> NDArray[np.float64]:
    """Return heights in scene units for all vertices of ``surface``: a corner of the scan, or the ``other`` one.

    The plane that fits best is taken away: a tilt belongs to the proxy.
    """
    image = Image.open(PBR / scan.name / scan.file)
    values = np.asarray(image, dtype=np.float64) / (65535.0 if image.mode.startswith("I") else 255.0)
    values = values[..., 0] if values.ndim == 3 else values
    reduced = resize(gaussian_filter(values, BLUR, mode="wrap"), (scan.width, scan.width)).astype(np.float64)
    if other:
        # The scans are seamless.
        reduced = np.roll(reduced, (scan.width // 2, scan.width // 2), axis=(0, 1))
    part = reduced[: surface.rows, : surface.columns] * scan.amplitude * (scan.width / values.shape[1]) * surface.step
    row, column = np.mgrid[: surface.rows, : surface.columns]
    plane = np.stack([row.ravel(), column.ravel(), np.ones(part.size)], axis=1)
    return np.asarray(part - (plane @ np.linalg.lstsq(plane, part.ravel(), rcond=None)[0]).reshape(part.shape))


def bands(heights: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the mean power of a height map in each octave of BANDS."""
    window = np.outer(np.hanning(heights.shape[0]), np.hanning(heights.shape[1]))
    power = np.abs(np.fft.fft2((heights - heights.mean()) * window)) ** 2
    frequency = np.hypot(np.fft.fftfreq(heights.shape[0])[:, None], np.fft.fftfreq(heights.shape[1])[None, :])
    edges = itertools.pairwise(BANDS)
    return np.array([power[(frequency > 1 / long) & (frequency <= 1 / short)].mean() for short, long in edges])


def compare(found: NDArray[np.float64], true: NDArray[np.float64], step: float) -> dict[str, Any]:
    """Return how two height maps over the same window differ; all but the amplitude ratio are 0 for the same."""
    steep, true_steep = slopes(found, step).ravel(), slopes(true, step).ravel()
    decades = np.log10(np.maximum(bands(found), 1e-30) / bands(true))
    high, true_high = (found - found.mean()).ravel(), (true - true.mean()).ravel()
    return {
        "heights": round(float(wasserstein_distance(high, true_high) / true.std()), 3),
        "slopes": round(float(wasserstein_distance(steep, true_steep) / true_steep.std()), 3),
        "spectrum": round(float(np.sqrt(np.mean(decades**2))), 3),
        "spectrum_bands": [round(float(d), 3) for d in decades],
        "amplitude_ratio": round(float(found.std() / true.std()), 3),
    }


def run(scan: Scan, evaluations: int | None, sheets: Path | None) -> dict[str, Any]:
    """Fit one scan's photo and compare; returns the record."""
    setup = setup_from(
        {
            "photo": {"path": "rendered.png", "resolution": SIDE, "zone": [0, 0, SIDE, SIDE]},
            "light": LIGHT,
            "fit": {"evaluations": evaluations, "library": "none"},
        },
        scan.name,
    )

    def surface() -> HeightField:
        made = build(setup, (SIDE, SIDE), (0, 0, SIDE, SIDE))
        assert isinstance(made, HeightField)
        return made

    truth, other, fitted, bumps = (surface() for _ in range(4))
    raise_to(truth, cut(scan, truth))
    raise_to(other, cut(scan, other, other=True))
    assert setup.light.direction is not None
    encoded = np.round(to_srgb(np.clip(lit_picture(truth, Lamp(setup.light.direction), TRUE_REFLECTANCE), 0, 1)) * 255) / 255
    photo = np.asarray(to_linear(encoded), dtype=np.float32)
    result = fit(setup, photo=Photo(photo, "0" * 64, ()))
    fitted.update(result.detail)
    steepness = float(np.sqrt(np.mean(slopes(heights_of(fitted), fitted.step) ** 2)))
    raise_by_brightness(bumps, luminance(photo), steepness)

    candidates = {
        "fit": (fitted, result.detail.reflectance),
        "brightness": (bumps, reflectance_under(bumps, result.target, specular=setup.fit.specular)),
        "other_cut": (other, TRUE_REFLECTANCE),
    }
    lights: list[dict[str, Any]] = []
    rows: list[list[Picture]] = [[photo, lit_picture(fitted, result.target.lamp, result.detail.reflectance)]]
    for azimuth, elevation in (*OTHER_LIGHTS, GRAZING):
        lamp = Lamp(direction_of(azimuth, elevation))
        true = lit_picture(truth, lamp, TRUE_REFLECTANCE)
        yardstick = Yardstick(luminance(true), result.target.mask, ("combined",))
        pictures = {name: lit_picture(seen, lamp, reflectance) for name, (seen, reflectance) in candidates.items()}
        ratios = {name: yardstick.ratios(luminance(picture))["combined"] for name, picture in pictures.items()}
        lights.append({"light": f"{azimuth:g},{elevation:g}", "halves": round(yardstick.halves["combined"], 4), "ratios": ratios})
        # Opposite the photo's light, and the lowest.
        if (azimuth, elevation) in ((225.0, 40.0), GRAZING):
            rows.append([true, pictures["fit"]])
    if sheets is not None:
        save_sheet(sheets / f"heldout_relief_{scan.name}.jpg", [[picture for row in rows for picture in row]])
    true_heights = heights_of(truth)
    needed = float(true_heights.std() / heights_of(fitted).std())
    assert result.heights is not None
    return {
        "heights": height_record(result.heights, result.detail.relief.amplitude, needed),
        "scan": scan.name,
        "credit": scan.credit,
        "light": LIGHT,
        "evaluations": result.evaluations,
        "seconds": round(result.seconds, 1),
        "true_std": round(float(true_heights.std()), 5),
        "true_slope": round(float(np.sqrt(np.mean(slopes(true_heights, truth.step) ** 2))), 3),
        "relief": {name: compare(heights_of(seen), true_heights, truth.step) for name, (seen, _) in candidates.items()},
        "lights": lights,
    }


def table(records: list[dict[str, Any]]) -> str:
    """Each scan's numbers, for the fit and what stands beside it."""
    rows = []
    for record in records:
        for name, numbers in record["relief"].items():
            ratios = [light["ratios"][name] for light in record["lights"]]
            relief = (numbers[key] for key in ("heights", "slopes", "spectrum", "amplitude_ratio"))
            rows.append(
                [
                    record["scan"],
                    name.replace("_", " "),
                    *relief,
                    f"{float(np.median(ratios[:-1])):.2f}",
                    f"{ratios[-1]:.2f}",
                ]
            )
    return (
        "Heights, slopes: 1-Wasserstein distance in standard deviations of the true ones. Spectrum: root mean square of the"
        " decades between bands. Other lights (median of 8), grazing: distance over that between the true halves.\n\n"
        + markdown(["scan", "relief", "heights", "slopes", "spectrum", "amplitude", "other lights", "grazing"], rows)
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("-o", "--output", type=Path, default=Path("results/heldout"))
    parser.add_argument("--unshown", type=Path)
    parser.add_argument("--only", action="append", choices=[scan.name for scan in SCANS])
    parser.add_argument("--evaluations", type=int)
    arguments = parser.parse_args()
    records = []
    for scan in SCANS:
        if arguments.only and scan.name not in arguments.only:
            continue
        if not (PBR / scan.name / scan.file).exists():
            print(f"{scan.name}: skipped, it is not there")
            continue
        records.append(run(scan, arguments.evaluations, arguments.output if scan.credit else arguments.unshown))
        print(json.dumps({key: value for key, value in records[-1].items() if key != "lights"}), flush=True)
    print(table(records))
    if not arguments.only:
        write_text(arguments.output / "heldout_relief.json", json.dumps(records, indent=1) + "\n")
        write_text(arguments.output / "heldout_relief.md", table(records))


if __name__ == "__main__":
    main()
