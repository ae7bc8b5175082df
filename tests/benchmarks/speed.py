"""Where the time of a fit goes, and how it grows with size.

Run with:  python -m tests.benchmarks.speed -o results/speed
Medians over several details, after a first pass that compiles; two busy cores make any number here vary by a third.
"""

from __future__ import annotations

import argparse
import json
import resource
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from voldetail.backend import mitsuba  # before Dr.Jit, which would pick an LLVM of its own
from voldetail.detail import with_values
from voldetail.files import write_text
from voldetail.fit import fit
from voldetail.fit.candidates import sampled
from voldetail.fit.objective import Objective
from voldetail.fit.reflectance import solve
from voldetail.fit.resolvable import space_of
from voldetail.fit.session import Progress
from voldetail.fit.target import make_target
from voldetail.metric import describe, distance
from voldetail.render.build import build
from voldetail.render.mesh_surface import MeshSurface
from voldetail.render.unit_components import components
from voldetail.setup.file import setup_from

import drjit as dr  # isort: skip

REPEATS = 24


def setup_for(resolution: int = 192, **fit_settings: Any) -> Any:
    return setup_from(
        {
            "photo": {"path": "skimage:gravel", "zone": [100, 100, 256, 256], "resolution": resolution},
            "light": "70,50",
            "fit": fit_settings,
        },
        "speed",
    )


def milliseconds(call: Callable[[], object], repeats: int = 9) -> float:
    """Return the median time of ``call``, after one call that does not count."""
    call()
    times = []
    for _ in range(repeats):
        began = time.perf_counter()
        call()
        times.append(1000 * (time.perf_counter() - began))
    return round(float(np.median(times)), 2)


def evaluations() -> dict[str, Any]:
    """Return evaluations a second over a spread of details, compilations in the second pass, and the parts of one."""
    setup = setup_for()
    target = make_target(setup)
    objective = Objective(target, build(setup, target.shape, target.zone), specular=True)
    space = space_of(setup, target)
    details = [space.decode(c.kind, c.vector) for c in sampled(space, REPEATS, 1, (1.0, 0.0))]
    for detail in details:
        objective.evaluate(detail, 1)
    times = []
    with dr.scoped_set_flag(dr.JitFlag.KernelHistory, True):
        dr.kernel_history_clear()
        for detail in details:
            began = time.perf_counter()
            objective.evaluate(detail, 2)
            times.append(time.perf_counter() - began)
        compiled = sum(1 for kernel in dr.kernel_history((dr.KernelType.JIT,)) if not kernel["cache_hit"])
    detail = with_values(details[0], {"noise.octaves": 2})
    surface = objective.surface
    surface.update(detail)
    parts = components(surface, target.lamp)
    mask = target.mask
    picture = parts.luminance(0.3, 0.5, 0.0, 16.0)

    def noise() -> None:
        surface.update(detail)
        dr.sync_thread()

    return {
        "evaluations_a_second": round(1.0 / float(np.median(times)), 1),
        "kernels_compiled_in_second_pass": compiled,
        "parts_ms": {
            "noise of two octaves, normals, sky": milliseconds(noise),
            "shading with shadows, pooling": milliseconds(lambda: components(surface, target.lamp)),
            "reflectance": milliseconds(lambda: solve(target.luminance, parts, mask)),
            "metric combined": milliseconds(lambda: distance(target.descriptor, describe(picture, like=target.descriptor))),
        },
    }


def growth() -> dict[str, Any]:
    """Return milliseconds of an evaluation against pixels and octaves, and of the mesh's way against vertices."""
    rows: dict[str, Any] = {"pixels": {}, "octaves": {}, "vertices": {}}
    for resolution in (96, 136, 192, 272):
        setup = setup_for(resolution)
        target = make_target(setup)
        objective = Objective(target, build(setup, target.shape, target.zone), specular=True)
        detail = _plain(2)
        rows["pixels"][resolution**2] = milliseconds(partial(objective.evaluate, detail, 3))
    setup = setup_for()
    target = make_target(setup)
    objective = Objective(target, build(setup, target.shape, target.zone), specular=True)
    for octaves in (1, 2, 4, 8):
        rows["octaves"][octaves] = milliseconds(partial(objective.evaluate, _plain(octaves), 3))
    for resolution in (68, 96, 136, 192):
        slow = build(setup_for(resolution), target.shape, target.zone, fast=False)

        def see(surface: Any = slow) -> None:
            surface.update(_plain(2))
            components(surface, target.lamp)

        see()
        assert isinstance(slow, MeshSurface)
        rows["vertices"][len(slow.proxy.positions)] = milliseconds(see, 3)
    return rows


def _plain(octaves: int) -> Any:
    from voldetail.detail import Detail

    return with_values(Detail(), {"noise.octaves": octaves, "noise.scale": 8.0, "noise.lacunarity": 1.3})


def solvers(evaluations_each: int) -> dict[str, Any]:
    """Return what both solvers reach, and when `default` had reached what `paper` ended with, from one run."""
    found: dict[str, Any] = {}
    reached: dict[str, list[tuple[float, float]]] = {}
    for name in ("paper", "default"):
        reached[name] = []

        def note(progress: Progress, where: str = name) -> None:
            reached[where].append((progress.seconds, progress.best))

        result = fit(setup_for(solver=name, metric="published", evaluations=evaluations_each), on_progress=note)
        found[name] = {
            "M": round(result.distance, 4),
            "best": round(min(b for _, b in reached[name]), 4),
            "seconds": round(result.seconds, 1),
            "evaluations": result.evaluations,
        }
    goal = found["paper"]["best"]
    when = {name: next((s for s, best in steps if best <= goal), None) for name, steps in reached.items()}
    found["seconds_to_reach_paper_best"] = when
    if when["paper"] and when["default"]:
        found["ratio"] = round(when["paper"] / when["default"], 2)
    return found


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("-o", "--output", type=Path, default=Path("results/speed"))
    parser.add_argument("--evaluations", type=int, default=1929)
    arguments = parser.parse_args()
    mitsuba()
    arguments.output.mkdir(parents=True, exist_ok=True)
    record: dict[str, Any] = {"at 192 x 192": evaluations(), "growth_ms": growth()}
    print(json.dumps(record, indent=1), flush=True)
    record["solvers, metric published"] = solvers(arguments.evaluations)
    record["peak_memory_gb"] = round(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 2**20, 2)
    write_text(arguments.output / "speed.json", json.dumps(record, indent=1) + "\n")
    print(json.dumps(record, indent=1))


if __name__ == "__main__":
    main()
