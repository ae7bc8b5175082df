"""The sky inside a density: moments of its directions, bare places, a slab, and a bare plane."""

import numpy as np
import pytest
from scipy.special import expn

from tests.unit.densities import cloud, points, sampled, slab
from voldetail.backend import mitsuba
from voldetail.render.sky_light import SkyLight, coarsened, icosahedron

UP = (0.0, 0.0, 1.0)


def share(sky: SkyLight, place: tuple[float, float, float], normal: tuple[float, float, float]) -> float:
    return float(sky.on_surface(points(np.array([place])), mitsuba().Vector3f(*normal))[0])


def test_the_directions_integrate_polynomials_to_degree_5() -> None:
    """Means over the sphere: of x^2 1/3, x^4 1/5, x^2 y^2 1/15, odd ones 0."""
    w = np.array(icosahedron())
    assert np.allclose(np.linalg.norm(w, axis=1), 1)
    assert np.allclose(w.mean(axis=0), 0, atol=1e-9)
    assert np.allclose(w.T @ w / 12, np.eye(3) / 3)
    assert np.allclose((w**4).mean(axis=0), 1 / 5)
    assert np.mean(w[:, 0] ** 2 * w[:, 1] ** 2) == pytest.approx(1 / 15)
    assert np.abs(w).min() > 0.15  # none lies in a face of the box


@pytest.mark.parametrize("normal", [UP, (0.6, 0.0, -0.8)])
def test_a_place_with_nothing_about_it_sees_all_of_the_sky(normal: tuple[float, float, float]) -> None:
    sky = SkyLight(sampled(lambda x, y, z: 0 * x), 5.0, one_sided=False)
    assert share(sky, (0.1, 0.2, 0.3), normal) == pytest.approx(1, abs=1e-5)
    scattered = sky.scattered(points(np.array([[0.1, 0.2, 0.3]])), mitsuba().Vector3f(*normal), 0.6)
    assert scattered[0] == pytest.approx(1, abs=1e-5)


def test_a_one_sided_sky_is_whole_for_a_plane_that_faces_it_and_half_for_a_wall() -> None:
    sky = SkyLight(sampled(lambda x, y, z: 0 * x), 5.0, one_sided=True)
    assert share(sky, (0.0, 0.0, 0.0), UP) == pytest.approx(1, abs=0.02)
    assert share(sky, (0.0, 0.0, 0.0), (1.0, 0.0, 0.0)) == pytest.approx(0.5, abs=1e-3)


@pytest.mark.parametrize("cosine", [0.8, 0.5, 0.2])
def test_a_tilted_plane_sees_a_one_sided_sky_above_its_horizon_and_the_plane_s(cosine: float) -> None:
    """(1 + cos) / 2, the cosine-weighted share of a half sky; the first two orders give it exactly."""
    sky = SkyLight(sampled(lambda x, y, z: 0 * x), 5.0, one_sided=True)
    normal = (0.6 * (1 - cosine**2) ** 0.5, -0.8 * (1 - cosine**2) ** 0.5, cosine)
    assert share(sky, (0.0, 0.0, 0.0), normal) == pytest.approx((1 + cosine) / 2, abs=0.01)


@pytest.mark.parametrize("g", [0.4, 0.0, -0.4])
def test_a_forward_medium_sends_little_of_the_sky_behind_the_viewer_back_to_him(g: float) -> None:
    """Share of Henyey and Greenstein's function on cosines below 0, (1 - g^2) / 2g (1 / sqrt(1 + g^2) - 1 / (1 + g))."""
    wanted = (1 - g * g) / (2 * g) * ((1 + g * g) ** -0.5 - 1 / (1 + g)) if g else 0.5
    sky = SkyLight(sampled(lambda x, y, z: 0 * x), 5.0, one_sided=True)
    found = sky.scattered(points(np.zeros((1, 3))), mitsuba().Vector3f(*UP), g)[0]
    assert found == pytest.approx(wanted, abs=0.03)


def test_above_an_opaque_floor_a_plane_sees_the_sky_and_a_wall_half_of_it() -> None:
    floor = sampled(lambda x, y, z: np.where(z < 0, 1.0, 0.0), (32, 64, 64), (-2.0, -2.0, -1.0), 1 / 16)
    sky = SkyLight(floor, 200.0, one_sided=False)
    place = (0.0, 0.0, 1.5 / 8)  # as far out as a surface is lifted: one and a half coarse cells
    assert share(sky, place, UP) == pytest.approx(1, abs=0.06)
    assert share(sky, place, (0.6, 0.8, 0.0)) == pytest.approx(0.5, abs=0.1)
    assert share(sky, place, (0.0, 0.0, -1.0)) < 0.06
    assert share(sky, (0.0, 0.0, -0.5), UP) < 1e-3


def test_the_mean_of_the_sky_inside_a_slab_is_an_exponential_integral() -> None:
    """Mean of exp(-tau / |cos|) over the upper half is E2(tau): a = (E2(tau_above) + E2(tau_below)) / 2."""
    extinction = 2.0
    sky = SkyLight(slab(lambda h: 0 * h + 1, 8), extinction, one_sided=False)
    for height in (0.5, 0.75):
        found = float(sky.on_surface(points(np.array([[0.0, 0.0, 0.5 * height - 0.25]])), mitsuba().Vector3f(0.0))[0])
        wanted = (expn(2, extinction * 0.5 * height) + expn(2, extinction * 0.5 * (1 - height))) / 2
        # Six pairs of directions for the integral: measured 7 %.
        assert found == pytest.approx(wanted, rel=0.1)


def test_a_coarse_copy_holds_as_much() -> None:
    grid = cloud(20)
    coarse = coarsened(grid, 3)
    assert coarse.shape == (7, 7, 7)
    assert coarse.array().sum() * coarse.edge**3 == pytest.approx(grid.array().sum() * grid.edge**3, rel=1e-5)
    assert coarse.array()[2, 3, 4] == pytest.approx(grid.array()[6:9, 9:12, 12:15].mean(), rel=1e-5)
