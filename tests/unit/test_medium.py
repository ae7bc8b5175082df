"""What cannot be marched is said in one sentence: extinctions, phase functions and grids."""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from tests.unit.densities import cloud, sampled
from voldetail.backend import mitsuba
from voldetail.errors import InputError
from voldetail.field.medium import Medium, check, reflected, tinted_albedo
from voldetail.geometry.density_grid import DensityGrid
from voldetail.render.marched import MarchedVolume
from voldetail.render.traced_medium import TracedVolume
from voldetail.setup.lamp import Lamp
from voldetail.setup.view import View

VIEW = View(-1.0, 1.0, -1.0, 1.0, 8, 8)
LAMP = Lamp(direction=(0.0, 0.6, 0.8))


def sentence(error: pytest.ExceptionInfo[InputError]) -> str:
    text = str(error.value)
    assert "\n" not in text
    assert text.endswith(".")
    assert text.count(". ") == 0
    assert ": " in text  # what to do
    return text


@pytest.mark.parametrize("extinction", [0.0, -1.0, math.nan, math.inf, -math.inf])
def test_an_extinction_has_to_be_finite_and_above_0(extinction: float) -> None:
    with pytest.raises(InputError) as error:
        Medium(extinction)
    assert f"{extinction:g}" in sentence(error)


@pytest.mark.parametrize("asymmetry", [-1.0, 0.96, math.nan, math.inf])
def test_an_asymmetry_has_to_be_within_its_bounds(asymmetry: float) -> None:
    with pytest.raises(InputError) as error:
        Medium(1.0, asymmetry)
    assert f"{asymmetry:g}" in sentence(error)


def with_density(value: float) -> DensityGrid:
    values = np.full((4, 4, 4), 0.5, dtype=np.float32)
    values[1, 2, 3] = value
    return DensityGrid(mitsuba().Float(values.ravel()), (4, 4, 4), (-1.0, -1.0, -1.0), 0.5)


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf, -0.01, 1.01])
@pytest.mark.parametrize("way", ["marched", "traced"])
def test_a_density_outside_0_to_1_is_refused_by_both_ways(value: float, way: str) -> None:
    ways = {"marched": MarchedVolume(VIEW).fill, "traced": lambda *given: TracedVolume(*given, VIEW, LAMP)}
    with pytest.raises(InputError) as error:
        ways[way](with_density(value), Medium(1.0))
    assert "1 of its 64" in sentence(error)


@pytest.mark.parametrize(
    ("changes", "named"),
    [
        ({"shape": (4, 4, 5)}, "64"),
        ({"shape": (4, 4, 0)}, "0"),
        ({"shape": (8, 8)}, "(8, 8)"),
        ({"edge": 0.0}, "0"),
        ({"edge": math.nan}, "nan"),
        ({"lower": (0.0, math.inf, 0.0)}, "inf"),
    ],
)
def test_a_grid_that_does_not_fit_its_record_is_refused(changes: dict[str, Any], named: str) -> None:
    with pytest.raises(InputError) as error:
        check(replace(with_density(0.5), **changes))
    assert named in sentence(error)


@pytest.mark.parametrize("value", [0.0, 1.0])
def test_the_bounds_of_density_are_allowed(value: float) -> None:
    check(with_density(value))


def test_a_box_may_not_reach_the_camera() -> None:
    with pytest.raises(InputError, match="camera"):
        MarchedVolume(View(-1.0, 1.0, -1.0, 1.0, 8, 8, distance=0.9)).fill(cloud(8), Medium(1.0))


def test_a_lamp_may_not_be_in_the_box() -> None:
    volume = MarchedVolume(VIEW)
    volume.fill(cloud(8), Medium(1.0))
    with pytest.raises(InputError) as error:
        volume.light_depth(Lamp(position=(0.2, 0.3, 0.4)))
    assert "0.3" in sentence(error)


@pytest.mark.parametrize("albedo", [-0.1, 1.1, math.nan, (0.5, 0.5, 2.0)])
def test_an_albedo_is_a_share(albedo: Any) -> None:
    with pytest.raises(InputError) as error:
        TracedVolume(cloud(8), Medium(1.0), VIEW, LAMP, albedo=albedo)
    assert "albedo" in sentence(error)


def test_a_grid_of_one_cell_and_one_of_nothing_can_be_marched() -> None:
    volume = MarchedVolume(VIEW)
    volume.fill(sampled(lambda x, y, z: 0 * x + 1, (1, 1, 1), (-0.5, -0.5, -0.5), 1.0), Medium(2.0))
    covered = np.asarray(volume.march(LAMP, 1, ())[0]).reshape(8, 8)
    assert covered[4, 4] == pytest.approx(1 - math.exp(-2.0), rel=1e-5)
    assert covered[0, 0] == 0
    volume.fill(sampled(lambda x, y, z: 0 * x), Medium(2.0))
    found = volume.march(LAMP, 1, (16.0,))
    assert all(np.array_equal(np.asarray(f), np.zeros(64)) for f in found)


@pytest.mark.parametrize("g", [0.0, 0.6])
def test_a_thick_medium_takes_the_tint_and_not_its_power(g: float) -> None:
    found = tinted_albedo(0.99, g, (0.95, 0.99, 1.2))
    assert found[2] == pytest.approx(0.99, abs=1e-9)
    assert [reflected(v, g) / reflected(0.99, g) for v in found] == pytest.approx([0.95 / 1.2, 0.99 / 1.2, 1.0], rel=1e-9)
    # Most of it is made by albedos that hardly differ.
    assert found[0] > 0.95
    assert reflected(1.0, g) == 1.0
    assert reflected(0.0, g) == 0.0


def test_the_reflected_share_is_chandrasekhars() -> None:
    """Even scattering has an exact solution (Chandrasekhar 1950), R = 1 - 2 sqrt(1 - omega) times the integral of mu H(mu).

    1 / H(mu) = sqrt(1 - omega) + omega / 2 times the integral of mu' H(mu') / (mu + mu'), here on 64 Gauss points.
    """
    x, w = np.polynomial.legendre.leggauss(64)
    mu, w = 0.5 * (x + 1.0), 0.5 * w
    for omega in (0.5, 0.9, 0.99):
        h = np.ones_like(mu)
        for _ in range(500):
            inner = (mu * h * w / (mu[:, None] + mu)).sum(axis=1)
            h = 0.5 * (h + 1.0 / (np.sqrt(1.0 - omega) + 0.5 * omega * inner))
        exact = 1.0 - 2.0 * np.sqrt(1.0 - omega) * float((h * mu * w).sum())
        assert reflected(omega, 0.0) == pytest.approx(exact, abs=0.01)
