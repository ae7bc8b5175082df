"""Scanned reliefs: how near recovered normals come, against a flat photo and brightness taken for height.

Run with:  python -m tests.benchmarks.relief_scans -o results/relief [--only NAME ...]
Photos of SIDE pixels are rendered from the scans of ../shared/data/pbr by Mitsuba (a traced mesh, and not the shader that the
network learnt from), at azimuth AZIMUTH and three elevations, with even albedo and with the scan's own, and stored in 8 bits.
Then the angle between true and recovered normals, mean and median, and how slopes along and across the light correlate.
Brightness has its best scale from the truth; the others have nothing.
"""

from __future__ import annotations

import argparse
import json
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image
from scipy.ndimage import gaussian_filter

from tests.benchmarks.heldout_relief import BLUR, PBR, SCANS, Scan
from voldetail.apply import render
from voldetail.detail.photo_relief import MappedDetail, PhotoRelief
from voldetail.detail.record import Reflectance, ReliefParameters
from voldetail.detail.relief_maps import normals_of
from voldetail.files import write_text
from voldetail.image import Photo, luminance, resize, to_linear, to_srgb
from voldetail.recover.files import unsaved_maps
from voldetail.recover.recovery import recover
from voldetail.recover.slopes import Method
from voldetail.setup.light import Light, direction_of

SIDE = 256
"""Pixels of a photo."""

AZIMUTH, ELEVATIONS = 20.0, (20.0, 45.0, 70.0)

SKY = 0.3
"""Share of a bare plane's light that comes from the sky."""

METHODS: tuple[Method, ...] = ("linear", "network")

Array = NDArray[np.float32]


def scan_detail(scan: Scan, *, real: bool) -> MappedDetail:
    """Return a corner of the scan as a detail, its albedo its own where ``real``."""
    image = Image.open(PBR / scan.name / scan.file)
    values = np.asarray(image, dtype=np.float64) / (65535.0 if image.mode.startswith("I") else 255.0)
    values = values[..., 0] if values.ndim == 3 else values
    reduced = resize(gaussian_filter(values, BLUR, mode="wrap"), (scan.width, scan.width))[:SIDE, :SIDE].astype(np.float64)
    height = reduced * scan.amplitude * (scan.width / values.shape[1]) * (2.0 / SIDE)
    albedo = np.full((SIDE, SIDE, 3), 0.5, np.float32)
    if real:
        picture = to_linear(np.asarray(Image.open(PBR / scan.name / "albedo.jpg").convert("RGB"), np.float64) / 255.0)
        albedo = resize(picture.astype(np.float32), (scan.width, scan.width))[:SIDE, :SIDE]
    amplitude = float(np.ptp(height))
    record = PhotoRelief(
        name=scan.name, columns=SIDE, rows=SIDE, texels_per_unit=SIDE / 2.0, relief=ReliefParameters(amplitude=amplitude),
        reflectance=Reflectance(ambient=0.5 * SKY, diffuse=0.5 * (1 - SKY)), light="0,90", confidence=1.0, maps=unsaved_maps(),
    )  # fmt: skip
    relative = ((height - height.min()) / amplitude).astype(np.float32)
    return MappedDetail(record, relative, np.ascontiguousarray(albedo), np.full((SIDE, SIDE), 0.9, np.float32))


def photo_of(detail: MappedDetail, elevation: float) -> Photo:
    """Return what Mitsuba's rays see of it, in 8 bits."""
    light = Light(direction=direction_of(AZIMUTH, elevation))
    # Ka is under a sky that does not know the lamp's height: its share is that of the plane.
    r = detail.reflectance
    lamp = np.sin(np.radians(elevation))
    shown = detail.record.model_copy(update={"reflectance": r.model_copy(update={"ambient": r.ambient * float(lamp)})})
    picture = render(
        MappedDetail(shown, detail.height, detail.albedo, detail.roughness), "plane", light=light, size=(SIDE, SIDE), subsamples=2
    )
    exposed = picture * (0.3 / float(luminance(picture).mean()))
    stored = np.round(to_srgb(np.clip(exposed, 0, 1)) * 255) / 255
    return Photo(np.asarray(to_linear(stored), np.float32), "0" * 64, ())


def angles(normals: Array, true: Array) -> NDArray[np.float64]:
    """Return the angles between unit normals (H, W, 3) in degrees, but for a rim of 4 pixels."""
    cosine = np.clip((normals * true).sum(axis=-1), -1.0, 1.0)
    return np.degrees(np.arccos(cosine))[4:-4, 4:-4]


def by_brightness(photo: Photo, true: Array, steps: int = 40) -> Array:
    """Return the normals of brightness taken for height, at the scale at which they are nearest to the ``true`` ones."""
    light = luminance(photo.pixels)
    bumps = gaussian_filter(light - gaussian_filter(light, SIDE / 8), 1.0) / max(float(light.mean()), 1e-6)
    found = [normals_of(bumps * np.float32(gain), 1.0) for gain in np.geomspace(0.02, 20.0, steps)]
    return min(found, key=lambda n: float(angles(n, true).mean()))


def correlations(normals: Array, true: Array) -> tuple[float, float]:
    """Return how slopes along and across the light go with the true ones."""
    a = np.radians(AZIMUTH)
    out = []
    for x, y in ((np.cos(a), np.sin(a)), (-np.sin(a), np.cos(a))):
        one, other = ((-(n[..., 0] * x + n[..., 1] * y) / n[..., 2])[4:-4, 4:-4].ravel() for n in (normals, true))
        out.append(float(np.corrcoef(one, other)[0, 1]) if one.std() > 1e-9 else 0.0)
    return out[0], out[1]


def run(scan: Scan, *, real: bool, elevation: float) -> dict[str, Any]:
    """Return the record of one photo."""
    detail = scan_detail(scan, real=real)
    photo = photo_of(detail, elevation)
    true = normals_of(detail.height * np.float32(detail.relief.amplitude), detail.record.texels_per_unit)
    light = Light(direction=direction_of(AZIMUTH, elevation))
    flat = np.zeros_like(true)
    flat[..., 2] = 1.0
    found = {"flat": flat, "brightness": by_brightness(photo, true)}
    for method in METHODS:
        found[method] = recover(photo, light, method=method).normal
    methods = {}
    for name, normals in found.items():
        apart = angles(normals, true)
        along, across = correlations(normals, true)
        methods[name] = {
            "mean": round(float(apart.mean()), 2), "median": round(float(np.median(apart)), 2),
            "along": round(along, 3), "across": round(across, 3),
        }  # fmt: skip
    return {"scan": scan.name, "albedo": "real" if real else "even", "elevation": elevation, "methods": methods}


def table(records: list[dict[str, Any]]) -> str:
    """Return the mean angles as a table."""
    names = list(records[0]["methods"])
    lines = ["| scan | albedo | elevation | " + " | ".join(names) + " |", "|---" * (3 + len(names)) + "|"]
    for record in records:
        numbers = " | ".join(f"{record['methods'][name]['mean']:.1f}" for name in names)
        lines.append(f"| {record['scan']} | {record['albedo']} | {record['elevation']:g} | {numbers} |")
    return "\n".join(lines) + "\n"


def main() -> None:
    """Measure all scans."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("-o", "--output", type=Path, default=Path("results/relief"))
    parser.add_argument("--only", nargs="+", default=None)
    parser.add_argument("--elevations", nargs="+", type=float, default=list(ELEVATIONS))
    given = parser.parse_args()
    records = []
    for scan in SCANS:
        if given.only and scan.name not in given.only:
            continue
        for real in (False, True):
            if real and not (PBR / scan.name / "albedo.jpg").exists():
                continue
            for elevation in given.elevations:
                records.append(run(scan, real=real, elevation=elevation))
                print(records[-1], flush=True)
    given.output.mkdir(parents=True, exist_ok=True)
    write_text(given.output / "scans.json", json.dumps(records, indent=1) + "\n")
    write_text(given.output / "scans.md", table(records))
    print(table(records))


if __name__ == "__main__":
    main()
