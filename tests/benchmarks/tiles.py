"""Memory and time of a hypertexture's surface, from the grid as a whole and by tiles.

Run with:  python -m tests.benchmarks.tiles [-o results/volume] [--cells 128 256 512 1024] [--dense-up-to 512]
The object is a sphere with relief of a tenth of its radius. Each surface is made by a process of its own, since its peak
memory is the process's; the memory of the program before it begins is stated beside it.
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

from voldetail.backend import mitsuba
from voldetail.detail import Detail
from voldetail.field.hypertexture import Hypertexture
from voldetail.field.shell import make_shell
from voldetail.field.shell_blocks import near_blocks
from voldetail.field.shell_grid import block_counts
from voldetail.field.shell_plan import plan_shell
from voldetail.field.tiled_surface import tiled_isosurface
from voldetail.files import write_text
from voldetail.geometry.isosurface import isosurface
from voldetail.setup.proxy import ProxySetup

AMPLITUDE, SCALE = 0.1, 4.0
WAYS = ("tiled", "dense")
UNLIMITED = 1 << 50


def peak() -> int:
    """Return the most memory that this process has had, in MB (Linux counts it in kB)."""
    return round(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024)


def measure(way: str, cells: int) -> dict[str, Any]:
    """Make the surface of a sphere on a grid of ``cells`` a side, and return what it took."""
    # A sphere 2 across, relief and half a shell of three cells on both sides, and a cell of room.
    edge = (2 + 2 * AMPLITUDE) / (cells - 5)
    proxy = ProxySetup(kind="sphere")
    plan = plan_shell(proxy, edge, 3 * edge, AMPLITUDE, UNLIMITED)
    detail = Detail.model_validate({"noise": {"scale": SCALE}, "relief": {"amplitude": AMPLITUDE}})
    texture = Hypertexture(make_shell(plan), detail)
    before = peak()
    start = time.perf_counter()
    if way == "dense":
        surface = isosurface(texture.bake(), texture.level, texture.outward_at, budget=UNLIMITED)
    else:
        surface = tiled_isosurface(texture, budget=UNLIMITED)
    record: dict[str, Any] = {
        "shape": list(plan.shape), "seconds": round(time.perf_counter() - start, 1), "peak_memory_mb": peak(),
        "memory_before_mb": before, "vertices": len(surface.vertices), "faces": len(surface.faces), "dropped": surface.dropped,
    }  # fmt: skip
    if way == "tiled":
        nz, ny, nx = block_counts(plan.shape)
        planned = plan_shell(proxy, edge, 3 * edge, AMPLITUDE, tiles=True)
        record |= {"blocks": len(near_blocks(plan)), "blocks_of_grid": nz * ny * nx, "planned": planned.sentence}
    return record


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("-o", "--output", type=Path, help="folder for tiles.json; without it nothing is written")
    parser.add_argument("--cells", type=int, nargs="+", default=[128, 256, 512, 1024], help="cells along the grid's side")
    parser.add_argument("--dense-up-to", type=int, default=512, help="largest grid that is also filled as a whole")
    parser.add_argument("--note", default="", help="what else ran on the machine")
    parser.add_argument("--one", choices=WAYS, help="make one surface in this process, and print what it took")
    arguments = parser.parse_args()
    if arguments.one:
        print(json.dumps(measure(arguments.one, arguments.cells[0])))
        return
    record: dict[str, Any] = {
        "object": "sphere", "amplitude": AMPLITUDE, "scale": SCALE, "variant": mitsuba().variant(),
        "machine": platform.machine(), "cores": os.cpu_count(), "load_before": [round(v, 1) for v in os.getloadavg()],
        "note": arguments.note, "cells": {},
    }  # fmt: skip
    for cells in sorted(arguments.cells):
        found = {}
        for way in WAYS if cells <= arguments.dense_up_to else WAYS[:1]:
            command = [sys.executable, "-m", "tests.benchmarks.tiles", "--one", way, "--cells", str(cells)]
            done = subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True)
            found[way] = json.loads(done.stdout.splitlines()[-1])
        record["cells"][str(cells)] = found
    text = json.dumps(record, indent=1) + "\n"
    print(text, end="")
    if arguments.output:
        arguments.output.mkdir(parents=True, exist_ok=True)
        write_text(arguments.output / "tiles.json", text)


if __name__ == "__main__":
    main()
