"""The noise against a second implementation, its bits and its continuity."""

from types import ModuleType
from typing import Any

import numpy as np
import pytest
from noise_reference import feature_points, kernels, relief, single_octave, window
from scipy.spatial import cKDTree

from voldetail.backend import mitsuba

mi: ModuleType = mitsuba()  # before Dr.Jit is imported, which would pick an LLVM of its own

import drjit as dr  # noqa: E402
from drjit.llvm.ad import Float64  # noqa: E402

from voldetail.noise import KERNEL_RADIUS, NoiseSettings, gabor, relief_function  # noqa: E402

SALT = 1993
SETS = [(1, 50), (1, 1), (1, 2), (2, 2), (2, 3), (3, 3)]
PARAMETERS = {
    "scale": 3.1,
    "anisotropy": 1.4,
    "angle": 0.6,
    "lacunarity": 1.9,
    "gain": 0.8,
    "stripe_frequency": 1.7,
    "stripe_spread": 2.2,
    "curve": np.array([0.0, 0.05, 0.2, 0.1, 0.4, 0.5, 0.7, 0.65, 0.9, 0.95, 1.0]),
}


def columns(x: np.ndarray, float_type: Any = Float64) -> tuple[Any, ...]:
    return tuple(float_type(np.ascontiguousarray(x[:, axis])) for axis in range(x.shape[1]))


def octave_of(x: np.ndarray, ranks: tuple[int, int], phi: float, theta: float, gaussian: bool = False) -> np.ndarray:
    settings = NoiseSettings.from_ranks(x.shape[1], *ranks, 1, gaussian)
    salt, phi, theta = dr.opaque(mi.UInt32, SALT), dr.opaque(Float64, phi), dr.opaque(Float64, theta)
    return gabor.single_octave(columns(x), settings, salt, phi, theta).numpy()


def relief_of(x: np.ndarray, settings: NoiseSettings, float_type: Any = Float64, seed: int = SALT, **changed: Any) -> Any:
    values = {name: dr.opaque(float_type, v) for name, v in PARAMETERS.items() if name != "curve"}
    values["curve"] = float_type(PARAMETERS["curve"])
    values |= {name: float_type(v) for name, v in changed.items()}
    return relief_function(columns(x, float_type), settings, dr.opaque(mi.UInt32, seed), **values)[0]


@pytest.mark.parametrize("dims", [2, 3])
@pytest.mark.parametrize("phi", [0.0, 2.0])
def test_the_sum_is_that_over_the_fifty_nearest(dims: int, phi: float) -> None:
    x = np.random.default_rng(dims).uniform(0, 12, (20_000, dims))
    cells = np.stack(np.meshgrid(*[np.arange(-4, 16)] * dims, indexing="ij"), -1).reshape(-1, dims)
    points, words = feature_points(cells, SALT)
    tree = cKDTree(points)
    distances, found = tree.query(x, k=50, workers=2)
    envelope, stripes = kernels(distances, x[:, None] - points[found], words[found], phi, 1.1, gaussian=False)
    expected = (envelope * stripes * window(distances, dims)).sum(1)
    assert octave_of(x, (1, 50), phi, 1.1) == pytest.approx(expected, abs=1e-9)
    within = tree.query_ball_point(x, KERNEL_RADIUS[dims], return_length=True, workers=2)
    assert within.max() <= 50
    assert distances[:, -1].min() > KERNEL_RADIUS[dims]


@pytest.mark.parametrize(("ranks", "gaussian"), [*((s, False) for s in SETS), ((1, 50), True), ((2, 2), True)])
@pytest.mark.parametrize("dims", [2, 3])
def test_whole_relief_against_a_second_implementation(dims: int, ranks: tuple[int, int], gaussian: bool) -> None:
    x = np.random.default_rng(7).uniform(-30, 30, (2000, dims))
    octaves = 1 if ranks == (1, 2) else 2
    expected = relief(x, *ranks, SALT, octaves=octaves, gaussian=gaussian, **PARAMETERS)
    settings = NoiseSettings.from_ranks(dims, *ranks, octaves, gaussian)
    assert relief_of(x, settings).numpy() == pytest.approx(expected, abs=1e-6)


@pytest.mark.parametrize("octaves", [1, 4])
def test_single_precision_near_the_origin(octaves: int) -> None:
    x = np.random.default_rng(8).uniform(-1, 1, (2000, 3)).astype(np.float32)
    settings = NoiseSettings.from_ranks(3, 1, 2, octaves)
    expected = relief(x.astype(np.float64), 1, 2, SALT, octaves=octaves, gaussian=False, **PARAMETERS)
    assert relief_of(x, settings, mi.Float).numpy() == pytest.approx(expected, abs=2e-4)


@pytest.mark.parametrize("ranks", [(0, 1), (2, 1), (1, 4), (2, 50)])
def test_other_sets_of_points_are_refused(ranks: tuple[int, int]) -> None:
    with pytest.raises(ValueError, match="neither"):
        NoiseSettings.from_ranks(3, *ranks)


@pytest.mark.parametrize("ranks", [(1, 50), (2, 3)])
def test_same_bits_for_any_threads_order_and_chunks(ranks: tuple[int, int]) -> None:
    rng = np.random.default_rng(3)
    x = rng.uniform(-5, 5, (100_003, 3)).astype(np.float32)
    settings = NoiseSettings.from_ranks(3, *ranks, 2)

    def bits(x: np.ndarray) -> np.ndarray:
        return relief_of(x, settings, mi.Float).numpy().view(np.uint32)

    before = dr.thread_count()
    try:
        dr.set_thread_count(1)
        alone = bits(x)
        dr.set_thread_count(2)
        together = bits(x)
    finally:
        dr.set_thread_count(before)
    assert np.array_equal(alone, together)
    order = rng.permutation(len(x))
    assert np.array_equal(bits(x[order]), alone[order])
    pieces = [x[:1], x[1:20], x[20:50_001], x[50_001:]]
    assert np.array_equal(np.concatenate([bits(piece) for piece in pieces]), alone)


def test_the_seed_changes_everything() -> None:
    x = np.random.default_rng(3).uniform(-5, 5, (20_000, 3))
    settings = NoiseSettings.from_ranks(3, 1, 2)
    a, b = (relief_of(x, settings, seed=seed).numpy() for seed in (SALT, SALT + 1))
    assert abs(np.corrcoef(a, b)[0, 1]) < 0.03


def steepest(ranks: tuple[int, int], phi: float) -> float:
    """A bound on the slope of N: envelope 2, stripes 2 pi phi, fades 2 / RANK_FADE times at most 2."""
    each = 2.0 + 2 * np.pi * phi
    if ranks == (1, 50):
        return 22 * (each + 2.0)  # the window's slope is below 2
    fades = (ranks[0] > 1) + 1
    return (ranks[1] - ranks[0] + 1) * (each + (fades * 2 * 2 / 0.15 if phi > 0 else 0.0))


def largest_step(dims: int, ranks: tuple[int, int], phi: float, step: float) -> float:
    """The largest change between neighbours along random lines."""
    rng = np.random.default_rng(17)
    largest = 0.0
    for _ in range(4):
        direction = rng.normal(size=dims)
        direction /= np.linalg.norm(direction)
        line = rng.uniform(-9, 9, dims) + np.arange(50_000)[:, None] * step * direction
        largest = max(largest, float(np.abs(np.diff(octave_of(line, ranks, phi, 2.0))).max()))
    return largest


@pytest.mark.parametrize("phi", [0.0, 4.0])
@pytest.mark.parametrize("ranks", SETS)
@pytest.mark.parametrize("dims", [2, 3])
def test_no_jump_along_lines(dims: int, ranks: tuple[int, int], phi: float) -> None:
    step = 2e-5 if ranks == (1, 50) else 1e-4
    assert largest_step(dims, ranks, phi, step) < steepest(ranks, phi) * step


@pytest.mark.parametrize("ranks", [(1, 1), (1, 2), (2, 3)])
def test_without_the_fade_there_are_jumps(ranks: tuple[int, int], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(gabor, "RANK_FADE", 1e-9)
    assert largest_step(2, ranks, 1.0, 1e-4) > 3 * steepest(ranks, 1.0) * 1e-4


@pytest.mark.parametrize("phi", [4.0])
@pytest.mark.parametrize("ranks", SETS)
@pytest.mark.parametrize("dims", [2, 3])
def test_no_jump_across_borders_of_cells(dims: int, ranks: tuple[int, int], phi: float) -> None:
    # Half-cell planes too: there the order of the search changes.
    rng = np.random.default_rng(5)
    x = rng.uniform(-9, 9, (5000, dims))
    axis = rng.integers(0, dims, 5000)
    x[np.arange(5000), axis] = np.round(x[np.arange(5000), axis] * 2) / 2
    nudge = np.eye(dims)[axis] * 1e-8
    jump = np.abs(octave_of(x + nudge, ranks, phi, 2.0) - octave_of(x - nudge, ranks, phi, 2.0))
    assert jump.max() < steepest(ranks, phi) * 2e-8 + 1e-12


def test_octave_in_double_is_the_reference_near_and_far() -> None:
    x = np.random.default_rng(6).uniform(-1, 1, (2000, 3)) + np.array([1e5, -1e5, 0.0])
    assert octave_of(x, (2, 3), 2.0, 1.0) == pytest.approx(single_octave(x, 2, 3, SALT, 2.0, 1.0), abs=1e-7)


def test_signed_points_are_continuous_and_vanish_at_borders_of_grains() -> None:
    settings = NoiseSettings.from_ranks(2, 1, 2, signs=(1.0, -1.0, 1.0))
    line = np.array([0.3, -7.0]) + np.arange(100_000)[:, None] * 1e-4 * np.array([0.8, 0.6])

    def signed(phi: float) -> np.ndarray:
        arrays = dr.opaque(mi.UInt32, SALT), dr.opaque(Float64, phi), dr.opaque(Float64, 2.0)
        return gabor.single_octave(columns(line), settings, *arrays).numpy()

    plain = signed(0.0)
    expected = octave_of(line, (1, 1), 0.0, 0.0) - octave_of(line, (2, 2), 0.0, 0.0)
    assert plain == pytest.approx(expected, abs=1e-12)
    assert plain.min() < 1e-3  # the line crosses several borders
    # Two changes of weight beside each point, not one.
    assert np.abs(np.diff(signed(2.0))).max() < 2 * steepest((2, 3), 2.0) * 1e-4
