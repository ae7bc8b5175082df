"""Noise points a second beside pyfastnoiselite's cellular noise, in one process; run with --benchmark-only."""

from types import ModuleType
from typing import Any

import numpy as np
import pytest

from voldetail.backend import mitsuba

mi: ModuleType = mitsuba()  # before Dr.Jit is imported, which would pick an LLVM of its own

import drjit as dr  # noqa: E402

from voldetail.noise import NoiseSettings, relief_function  # noqa: E402

POINTS = 1 << 18
SCALE = 10.0


def positions() -> np.ndarray:
    """POINTS positions in a box of 20 x 20 x 20 cells, (3, N) float32."""
    return np.random.default_rng(1).uniform(-1, 1, (3, POINTS)).astype(np.float32)


def note(benchmark: Any) -> None:
    benchmark.extra_info["million points a second"] = round(POINTS / benchmark.stats.stats.min / 1e6, 2)


@pytest.mark.benchmark(group="noise in space, one octave", min_rounds=5, warmup=True, warmup_iterations=2)
@pytest.mark.parametrize("phi", [0.0, 2.0], ids=["plain", "stripes"])
@pytest.mark.parametrize("ranks", [(1, 1), (1, 2), (2, 3), (1, 50)], ids=str)
def test_relief_function(benchmark: Any, ranks: tuple[int, int], phi: float) -> None:
    points = tuple(mi.Float(axis) for axis in positions())
    settings = NoiseSettings.from_ranks(3, *ranks)
    number = {"scale": SCALE, "anisotropy": 1.0, "angle": 0.0, "lacunarity": 2.0}
    number |= {"stripe_frequency": phi, "stripe_spread": 1.0}
    values = {name: dr.opaque(mi.Float, value) for name, value in number.items()}
    curve, seed = mi.Float(np.linspace(0, 1, 11)), dr.opaque(mi.UInt32, 1)
    dr.eval(points, curve)

    def once() -> None:
        dr.eval(relief_function(points, settings, seed, curve=curve, **values)[0])
        dr.sync_thread()

    benchmark(once)
    note(benchmark)


@pytest.mark.benchmark(group="noise in space, one octave", min_rounds=5)
def test_pyfastnoiselite_cellular(benchmark: Any) -> None:
    fastnoise = pytest.importorskip("pyfastnoiselite.pyfastnoiselite")
    noise = fastnoise.FastNoiseLite(seed=1)
    noise.noise_type = fastnoise.NoiseType.NoiseType_Cellular
    noise.cellular_return_type = fastnoise.CellularReturnType.CellularReturnType_Distance
    noise.frequency = SCALE
    points = positions()
    benchmark(lambda: noise.gen_from_coords(points))
    note(benchmark)
