"""How bright a medium of many scatterings is marched, against the path tracer: slabs seen head on, and a lumpy cloud.

Run with:  python -m tests.benchmarks.scattering [-o results/volume] [--passes 4] [--picture cloud.png]
Ratios marched / traced are of mean brightness under the sky alone or a distant lamp alone, which lights the slab's front
(elevation 90 or 45) or its back; None where the tracer's own error is over 10 % or less than 0.2 % of a white surface is
seen. One traced picture holds both albedos, as two of its colours. Of the cloud, the correlation is over all pixels; what
the tracer's grain alone leaves of it is the correlation of two traced pictures, r: the marched picture against their mean
could reach sqrt(2 r / (1 + r)).

Slabs, measured; front 90 is a lamp behind the viewer, back 90 one that shines at him:

                  albedo 0.99                     albedo 0.8
    g     thick.  sky   f 90  f 45  b 90  b 45    sky   f 90  f 45  b 90  b 45
    0.0   0.3      1.00  1.01  1.01  1.01  1.00    1.01  1.00  1.00  1.00  1.00
    0.0   1        1.00  1.02  1.01  1.01  1.00    1.00  1.01  1.00  1.00  0.99
    0.0   3        1.01  0.97  0.97  1.01  1.03    1.00  0.98  0.98  1.04  1.06
    0.0   10       0.99  1.10  1.11  1.07  1.12    0.86  1.02  1.00     -     -
    0.0   30       0.98  1.12  1.12     -     -    0.75  0.85  0.76     -     -
    0.5   0.3      1.00  0.96  0.95  1.00  0.99    0.99  0.97  0.96  1.00  0.99
    0.5   1        1.00  0.93  0.96  0.99  0.98    0.97  0.96  0.99  1.00  0.98
    0.5   3        1.00  0.90  1.01  0.96  0.99    0.96  0.96  1.04  1.00  0.98
    0.5   10       1.02  0.96  1.09  1.21  1.27    1.05  0.94  1.03  1.58  1.21
    0.5   30       1.02  0.98  1.15     -     -    0.94  0.84  0.89     -     -
    0.85  0.3      1.00  1.09  1.12  1.02  0.96    0.97  1.11  1.13  1.02  0.97
    0.85  1        1.00  1.29  1.25  1.08  0.94    0.91  1.35  1.30  1.06  0.94
    0.85  3        1.00  1.19  1.15  1.23  0.93    0.80  1.40  1.38  1.19  0.89
    0.85  10       1.00  0.91  1.05  1.09  0.92    0.94  1.23  1.24  1.35  0.77
    0.85  30       1.07  0.87  1.05  1.36     -    1.74  1.06  1.06     -     -

and the cloud: ratio, correlation (of grain alone), ratio of one scattering:

    g     light albedo 0.99                  albedo 0.8
    0.0   sky   1.00 0.999 (0.999)  0.28    0.92 0.996 (1.000)  0.48
    0.0   side  1.03 0.996 (0.999)  0.30    1.03 0.998 (1.000)  0.50
    0.0   back  1.07 0.996 (0.998)  0.31    1.05 0.999 (0.999)  0.53
    0.5   sky   1.00 0.999 (1.000)  0.18    0.93 0.989 (0.999)  0.36
    0.5   side  1.09 0.976 (0.998)  0.14    1.04 0.982 (0.999)  0.30
    0.5   back  1.14 0.980 (0.999)  0.27    1.05 0.989 (0.999)  0.48
    0.85  sky   1.01 0.999 (1.000)  0.13    1.01 0.957 (0.999)  0.31
    0.85  side  0.92 0.934 (0.976)  0.05    1.05 0.956 (0.977)  0.18
    0.85  back  0.85 0.895 (0.989)  0.07    0.85 0.950 (0.993)  0.20

Of what is brighter than a tenth of white, all is 0.75 to 1.36 times as bright as traced. Too bright: light sent
straight through thick slabs (g > 0) and, dim as it is, what a forward-scattering slab of thickness 1 to 3 sends back. Too
dark: what a thick grey slab turns of the sky where a coarse cell is opaque. The pattern of a strongly forward-scattering
cloud lit from behind is only roughly right (correlation 0.9).
"""

from __future__ import annotations

import argparse
import json
import math
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from voldetail.backend import mitsuba
from voldetail.field.medium import Medium
from voldetail.files import write_text
from voldetail.geometry.density_grid import DensityGrid
from voldetail.image import save_image
from voldetail.render.marched import MarchedVolume
from voldetail.render.traced_medium import TracedVolume
from voldetail.render.unit_components import components, traced_picture
from voldetail.setup.lamp import Lamp
from voldetail.setup.view import View

ALBEDOS, ASYMMETRIES, THICKNESSES = (0.99, 0.8), (0.0, 0.5, 0.85), (0.3, 1.0, 3.0, 10.0, 30.0)
SCATTERINGS, SAMPLES = 1024, 256
MIDDLE, WHOLE = View(-0.2, 0.2, -0.2, 0.2, 16, 16), View(-1.0, 1.0, -1.0, 1.0, 48, 48)
Picture = NDArray[np.float32]


def lamp_at(elevation: float) -> Lamp:
    return Lamp(direction=(math.cos(math.radians(elevation)), 0.0, math.sin(math.radians(elevation))))


LIGHTS: dict[str, Lamp | None] = {
    "sky": None, "front 90": lamp_at(90), "front 45": lamp_at(45), "back 90": lamp_at(-90), "back 45": lamp_at(-45)
}  # fmt: skip
CLOUD_LIGHTS: dict[str, Lamp | None] = {"sky": None, "side": lamp_at(17), "back": lamp_at(-35)}


def grid_of(density: NDArray[Any], edge: float) -> DensityGrid:
    nz, ny, nx = density.shape
    lower = (-0.5 * nx * edge, -0.5 * ny * edge, -0.5 * nz * edge)
    return DensityGrid(mitsuba().Float(density.astype(np.float32).ravel().tolist()), (nz, ny, nx), lower, edge)


def slab() -> DensityGrid:
    """Return a slab of thickness 1/2, four times as wide."""
    return grid_of(np.ones((16, 64, 64)), 2 / 64)


def lumpy(cells: int = 64) -> DensityGrid:
    """Return a ball with lumps, its surface soft over a few cells; about 1.2 across."""
    z, y, x = np.meshgrid(*(3 * [(np.arange(cells) + 0.5) * 2 / cells - 1]), indexing="ij")
    lumps = np.sin(5 * x + 1) * np.sin(5 * y) * np.sin(5 * z + 2) + 0.5 * np.sin(11 * x) * np.sin(11 * y + 1) * np.sin(11 * z)
    return grid_of(np.clip((0.62 + 0.2 * lumps - np.sqrt(x * x + y * y + z * z)) / 0.12 + 0.5, 0, 1), 2 / cells)


def traced(grid: DensityGrid, medium: Medium, view: View, lamp: Lamp | None, passes: int) -> list[Picture]:
    """Return pictures of as many passes, the two albedos last."""
    colour = (*ALBEDOS, ALBEDOS[0])
    scene = TracedVolume(
        grid, medium, view, lamp, sky=1.0 if lamp is None else 0.0, albedo=colour, scatterings=SCATTERINGS
    )  # fmt: skip
    return [traced_picture(scene, SAMPLES, 0.0, seed=k)[..., :2] for k in range(passes)]


def marched(volume: MarchedVolume, lamp: Lamp | None) -> Picture:
    seen = components(volume, lamp or lamp_at(90), subsamples=2, shininess=())
    return seen.ambient if lamp is None else seen.diffuse


def slabs(passes: int) -> dict[str, Any]:
    record: dict[str, Any] = {}
    grid = slab()
    volumes = [MarchedVolume(MIDDLE) for _ in ALBEDOS]
    for g in ASYMMETRIES:
        for thickness in THICKNESSES:
            for volume, albedo in zip(volumes, ALBEDOS, strict=True):
                volume.fill(grid, Medium(thickness / 0.5, g, albedo))
            for name, lamp in LIGHTS.items():
                pictures = np.mean(traced(grid, Medium(thickness / 0.5, g), MIDDLE, lamp, passes), axis=0)
                truth = pictures.mean(axis=(0, 1))
                error = pictures.std(axis=(0, 1)) / math.sqrt(pictures[..., 0].size)
                found = [float(marched(volume, lamp).mean()) for volume in volumes]
                record[f"g {g}, thickness {thickness}, {name}"] = {
                    f"albedo {a}": {
                        "traced": float(f"{t:.4g}"), "error": float(f"{e:.1g}"), "marched": float(f"{m:.4g}"),
                        "ratio": round(m / t, 3) if t > 2e-3 and e < 0.1 * t else None,
                    }
                    for a, t, e, m in zip(ALBEDOS, truth.tolist(), error.tolist(), found, strict=True)
                }  # fmt: skip
    return record


def cloud(passes: int, extinction: float = 12.0) -> tuple[dict[str, Any], list[Picture]]:
    """Return the ratios and correlations, and the pictures: traced, marched, marched with one scattering, by turns."""
    record: dict[str, Any] = {}
    grid, shown = lumpy(), []
    for g in (0.0, 0.5, 0.85):
        for name, lamp in CLOUD_LIGHTS.items():
            pictures = traced(grid, Medium(extinction, g), WHOLE, lamp, 2 * (passes // 2))
            halves = [np.mean(pictures[k::2], axis=0) for k in (0, 1)]
            case: dict[str, Any] = {}
            for k, albedo in enumerate(ALBEDOS):
                truth = 0.5 * (halves[0] + halves[1])[..., k]
                seen = []
                for given in (albedo, None):
                    volume = MarchedVolume(WHOLE)
                    volume.fill(grid, Medium(extinction, g, given))
                    seen.append(marched(volume, lamp) * (1.0 if given is not None else albedo))
                r = float(np.corrcoef(halves[0][..., k].ravel(), halves[1][..., k].ravel())[0, 1])
                many, one = (float(np.corrcoef(p.ravel(), truth.ravel())[0, 1]) for p in seen)
                case[f"albedo {albedo}"] = {
                    "traced": float(f"{truth.mean():.4g}"), "ratio": round(float(seen[0].mean() / truth.mean()), 3),
                    "correlation": round(many, 3), "of_grain": round(math.sqrt(2 * r / (1 + r)), 3),
                    "once_ratio": round(float(seen[1].mean() / truth.mean()), 3), "once_correlation": round(one, 3),
                }  # fmt: skip
                if k == 0 and g != 0.5:
                    shown += [truth, *seen]
            record[f"g {g}, {name}"] = case
    return record, shown


def side_by_side(pictures: list[Picture]) -> Picture:
    """Return rows of three, each as bright as its first, which is the truth."""
    rows = []
    for first in range(0, len(pictures), 3):
        white = float(np.percentile(pictures[first], 99.5))
        rows.append(np.concatenate([np.clip(p / white, 0, 1) for p in pictures[first : first + 3]], axis=1))
    grey = np.concatenate(rows, axis=0).repeat(3, axis=0).repeat(3, axis=1)
    return np.repeat(grey[..., None], 3, axis=2).astype(np.float32)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("-o", "--output", type=Path, help="folder for scattering.json; without it nothing is written")
    parser.add_argument("--passes", type=int, default=4, help=f"traced passes of {SAMPLES} samples a pixel; at least 2")
    parser.add_argument("--picture", type=Path, help="write the cloud's pictures here: traced, marched, one scattering")
    arguments = parser.parse_args()
    clouds, shown = cloud(arguments.passes)
    if arguments.picture:
        save_image(arguments.picture, side_by_side(shown))
    record = {
        "samples": SAMPLES * arguments.passes, "scatterings": SCATTERINGS, "cloud": clouds, "slabs": slabs(arguments.passes)
    }  # fmt: skip
    text = json.dumps(record, indent=1) + "\n"
    print(text, end="")
    if arguments.output:
        arguments.output.mkdir(parents=True, exist_ok=True)
        write_text(arguments.output / "scattering.json", text)


if __name__ == "__main__":
    main()
