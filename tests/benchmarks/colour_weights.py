"""Colour textures by example: how well weights come back, how well clamping filters, and how long things take.

Run with:  python -m tests.benchmarks.colour_weights [-o results/colour] [--side 4096]
Weights: WEIGHT_SEEDS random sets of 9 weights, each a 512 x 512 picture that is analysed again, beside the error that a
finite sample explains (each band's realised deviation in that picture) and beside eq. 12 of the article without its leak.
Aliasing: a plane seen at a slant, clamped, unclamped and the mean of 64 samples a pixel. Round trip: the histogram of each
channel of the photographs by its ten samples. The large picture is made in a process of its own, whose peak memory it tells.
"""

from __future__ import annotations

import argparse
import json
import os
import platform
import resource
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtri

from tests.benchmarks.kept import keep_linear
from voldetail.backend import mitsuba
from voldetail.detail.colour import ColourTexture
from voldetail.files import write_text
from voldetail.image import load_photo, to_srgb
from voldetail.noise.wavelet import wavelet_noise
from voldetail.noise.wavelet_spectrum import variance
from voldetail.texture import analyse, colour_at, picture
from voldetail.texture.curve import curve_at
from voldetail.texture.power import band_powers, weights_of

Floats = NDArray[np.float64]

PHOTOS = Path(__file__).resolve().parents[2] / "shared" / "data" / "photos"
EXAMPLE = "nmo_stone_slab/photo.jpg"
SIDE, BANDS, WEIGHT_SEEDS = 512, 9, 20
GRAZING = (256, 192)
"""Columns and rows of the plane's picture."""

NEAREST, FARTHEST = 0.5, 24.0
"""Texels a pixel at the bottom and the top of the plane's picture."""


def _bands(seed: int) -> Floats:
    """Return the nine bands (9, 4, SIDE, SIDE) of four independent noises."""
    import drjit as dr

    float_type = mitsuba().Float
    noise = wavelet_noise(2, float_type)
    line = np.arange(SIDE, dtype=np.float32)
    points = (float_type(np.tile(line, SIDE)), float_type(np.repeat(line, SIDE)))
    uint = dr.uint32_array_t(float_type)
    found = [
        noise.band(points, dr.opaque(float_type, 2.0**-b), dr.opaque(uint, b), dr.opaque(uint, seed)).numpy()
        for b in range(BANDS)
    ]
    return np.asarray(found, np.float64).reshape(BANDS, -1, SIDE, SIDE)


def weight_recovery() -> dict[str, Any]:
    """Return the root mean square errors by band, finest first."""
    errors: dict[str, list[Floats]] = {"recovered": [], "eq. 12 alone": [], "finite sample": []}
    example = None
    for seed in range(WEIGHT_SEEDS // 4):
        bands = _bands(1000 + seed)
        for channel in range(4):
            weights = np.random.default_rng(4 * seed + channel).uniform(0.0, 1.0, BANDS)
            shown = np.einsum("b,bij->ij", weights, bands[:, channel])
            powers = band_powers(shown - shown.mean())
            found = weights_of(powers, shown.shape)
            errors["recovered"].append(found - weights)
            errors["eq. 12 alone"].append(np.sqrt(powers / variance(2)) - weights)
            realised = np.sqrt(bands[:, channel].var(axis=(1, 2)) / variance(2))
            errors["finite sample"].append(weights * (realised - 1.0))
            example = example or {"true": np.round(weights, 4).tolist(), "recovered": np.round(found, 4).tolist()}
    return {
        "seeds": WEIGHT_SEEDS, "side": SIDE, "weights": "uniform in 0 to 1", "example": example,
        "error": {k: np.round(np.sqrt(np.mean(np.square(v), axis=0)), 4).tolist() for k, v in errors.items()},
        "bias": {k: np.round(np.mean(v, axis=0), 4).tolist() for k, v in errors.items()},
    }  # fmt: skip


def _values(texture: ColourTexture, x: Floats, y: Floats, footprint: Any = 0.0) -> Floats:
    float_type = mitsuba().Float
    points = (float_type(x.astype(np.float32).ravel()), float_type(y.astype(np.float32).ravel()))
    if not isinstance(footprint, float):
        footprint = float_type(footprint.astype(np.float32).ravel())
    made = colour_at(texture, points, footprint)
    return np.stack([v.numpy() for v in made], -1).reshape(*x.shape, 3).astype(np.float64)


def grazing(texture: ColourTexture) -> tuple[dict[str, Any], NDArray[np.float32]]:
    """Return deviations and errors by distance, and the three pictures side by side: truth, clamped, unclamped."""
    columns, rows = GRAZING
    side = np.geomspace(FARTHEST, NEAREST, rows)[:, None] * np.ones(columns)
    x = (np.arange(columns) - columns / 2 + 0.5) * side
    # A row's pixels are squares of texels, and a row begins where the one below it ends.
    y = -np.cumsum(side, axis=0)
    shifts = (np.arange(8) + 0.5) / 8 - 0.5
    truth = np.mean([_values(texture, x + u * side, y + v * side) for u in shifts for v in shifts], axis=0)
    clamped, sharp = _values(texture, x, y, side), _values(texture, x, y)
    found: dict[str, Any] = {"samples": 64, "rows": {}}
    for part in np.array_split(np.arange(rows), 6):
        name = f"{side[part].mean():.2g} texels a pixel"
        shown = {"truth": truth[part], "clamped": clamped[part], "unclamped": sharp[part]}
        found["rows"][name] = {
            "deviation": {k: round(float(v.std(axis=(0, 1)).mean()), 4) for k, v in shown.items()},
            "mean": {k: round(float(v.mean()), 4) for k, v in shown.items()},
            "error": {k: round(float(np.sqrt(np.mean((v - truth[part]) ** 2))), 4) for k, v in shown.items() if k != "truth"},
        }
    gap = np.ones((rows, 6, 3))
    return found, np.concatenate([truth, gap, clamped, gap, sharp], axis=1).astype(np.float32)


def round_trip(span: float, photos: Path) -> dict[str, float]:
    """Return mean and largest error of a channel's histogram by ten samples out to ``span``, in its deviations."""
    z = np.asarray(ndtri((np.arange(20_000) + 0.5) / 20_000))
    places = np.linspace(-span, span, 10)
    errors = []
    for path in sorted(p for p in photos.glob("*/*") if p.suffix in (".png", ".jpg")):
        encoded = to_srgb(np.clip(load_photo(path).pixels[:SIDE, :SIDE], 0, 1)).reshape(-1, 3).astype(np.float64)
        variances, vectors = np.linalg.eigh(np.cov(encoded.T))
        for c in np.flatnonzero(variances > 1e-6):
            values = np.sort(encoded @ vectors[:, c])
            at = np.linspace(0, len(values) - 1, len(z))
            wanted = np.interp(at, np.arange(len(values)), values)
            made = curve_at(np.interp(places, z, wanted), z, places)
            made = wanted.mean() + (made - made.mean()) * (wanted.std() / made.std())
            errors.append(float(np.abs(made - wanted).mean() / wanted.std()))
    return {"mean": round(float(np.mean(errors)), 4), "largest": round(max(errors), 4), "channels": len(errors)}


def timings(photo: NDArray[np.float32], texture: ColourTexture) -> dict[str, Any]:
    """Return seconds of an analysis and millions of texels a second, the second call of each."""
    found: dict[str, Any] = {}
    for _ in range(3):
        start = time.perf_counter()
        analyse(photo)
        found["analysis of 512 x 512, seconds"] = round(time.perf_counter() - start, 3)
    for name, solid in (("2D", False), ("solid", True)):
        for _ in range(2):
            start = time.perf_counter()
            picture(texture, (1024, 1024), solid=solid)
            found[f"million texels a second, {name}"] = round(2**20 / 1e6 / (time.perf_counter() - start), 2)
    return found


def large(side: int, path: str) -> dict[str, Any]:
    """Make one picture of side x side and return what it took, with this process's peak memory."""
    texture = analyse(load_photo(path).pixels[:SIDE, :SIDE])
    picture(texture, (64, 64))
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss // 1024
    start = time.perf_counter()
    made = picture(texture, (side, side))
    return {
        "side": side, "seconds": round(time.perf_counter() - start, 2), "picture_mb": made.nbytes // 2**20,
        "memory_before_mb": before, "peak_memory_mb": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss // 1024,
    }  # fmt: skip


def draw(record: dict[str, Any], path: Path) -> None:
    """Draw the errors by band."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(7, 3.6), layout="constrained")
    axes = figure.subplots()
    bands = np.arange(BANDS)
    for number, (name, values) in enumerate(record["error"].items()):
        axes.bar(bands + 0.27 * (number - 1), values, 0.25, label=name)
    axes.set_xlabel("band, wavelengths of 2^(i+1) to 2^(i+2) texels")
    axes.set_ylabel("root mean square error of w_i")
    axes.set_xticks(bands)
    axes.legend(frameon=False)
    figure.savefig(path, dpi=110)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("-o", "--output", type=Path, help="folder for colour_weights.json and its pictures")
    parser.add_argument("--side", type=int, default=4096, help="side of the large picture")
    parser.add_argument("--photos", type=Path, default=PHOTOS, help="folder of folders of photographs")
    parser.add_argument("--one", action="store_true", help="make the large picture in this process, and print what it took")
    arguments = parser.parse_args()
    path = str(arguments.photos / EXAMPLE)
    if arguments.one:
        print(json.dumps(large(arguments.side, path)))
        return
    mitsuba()
    photo = load_photo(path).pixels[:SIDE, :SIDE]
    texture = analyse(photo)
    slanted, shown = grazing(texture)
    command = [sys.executable, "-m", "tests.benchmarks.colour_weights", "--one", "--side", str(arguments.side)]
    done = subprocess.run([*command, "--photos", str(arguments.photos)], check=True, stdout=subprocess.PIPE, text=True)
    record: dict[str, Any] = {
        "variant": mitsuba().variant(), "machine": platform.machine(), "cores": os.cpu_count(),
        "load_before": [round(v, 1) for v in os.getloadavg()], "weights": weight_recovery(), "grazing plane": slanted,
        "round trip by the outer samples' place": {str(s): round_trip(s, arguments.photos) for s in (2.6, 3.2, 3.8)},
        "timings": timings(photo, texture), "large picture": json.loads(done.stdout.splitlines()[-1]),
    }  # fmt: skip
    text = json.dumps(record, indent=1) + "\n"
    print(text, end="")
    if arguments.output:
        arguments.output.mkdir(parents=True, exist_ok=True)
        write_text(arguments.output / "colour_weights.json", text)
        draw(record["weights"], arguments.output / "colour_weights.png")
        keep_linear(arguments.output / "colour_grazing.jpg", shown)


if __name__ == "__main__":
    main()
