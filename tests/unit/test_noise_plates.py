"""Plates: against a second implementation, without jumps, their laws, gradients, and nothing where they are off."""

from functools import cache
from types import ModuleType
from typing import Any

import numpy as np
import pytest
from noise_reference import plates as reference
from noise_reference import single_octave as reference_octave
from scipy.stats import kstest

from voldetail.backend import mitsuba

mi: ModuleType = mitsuba()  # before Dr.Jit is imported, which would pick an LLVM of its own

import drjit as dr  # noqa: E402
from drjit.llvm.ad import Float64  # noqa: E402

from voldetail.detail import Detail, with_values  # noqa: E402
from voldetail.field.relief import relief_at, settings_of  # noqa: E402
from voldetail.noise import (  # noqa: E402
    NoiseSettings,
    PlateShape,
    nearest_points,
    number_of,
    plate_numbers,
    relief_function,
    single_octave,
)
from voldetail.noise.plates import plate  # noqa: E402

SALT = 1993
SHAPES = [(1.3, 0.0, 0.12), (0.0, 2.0, 0.05), (2.0, 1.5, 0.5)]
VALUES = {"scale": 3.1, "anisotropy": 1.4, "angle": 0.6, "lacunarity": 1.9, "stripe_frequency": 0.0, "stripe_spread": 0.0}


def columns(x: np.ndarray, float_type: Any = Float64) -> tuple[Any, ...]:
    return tuple(float_type(np.ascontiguousarray(c)) for c in x.T)


def plates_of(x: np.ndarray, shape: tuple[float, float, float]) -> np.ndarray:
    points = columns(x)
    nearest = nearest_points(points, mi.UInt32(SALT), 1)[1][0]
    return plate(points, dr.opaque(mi.UInt32, SALT), nearest, PlateShape(*(dr.opaque(Float64, v) for v in shape))).numpy()


def relief_of(x: np.ndarray, shape: tuple[float, float, float], settings: NoiseSettings) -> np.ndarray:
    values = {name: dr.opaque(mi.Float, value) for name, value in VALUES.items()}
    numbers = PlateShape(*(dr.opaque(mi.Float, v) for v in shape))
    curve = mi.Float(np.linspace(0, 1, 11))
    seed = dr.opaque(mi.UInt32, 5)
    return relief_function(columns(x, mi.Float), settings, seed, curve=curve, plates=numbers, **values)[0].numpy()


@pytest.mark.parametrize("shape", SHAPES, ids=str)
@pytest.mark.parametrize("dims", [2, 3])
def test_against_a_second_implementation(dims: int, shape: tuple[float, float, float]) -> None:
    x = np.random.default_rng(dims).uniform(-40, 40, (4000, dims))
    expected = reference(x, SALT, *shape)
    assert plates_of(x, shape) == pytest.approx(expected, abs=1e-9)
    assert np.ptp(expected) > 0.5


@pytest.mark.parametrize("ranks", [(1, 1), (1, 2), (2, 3)])
def test_an_octave_is_its_kernels_and_its_plates(ranks: tuple[int, int]) -> None:
    x = np.random.default_rng(4).uniform(-20, 20, (2000, 3))
    numbers = (dr.opaque(Float64, v) for v in (1.7, 1.1, *SHAPES[2]))
    found = single_octave(columns(x), NoiseSettings.from_ranks(3, *ranks, plates=True), mi.UInt32(SALT), *numbers).numpy()
    assert found == pytest.approx(reference_octave(x, *ranks, SALT, 1.7, 1.1) + reference(x, SALT, *SHAPES[2]), abs=1e-6)


@pytest.mark.parametrize("dims", [2, 3])
def test_plates_join_without_a_jump_and_vanish_on_borders(dims: int) -> None:
    height, tilt, bevel = shape = (2.0, 2.0, 0.1)
    step = 1e-4
    direction = np.array([0.6, 0.8]) if dims == 2 else np.array([0.6, 0.48, 0.64])
    line = np.array([0.3, -7.0, 2.0])[:dims] + np.arange(200_000)[:, None] * step * direction
    found = plates_of(line, shape)
    owner = nearest_points(columns(line), mi.UInt32(SALT), 1)[0][0].numpy()
    # The bevel's slope is 2 / w at the border and no plane is higher than o + t (1/2 + D_1).
    steepest = (height + tilt * (0.5 + owner.max())) * 2 / bevel + tilt
    assert np.abs(np.diff(found)).max() < steepest * step
    distances = nearest_points(columns(line), mi.UInt32(SALT), 2)[0]
    on_border = distances[1].numpy() - distances[0].numpy() < 2 * step
    assert on_border.sum() > 10
    assert np.abs(found[on_border]).max() < steepest * 3 * step


@pytest.mark.parametrize("dims", [2, 3])
def test_away_from_its_border_a_plate_is_flat(dims: int) -> None:
    x = np.random.default_rng(6).uniform(-20, 20, (5000, dims))
    h = np.eye(dims)[0] * 1e-3
    low, middle, high = (plates_of(x + sign * h, (1.0, 2.0, 0.05)) for sign in (-1, 0, 1))
    flat = np.abs(low - 2 * middle + high) < 1e-9
    assert flat.mean() > 0.6  # all but the bevels


def test_heights_and_directions_follow_their_laws() -> None:
    words = mi.UInt32(np.random.default_rng(8).integers(0, 2**32, 40_000, dtype=np.uint32))
    height, direction = plate_numbers(words, Float64)
    u, g = height.numpy(), np.stack([d.numpy() for d in direction])
    assert kstest(u, "uniform").pvalue > 0.01
    assert u.var() == pytest.approx(1 / 12, rel=0.02)
    assert np.linalg.norm(g, axis=0) == pytest.approx(1.0, abs=1e-9)
    # Uniform on the sphere: no mean, a third of the square along each axis, each coordinate uniform (Archimedes).
    assert np.abs(g.mean(1)).max() < 0.015
    assert g @ g.T / g.shape[1] == pytest.approx(np.eye(3) / 3, abs=0.01)
    assert kstest(g[0], "uniform", (-1, 2)).pvalue > 0.01
    albedo = number_of(words, Float64).numpy()
    assert np.abs(np.corrcoef(np.stack([u, albedo, *g]))[~np.eye(5, dtype=bool)]).max() < 0.02


def test_slopes_within_a_plane_are_even_in_all_directions_and_the_same_in_both_domains() -> None:
    squares = []
    for dims in (2, 3):
        x = np.random.default_rng(9).uniform(-300, 300, (40_000, dims))
        if dims == 3:
            x[:, 2] = 0.3
        slopes = []
        for axis in (0, 1):
            h = np.eye(dims)[axis] * 1e-4
            slopes.append((plates_of(x + h, (0.0, 1.0, 0.01)) - plates_of(x - h, (0.0, 1.0, 0.01))) / 2e-4)
        inner = np.hypot(*slopes) <= 1.0  # the others cross a bevel
        s = np.array(slopes)[:, inner]
        assert inner.mean() > 0.85
        assert s @ s.T / s.shape[1] == pytest.approx(np.eye(2) / 3, abs=0.02)
        squares.append((s**2).mean())
    assert squares[0] == pytest.approx(squares[1], rel=0.03)


@pytest.mark.parametrize("dims", [2, 3])
def test_relief_of_plates_is_standardised_and_the_same_in_any_order(dims: int) -> None:
    x = np.random.default_rng(8).uniform(-30, 30, (50_000, dims)).astype(np.float32)
    settings = NoiseSettings.from_ranks(dims, 1, 2, 2, signs=(1.0, -1.0, 1.0), plates=True)
    relief = relief_of(x, SHAPES[2], settings)
    t = 2.0 * relief.astype(np.float64) - 1.0
    score = 1.5 * t / np.sqrt(1 - t**2)  # ETA, and back through t = z / sqrt(1 + z^2)
    assert abs(score.mean()) < 0.1
    assert score.std() == pytest.approx(1.0, abs=0.06)
    order = np.random.default_rng(9).permutation(len(x))
    assert np.array_equal(relief_of(x[order], SHAPES[2], settings), relief[order])


def test_plates_of_no_height_and_no_tilt_are_none_to_the_bit() -> None:
    x = np.random.default_rng(8).uniform(-5, 5, (50_000, 3)).astype(np.float32)
    detail = with_values(Detail(seed=11), {"noise.bevel": 0.3})
    assert not settings_of(detail).plates
    off, plain = (relief_at(d, columns(x, mi.Float)).numpy() for d in (detail, Detail(seed=11)))
    assert np.array_equal(off, plain)
    settings = NoiseSettings.from_ranks(3, 1, 2, 2)
    on = relief_of(x, (0.0, 0.0, 0.3), NoiseSettings.from_ranks(3, 1, 2, 2, plates=True))
    assert np.array_equal(on, relief_of(x, (0.0, 0.0, 0.3), settings))  # nor do they come in with a step


def test_where_all_points_count_there_are_no_plates() -> None:
    x = columns(np.random.default_rng(8).uniform(-5, 5, (2000, 3)), mi.Float)
    plain = with_values(Detail(), {"noise.last_neighbour": 50})
    raised = with_values(plain, {"noise.cell_height": 2.0, "noise.cell_tilt": 1.0})
    assert np.array_equal(relief_at(raised, x).numpy(), relief_at(plain, x).numpy())
    with pytest.raises(ValueError, match="plates"):
        NoiseSettings.from_ranks(3, 1, 50, plates=True)


def test_other_numbers_compile_nothing() -> None:
    x = columns(np.random.default_rng(8).uniform(-5, 5, (2000, 3)), mi.Float)

    def compiled(height: float, tilt: float, bevel: float) -> int:
        detail = with_values(Detail(), {"noise.cell_height": height, "noise.cell_tilt": tilt, "noise.bevel": bevel})
        with dr.scoped_set_flag(dr.JitFlag.KernelHistory):
            dr.kernel_history_clear()
            dr.eval(relief_at(detail, x))
            kernels = [entry for entry in dr.kernel_history() if entry["type"] == dr.KernelType.JIT]
        assert len(kernels) >= 2  # the moments and the relief
        return sum(not entry["cache_hit"] for entry in kernels)

    # The first two: which of them computes what the finer octaves share decides how their kernels look.
    for number in range(2):
        compiled(1.0 + 0.1 * number, 1.0, 0.1)
    # A number that had become code would compile each time; once in some runs a kernel is met in another form.
    assert min(compiled(0.1 * number, 2.3 + 0.1 * number, 0.21 + 0.01 * number) for number in range(3)) == 0


NAMES = ("height", "tilt", "bevel", "x", "y", "scale", "angle")
POINTS = np.random.default_rng(11).uniform(-2, 2, (300, 2))


def relief_moved(offsets: dict[str, Any]) -> Any:
    """R with an offset added to all it depends on, so that every derivative shares a kernel."""
    values = {name: dr.opaque(Float64, value) + offsets.get(name, 0.0) for name, value in VALUES.items()}
    numbers = {"height": 1.5, "tilt": 2.0, "bevel": 0.2}
    shape = PlateShape(*(dr.opaque(Float64, v) + offsets[name] for name, v in numbers.items()))
    x, y = columns(POINTS)
    settings = NoiseSettings.from_ranks(2, 1, 2, 1, signs=(1.0, -1.0, 1.0), plates=True)
    curve = Float64(np.linspace(0, 1, 11))
    return relief_function((x + offsets["x"], y + offsets["y"]), settings, mi.UInt32(5), curve=curve, plates=shape, **values)[0]


def offsets_of(**steps: float) -> dict[str, Any]:
    return {name: dr.opaque(Float64, steps.get(name, 0.0)) for name in NAMES}


@cache
def reverse() -> dict[str, np.ndarray]:
    offsets = offsets_of()
    dr.enable_grad(offsets)
    dr.backward(dr.sum(relief_moved(offsets)))
    return {name: dr.grad(offset).numpy() for name, offset in offsets.items()}


@pytest.mark.parametrize("name", NAMES)
def test_gradients_against_differences(name: str) -> None:
    high, low = (relief_moved(offsets_of(**{name: sign * 1e-6})).numpy() for sign in (1, -1))
    expected = (high - low) / 2e-6
    offsets = offsets_of()
    dr.enable_grad(offsets[name])
    value = relief_moved(offsets)
    dr.set_grad(offsets[name], 1.0)
    dr.forward_to(value)
    size = np.abs(expected).max()
    assert size > 1e-2
    # The moments' slope in the plates' numbers is itself a difference quotient, of step 0.01.
    tolerance = 5e-3 if name in ("height", "tilt", "bevel") else 1e-5
    assert np.abs(np.array(dr.grad(value)) - expected).max() < tolerance * size
    assert reverse()[name].sum() == pytest.approx(expected.sum(), abs=tolerance * np.abs(expected).sum())
