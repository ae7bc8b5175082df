"""Anisotropic photos and their noises: the same spectrum with random phases, the lobes, and the isotropic fallback.

Run with:  python -m tests.benchmarks.colour_lobes [-o results/colour] [--data ../shared/data]
Each photo's luminance (encoded as sRGB, as `ColourTexture` has it) is mapped by rank to a Gaussian channel z, and every noise
goes back through the same map. Errors are half the sum of the absolute differences of two power spectra, of unit sum, in blocks
that grow with the frequency: 0 the same, 1 nowhere alike. A single picture's spectrum is itself a sample, so the error of
a Gaussian field of the photo's own estimated spectrum, "resampled", is what can be expected of a new sample.
"""

from __future__ import annotations

import argparse
import json
import os
import platform
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import RegularGridInterpolator
from scipy.stats import norm

from tests.benchmarks.sparse_gabor import sparse_gabor
from voldetail.backend import mitsuba
from voldetail.files import write_text
from voldetail.image import load_photo, luminance, resize, save_jpeg, to_linear, to_srgb
from voldetail.noise.lobes import lobe_noise, lobe_table
from voldetail.texture.isotropy import isotropy_of
from voldetail.texture.lobes import lobe_rows, lobes_of
from voldetail.texture.mixture import binned
from voldetail.texture.spectrum import Spectrum, power_spectrum

Picture = NDArray[np.float64]

PHOTOS: dict[str, tuple[str, float, str]] = {
    "bark": ("pbr/ambientCG_Bark014/albedo.jpg", 1.0, "ambientCG Bark014, CC0"),
    "brick": ("photos/skimage_brick/brick.png", 1.0, "scikit-image, CC0"),
    "rock": ("photos/duion_rock_rough_plants_01/photo.jpg", 1.0, "Christian Femmer aka Duion, CC-BY 3.0"),
    "wicker": ("photos/nmo_wicker/photo.jpg", 3.0, "(c) 2019 Christian Petry, MIT"),
    "metal": ("textures/portilla_simoncelli/metal.png", 1.0, "Portilla and Simoncelli's examples, MIT"),
    "skin": ("textures/portilla_simoncelli/reptil_skin.png", 1.0, "Portilla and Simoncelli's examples, MIT"),
}
"""Name to file, texels of the file a texel (by which it is made smaller), and whose it is. Shown."""

NUMBERS_ONLY: dict[str, tuple[str, float, str]] = {
    "furrowed bark": ("photos/ns_bark/photo.jpg", 1.0, ""),
    "ripples": ("photos/ns_sand_ripples/photo.jpg", 1.0, ""),
    "denim": ("photos/flash_train_0253/flash.jpg", 2.0, ""),
    "wood": ("textures/nonstationary_zhou2018/209.jpg", 1.0, ""),
    "water": ("textures/nonstationary_zhou2018/419.jpg", 1.0, ""),
}
"""Photos whose licence does not let them be shown."""

SIDE, SHOWN, SEEDS, COUNTS = 512, 256, 4, (8, 16, 24, 40)
SPEED_POINTS, SPEED_LOBES, IMPULSES = 1 << 18, 30, (1, 2, 5)


def grey(path: Path, smaller: float) -> Picture:
    """Return the encoded luminance of the middle of a photo, at most SIDE a side."""
    linear = load_photo(path).pixels
    if smaller != 1:
        linear = resize(linear, (round(linear.shape[0] / smaller), round(linear.shape[1] / smaller)))
    whole = to_srgb(luminance(linear)).astype(float)
    top, left = (max(0, (n - SIDE) // 2) for n in whole.shape)
    return whole[top : top + SIDE, left : left + SIDE]


def gaussianised(picture: Picture) -> Picture:
    order = picture.ravel().argsort(kind="stable").argsort(kind="stable")
    return np.asarray(norm.ppf((order + 0.5) / picture.size).reshape(picture.shape))


def mapped(noise: Picture, picture: Picture) -> Picture:
    """Return a Gaussian noise of deviation 1 with the histogram of ``picture``."""
    return np.asarray(np.quantile(picture, norm.cdf(noise)))


def random_phase(z: Picture, seed: int) -> Picture:
    """Return z's periodic component (Moisan 2011) with random phases: its own power, bin by bin."""
    h, w = z.shape
    border = np.zeros_like(z)
    border[0], border[-1] = z[0] - z[-1], z[-1] - z[0]
    border[:, 0] += z[:, 0] - z[:, -1]
    border[:, -1] += z[:, -1] - z[:, 0]
    y, x = np.meshgrid(np.arange(h) / h, np.arange(w) / w, indexing="ij")
    laplacian = 2 * np.cos(2 * np.pi * y) + 2 * np.cos(2 * np.pi * x) - 4
    laplacian[0, 0] = 1
    smooth = np.fft.fft2(border) / laplacian
    smooth[0, 0] = 0
    white = np.fft.fft2(np.random.default_rng(seed).standard_normal(z.shape))
    return unit(np.fft.ifft2(np.abs(np.fft.fft2(z) - smooth) * white / np.abs(white)).real)


def from_spectrum(spectrum: Spectrum, shape: tuple[int, int], seed: int, radial: bool) -> Picture:
    """Return part of a Gaussian field of ``spectrum``, or of its mean over all directions."""
    n = [2 * side for side in shape]
    fy, fx = np.meshgrid(np.fft.fftfreq(n[0]), np.fft.rfftfreq(n[1]), indexing="ij")
    if radial:
        radius = np.hypot(*np.meshgrid(spectrum.fx, spectrum.fy))
        ring = np.round(radius / spectrum.fx[1]).astype(int)
        means = np.bincount(ring.ravel(), spectrum.power.ravel()) / np.maximum(np.bincount(ring.ravel()), 1)
        power = np.interp(np.hypot(fx, fy) / spectrum.fx[1], np.arange(len(means)), means)
    else:
        order = np.argsort(spectrum.fy)
        axes = (spectrum.fy[order], spectrum.fx)
        grid = RegularGridInterpolator(axes, spectrum.power[order], bounds_error=False, fill_value=None)
        power = np.maximum(grid(np.stack([-fy, fx], -1)), 0)
    white = np.fft.rfft2(np.random.default_rng(seed).standard_normal(n))
    return unit(np.fft.irfft2(white * np.sqrt(power), s=n)[: shape[0], : shape[1]])


def unit(noise: Picture) -> Picture:
    return np.asarray((noise - noise.mean()) / noise.std())


def of_lobes(rows: NDArray[np.float64], shape: tuple[int, int], seed: int) -> Picture:
    mi = mitsuba()
    y, x = np.mgrid[: shape[0], : shape[1]].astype(np.float32)
    value, _ = lobe_noise((mi.Float(x.ravel()), mi.Float(-y.ravel())), lobe_table(rows, mi.Float), mi.UInt32(seed))
    return value.numpy().reshape(shape).astype(float) / float(np.sqrt(rows[:, 4].sum()))


def share(picture: Picture) -> NDArray[np.float64]:
    """Return the spectrum in a number of blocks that depends on the shape alone, of unit sum."""
    spectrum = power_spectrum(picture)
    return binned(spectrum.power, spectrum.fx, spectrum.fy).power


def measure(picture: Picture) -> tuple[dict[str, Any], dict[str, Picture]]:
    """Return the figures of one photo, and its pictures."""
    z = gaussianised(picture)
    start = time.perf_counter()
    lobes = lobes_of(z)
    seconds = time.perf_counter() - start
    spectrum, tested = power_spectrum(z), isotropy_of(z)
    ways = {
        "random phase": lambda seed: random_phase(z, seed),
        "resampled": lambda seed: from_spectrum(spectrum, z.shape, seed, False),
        "lobes": lambda seed: of_lobes(lobe_rows(lobes), z.shape, seed),
        "isotropic": lambda seed: from_spectrum(spectrum, z.shape, seed, True),
    }
    own, own_mapped = share(z), share(picture)
    errors, pictures = {}, {"photo": picture}
    for name, way in ways.items():
        noises = [way(seed) for seed in range(SEEDS)]
        pictures[name] = mapped(noises[0], picture)
        found = {
            "of the channel": np.mean([np.abs(share(n) - own).sum() / 2 for n in noises]),
            "of the mean of 4": np.abs(np.mean([share(n) for n in noises], 0) - own).sum() / 2,
            "of the picture": np.mean([np.abs(share(mapped(n, picture)) - own_mapped).sum() / 2 for n in noises]),
        }
        errors[name] = {k: round(float(v), 4) for k, v in found.items()}
    by_count = {}
    for count in COUNTS:
        rows = lobe_rows(lobes_of(z, count=count))
        mean = np.mean([share(of_lobes(rows, z.shape, seed)) for seed in range(SEEDS)], 0)
        by_count[str(count)] = round(float(np.abs(mean - own).sum() / 2), 4)
    record = {
        "texels": list(z.shape), "lobes": len(lobes), "seconds_of_analysis": round(seconds, 2), "spectrum_error": errors,
        "error_of_the_mean_of_4_by_count": by_count, "anisotropy": round(tested.statistic, 3), "isotropic": tested.isotropic,
    }  # fmt: skip
    return record, pictures


def speed() -> dict[str, Any]:
    """Return processor and wall seconds a million texels of three channels, for the noise and for sparse Gabor noise."""
    import drjit as dr

    mi = mitsuba()
    rng = np.random.default_rng(1)
    places = rng.uniform(-1e4, 1e4, (2, SPEED_POINTS)).astype(np.float32)
    points = (mi.Float(places[0]), mi.Float(places[1]))
    uniform = [rng.uniform(a, b, SPEED_LOBES) for a, b in ((0.02, 0.4), (0, np.pi), (0.005, 0.05), (0.005, 0.05), (0, 1))]
    rows = np.stack(uniform, 1)
    table = lobe_table(rows, mi.Float)
    ways: dict[str, Callable[[Any], Any]] = {
        "lobes": lambda seed: lobe_noise(points, table, seed)[0],
        "lobes, filtered": lambda seed: lobe_noise(points, table, seed, dr.opaque(mi.Float, 0.5))[0],
    }
    for count in IMPULSES:
        ways[f"sparse Gabor, {count} a cell"] = partial(sparse_gabor, points, rows, count)
    found: dict[str, Any] = {}
    for name, way in ways.items():
        best = [np.inf, np.inf]
        values: Any = None
        for turn in range(4):
            seeds = [dr.opaque(mi.UInt32, 3 * turn + channel) for channel in range(3)]
            clocks = time.process_time(), time.perf_counter()
            values = [way(seed) for seed in seeds]
            dr.eval(values)
            dr.sync_thread()
            if turn:  # the first compiles
                best = [min(best[0], time.process_time() - clocks[0]), min(best[1], time.perf_counter() - clocks[1])]
        noise = values[0].numpy().astype(float)
        scale = SPEED_POINTS / 1e6
        found[name] = {
            "processor_seconds": round(best[0] / scale, 3), "million_texels_a_second": round(scale / best[1], 2),
            "kurtosis": round(float((noise**4).mean() / noise.var() ** 2), 3),
        }  # fmt: skip
    return found


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("-o", "--output", type=Path, help="folder for lobes.json and lobes.jpg; without it nothing is written")
    parser.add_argument("--data", type=Path, default=Path("../shared/data"), help="the folder of test data")
    parser.add_argument("--note", default="", help="what else ran on the machine")
    arguments = parser.parse_args()
    record: dict[str, Any] = {
        "variant": mitsuba().variant(), "machine": platform.machine(), "cores": os.cpu_count(),
        "load_before": [round(v, 1) for v in os.getloadavg()], "note": arguments.note,
        "speed_of_three_channels_of_30_lobes": speed(), "photos": {},
    }  # fmt: skip
    rows = []
    for name, (file, smaller, credit) in (PHOTOS | NUMBERS_ONLY).items():
        found, pictures = measure(grey(arguments.data / file, smaller))
        record["photos"][name] = found | {"credit": credit}
        print(name, json.dumps(found["spectrum_error"]), found["error_of_the_mean_of_4_by_count"], flush=True)
        if name in PHOTOS:
            shown = [pictures[way][:SHOWN, :SHOWN] for way in ("photo", "random phase", "lobes", "isotropic")]
            rows.append(np.concatenate([np.pad(p, 2, constant_values=1.0) for p in shown], axis=1))
    print(json.dumps(record["speed_of_three_channels_of_30_lobes"], indent=1))
    if arguments.output:
        arguments.output.mkdir(parents=True, exist_ok=True)
        write_text(arguments.output / "lobes.json", json.dumps(record, indent=1) + "\n")
        sheet = to_linear(np.concatenate(rows, axis=0))
        save_jpeg(arguments.output / "lobes.jpg", np.repeat(sheet[..., None], 3, axis=2))


if __name__ == "__main__":
    main()
