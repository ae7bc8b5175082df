"""Stones: against a second implementation, their shape, that they join without a jump, and what is said of them."""

from types import ModuleType
from typing import Any

import numpy as np
import pytest
from noise_reference import highest_stone as reference
from scipy.stats import kstest

from voldetail.backend import mitsuba

mi: ModuleType = mitsuba()  # before Dr.Jit is imported, which would pick an LLVM of its own

import drjit as dr  # noqa: E402
from drjit.llvm.ad import Float64  # noqa: E402

from voldetail.noise import NoiseSettings, StoneShape, nearest_points, number_of, relief_function  # noqa: E402
from voldetail.noise.stones import STONE_RADIUS, highest_stone  # noqa: E402

SALT = 1993
SHAPES = [(0.0, 1.0, 0.0), (1.0, 1.0, 0.0), (0.6, 2.1, 0.5), (1.0, 4.0, 0.8)]


def grains_of(x: np.ndarray, shape: tuple[float, float, float], rounded: bool = False) -> tuple[np.ndarray, np.ndarray]:
    points = tuple(Float64(np.ascontiguousarray(x[:, axis])) for axis in range(x.shape[1]))
    numbers = StoneShape(*(dr.opaque(Float64, value) for value in shape))
    height, owner = highest_stone(points, dr.opaque(mi.UInt32, SALT), numbers, rounded)
    return height.numpy(), owner.numpy()


@pytest.mark.parametrize("rounded", [False, True])
@pytest.mark.parametrize("shape", SHAPES, ids=str)
@pytest.mark.parametrize("dims", [2, 3])
def test_against_a_second_implementation(dims: int, shape: tuple[float, float, float], rounded: bool) -> None:
    x = np.random.default_rng(dims).uniform(-40, 40, (4000, dims))
    height, owner = grains_of(x, shape, rounded)
    expected, expected_owner = reference(x, SALT, *shape, rounded)
    assert height == pytest.approx(expected, abs=1e-9)
    on_top = expected > 0
    assert on_top.any()
    assert (owner == expected_owner)[on_top].all()


@pytest.mark.parametrize("dims", [2, 3])
def test_round_stones_of_one_size_are_cones_about_the_closest_point(dims: int) -> None:
    x = np.random.default_rng(3).uniform(-20, 20, (2000, dims))
    closest = nearest_points(tuple(Float64(np.ascontiguousarray(c)) for c in x.T), mi.UInt32(SALT), 1)[0][0].numpy()
    expected = np.maximum(0.0, 1.0 - closest / STONE_RADIUS[dims])
    assert grains_of(x, (0.0, 1.0, 0.0))[0] == pytest.approx(expected, abs=1e-6)  # the square root has a floor of 1e-6
    assert grains_of(x, (0.0, 1.0, 0.0), True)[0] == pytest.approx(1.0 - (1.0 - expected) ** 2, abs=1e-6)


@pytest.mark.parametrize("dims", [2, 3])
def test_no_stone_reaches_beyond_its_support(dims: int) -> None:
    """g >= |x - P|, so no body is higher than the round one that the support is made for."""
    x = np.random.default_rng(4).uniform(-20, 20, (20_000, dims))
    round_ones = grains_of(x, (0.0, 1.0, 0.0))[0]
    for shape in SHAPES[1:]:
        height = grains_of(x, shape)[0]
        assert height.min() >= 0
        assert (height <= round_ones + 1e-12).all()
        assert (height < round_ones - 0.01).any()


@pytest.mark.parametrize("dims", [2, 3])
def test_stones_join_without_a_jump(dims: int) -> None:
    facets, elongation, spread = shape = (1.0, 2.0, 0.5)
    step, radius = 1e-4, STONE_RADIUS[dims]
    direction = np.array([0.6, 0.8, 0.0][:dims] if dims == 2 else [0.6, 0.48, 0.64])
    line = np.array([0.3, -7.0, 2.0])[:dims] + np.arange(100_000)[:, None] * step * direction
    height, owner = grains_of(line, shape)
    # The steepest face is that of the smallest and thinnest body: C |w|_inf, or C |w|_1 / A, along its short axis.
    steepest = np.hypot(1, 0.5) * max(1.0, np.sqrt(dims) / 1.5) * elongation / (radius * (1 - spread))
    assert len(np.unique(owner)) > 10
    assert np.abs(np.diff(height)).max() < steepest * step
    assert facets == 1.0


@pytest.mark.parametrize(("dims", "share"), [(2, 0.03), (3, 0.02)])
def test_hardly_any_ground_shows_between_stones_as_they_are_searched(dims: int, share: float) -> None:
    x = np.random.default_rng(5).uniform(-100, 100, (100_000, dims))
    assert (grains_of(x, (1.0, 2.2, 0.55))[0] <= 0).mean() < share


def test_flat_faces_are_flat_and_round_ones_are_not() -> None:
    """Second differences along short lines: mostly zero on facets, never on a cone or a dome."""
    start = np.random.default_rng(6).uniform(-20, 20, (5000, 3))
    h = 1e-3
    for facets, least, most in ((1.0, 0.95, 1.0), (0.0, 0.0, 0.05)):
        low, middle, high = (grains_of(start + offset * np.array([h, 0, 0]), (facets, 1.5, 0.3))[0] for offset in (-1, 0, 1))
        flat = np.abs(low - 2 * middle + high) < 1e-9
        assert least <= flat[middle > 0.02].mean() <= most


def test_the_number_of_a_stone_is_uniform_and_its_own() -> None:
    x = np.random.default_rng(7).uniform(-300, 300, (20_000, 3))
    height, owner = grains_of(x, (0.8, 1.5, 0.4))
    words = np.unique(owner[height > 0])
    numbers = number_of(mi.UInt32(words), mi.Float).numpy()
    assert len(np.unique(numbers)) > 0.99 * len(words)
    assert kstest(numbers, "uniform").pvalue > 0.01


def relief_of(x: np.ndarray, float_type: Any, octaves: int = 1) -> np.ndarray:
    points = tuple(float_type(np.ascontiguousarray(x[:, axis])) for axis in range(3))
    numbers = {"scale": 3.1, "anisotropy": 1.4, "angle": 0.6, "lacunarity": 2.5, "stripe_frequency": 0.0, "stripe_spread": 0.0}
    values = {name: dr.opaque(float_type, value) for name, value in numbers.items()}
    settings = NoiseSettings.from_ranks(3, 1, 50, octaves, highest=True)
    shape = StoneShape(*(dr.opaque(float_type, value) for value in (0.8, 1.8, 0.4)))
    curve = float_type(np.linspace(0, 1, 11))
    gain = dr.opaque(float_type, 0.3)
    return relief_function(points, settings, dr.opaque(mi.UInt32, 5), curve=curve, shape=shape, gain=gain, **values)[0].numpy()


@pytest.mark.parametrize("octaves", [1, 2])
def test_relief_of_stones_is_standardised_and_the_same_in_any_order(octaves: int) -> None:
    x = np.random.default_rng(8).uniform(-30, 30, (50_000, 3)).astype(np.float32)
    relief = relief_of(x, mi.Float, octaves)
    t = 2.0 * relief.astype(np.float64) - 1.0
    score = 1.5 * t / np.sqrt(1 - t**2)  # ETA, and back through t = z / sqrt(1 + z^2)
    assert abs(score.mean()) < 0.05
    assert score.std() == pytest.approx(1.0, abs=0.05)
    order = np.random.default_rng(9).permutation(len(x))
    assert np.array_equal(relief_of(x[order], mi.Float, octaves), relief[order])


def test_the_second_octave_of_stones_is_their_roughness() -> None:
    """Plain noise a gain over the lacunarity as strong: 0.3 / 2.5 of a deviation."""
    x = np.random.default_rng(8).uniform(-30, 30, (50_000, 3)).astype(np.float32)

    def score(octaves: int) -> np.ndarray:
        t = 2.0 * relief_of(x, mi.Float, octaves).astype(np.float64) - 1.0
        return t / np.sqrt(1 - t**2)

    weight = 0.3 / 2.5
    added = score(2) * np.sqrt(1 + weight**2) - score(1)
    assert added.std() / score(1).std() == pytest.approx(weight, rel=0.05)
    assert abs(np.corrcoef(added, score(1))[0, 1]) < 0.02


def test_stones_need_all_points() -> None:
    with pytest.raises(ValueError, match=r"\(1, 50\)"):
        NoiseSettings.from_ranks(3, 1, 2, highest=True)
