"""Frames a second of the fit's ray-marcher, and shadows by one sweep against a walk from each place.

Run with:  python -m tests.benchmarks.marching [-o results/volume] [--cells 64 128 256] [--shadows]
A frame is what one evaluation of a fit costs: a grid that has changed is made ready (gradients, empty blocks, sky), the
light is swept through it and the picture of 192 x 192 pixels is marched, one sample a pixel. The density is a shell with
waves on it; "solid" is shaded on its gradient and opaque within two cells, "cloud" scatters once and lets light through,
"white cloud" scatters any number of times. The paper reports 4 to 32 frames a second on a GTX 280 (GD10 section 8).
"""

from __future__ import annotations

import argparse
import json
import os
import platform
import resource
import statistics
import time
from pathlib import Path
from typing import Any

import numpy as np

from voldetail.backend import mitsuba
from voldetail.field.medium import Medium
from voldetail.files import write_text
from voldetail.geometry.density_grid import DensityGrid
from voldetail.render.marched import MarchedVolume
from voldetail.render.unit_components import Components, components
from voldetail.setup.lamp import Lamp
from voldetail.setup.view import View

SIDE, FRAMES = 192, 7
VIEW = View(-1.1, 1.1, -1.1, 1.1, SIDE, SIDE)
LAMP = Lamp(direction=(0.48, 0.36, 0.8))


def shell(cells: int, scale: float = 1.0) -> DensityGrid:
    """Return a hollow ball with a sine displacement, its surface two cells wide; no NumPy copy of the grid is kept."""
    import drjit as dr

    mi = mitsuba()
    index = dr.arange(mi.UInt32, cells**3)
    row = index // cells
    edge = 2.0 / cells
    x, y, z = ((mi.Float(i) + 0.5) * edge - 1.0 for i in (index - row * cells, row % cells, row // cells))
    waves = 0.08 * dr.sin(9.0 * x * scale) * dr.sin(9.0 * y) * dr.sin(9.0 * z)
    outside = dr.abs(dr.sqrt(x * x + y * y + z * z) - 0.6 + waves) - 0.15
    t = dr.clip(0.5 - outside / (2.0 * edge), 0.0, 1.0)
    density = t * t * (3.0 - 2.0 * t)
    dr.eval(density)
    return DensityGrid(density, (cells, cells, cells), (-1.0, -1.0, -1.0), edge)


def media(cells: int) -> dict[str, Medium]:
    return {"solid": Medium(1.5 * cells / 2), "cloud": Medium(5.0, 0.3), "white cloud": Medium(5.0, 0.3, 0.99)}


def frame(volume: MarchedVolume, grid: DensityGrid, medium: Medium) -> tuple[Components, list[float]]:
    """Return a picture and the seconds for making ready, sweeping and marching."""
    import drjit as dr

    times = [time.perf_counter()]
    volume.fill(grid, medium)
    dr.sync_thread()
    times.append(time.perf_counter())
    volume.light_depth(LAMP)
    dr.sync_thread()
    times.append(time.perf_counter())
    seen = components(volume, LAMP, subsamples=1)
    times.append(time.perf_counter())
    return seen, np.diff(times).tolist()


def speed(cells: int) -> dict[str, Any]:
    record: dict[str, Any] = {}
    for name, medium in media(cells).items():
        volume = MarchedVolume(VIEW)
        frame(volume, shell(cells), medium)
        parts = [frame(volume, shell(cells, 1.0 + 0.01 * i), medium)[1] for i in range(FRAMES)]
        total = statistics.median(sum(p) for p in parts)
        ready, sweep, march = (round(1e3 * statistics.median(p), 1) for p in zip(*parts, strict=True))
        record[name] = {
            "frames_a_second": round(1 / total, 2), "frame_ms": round(1e3 * total, 1), "ready_ms": ready,
            "sweep_ms": sweep, "march_ms": march,
        }  # fmt: skip
    # Of the whole process so far: sizes are run in order, so that the largest is the one that counts.
    record["peak_memory_mb"] = round(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024)
    return record


class Walk:
    """Shadows the other way: a walk from each place to the box's faces, at every step of the march."""

    def __init__(self, volume: MarchedVolume, step: float) -> None:
        self.volume, self.step = volume, step * volume.grid.edge

    def at(self, point: Any, active: Any = True) -> Any:
        import drjit as dr

        mi = mitsuba()
        direction = mi.Vector3f(*(dr.opaque(mi.Float, v) for v in LAMP.direction or ()))
        lower, upper = mi.Point3f(*self.volume.grid.lower), mi.Point3f(*self.volume.grid.upper)
        length = dr.min((dr.select(direction > 0.0, upper, lower) - point) / direction)
        h = mi.Float(self.step)

        def more(t: Any, depth: Any) -> Any:
            return active & (t < length)

        def step(t: Any, depth: Any) -> tuple[Any, Any]:
            reach = dr.minimum(h, length - t)
            return t + h, depth + self.volume._density.at(point + (t + 0.5 * reach) * direction).w * reach

        return dr.while_loop((mi.Float(0.0), mi.Float(0.0)), more, step, label="walk to the light")[1]


def shadows(cells: int) -> dict[str, Any]:
    """Return the time of a frame and the error of its diffuse part by a sweep, and by walks of growing steps."""
    record: dict[str, Any] = {}
    for name, medium in media(cells).items():
        volume, grid = MarchedVolume(VIEW), shell(cells)
        volume.fill(grid, medium)
        ways: dict[str, float | None] = {"sweep": None, "walk_0.25": 0.25, "walk_0.5": 0.5, "walk_1": 1.0, "walk_2": 2.0}
        seen: dict[str, tuple[np.ndarray, float]] = {}
        for way, step in ways.items():
            times = []
            for _ in range(4):
                start = time.perf_counter()
                volume._light = None if step is None else (LAMP, Walk(volume, step))  # type: ignore[assignment]
                picture = components(volume, LAMP, subsamples=1).diffuse
                times.append(time.perf_counter() - start)
            seen[way] = picture, statistics.median(times[1:])
        truth = seen["walk_0.25"][0]
        record[name] = {
            way: {"ms": round(1e3 * t, 1), "error": round(float(np.abs(p - truth).mean() / truth.mean()), 5)}
            for way, (p, t) in seen.items()
        }
    return record


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("-o", "--output", type=Path, help="folder for marching.json; without it nothing is written")
    parser.add_argument("--cells", type=int, nargs="+", default=[64, 128, 256], help="cells along the grid's side")
    parser.add_argument("--shadows", action="store_true", help="compare a sweep with walks too (64 cubed)")
    parser.add_argument("--note", default="", help="what else ran on the machine")
    arguments = parser.parse_args()
    record: dict[str, Any] = {
        "pixels": [SIDE, SIDE], "variant": mitsuba().variant(), "machine": platform.machine(), "cores": os.cpu_count(),
        "load_before": [round(v, 1) for v in os.getloadavg()], "note": arguments.note,
        "cells": {str(n): speed(n) for n in sorted(arguments.cells)},
    }  # fmt: skip
    if arguments.shadows:
        record["shadows_64"] = shadows(64)
    text = json.dumps(record, indent=1) + "\n"
    print(text, end="")
    if arguments.output:
        arguments.output.mkdir(parents=True, exist_ok=True)
        write_text(arguments.output / "marching.json", text)


if __name__ == "__main__":
    main()
