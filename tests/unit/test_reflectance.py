"""The solve for Ka, Kd, Ks: against SciPy, from known pictures, and never out of bounds."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from numpy.typing import NDArray
from scipy.optimize import lsq_linear

from voldetail.fit.reflectance import DARKEST_BACKGROUND, GLOSS_LIMIT, RANKS, bounded_least_squares, colours, solve
from voldetail.render.unit_components import SHININESS, Components

SIDE = 48
WHOLE = np.ones((SIDE, SIDE), dtype=bool)


def test_the_optimum_is_scipys_on_500_problems() -> None:
    rng = np.random.default_rng(11)
    on_a_bound = 0
    for _ in range(500):
        rows, columns = int(rng.integers(3, 40)), int(rng.integers(1, 4))
        matrix = rng.normal(size=(rows, columns)) * rng.uniform(0.1, 10)
        values = matrix @ rng.uniform(-0.6, 1.6, columns) + rng.normal(size=rows) * rng.uniform(0, 2)
        found = bounded_least_squares(matrix, values)
        wanted = lsq_linear(matrix, values, bounds=(0, 1), method="bvls").x
        assert found.min() >= 0
        assert found.max() <= 1
        cost = [float(np.sum((matrix @ x - values) ** 2)) for x in (found, wanted)]
        assert cost[0] <= cost[1] * (1 + 1e-6) + 1e-9
        on_a_bound += bool((found == 0).any() or (found == 1).any())
    assert on_a_bound > 200


def test_columns_of_nothing_do_no_harm() -> None:
    matrix = np.zeros((24, 3))
    matrix[:, 0] = np.linspace(1, 2, 24)
    assert bounded_least_squares(matrix, matrix[:, 0] * 0.4)[0] == pytest.approx(0.4, abs=1e-6)
    assert np.isfinite(bounded_least_squares(np.zeros((24, 3)), np.ones(24))).all()


@settings(max_examples=300, deadline=None, derandomize=True)
@given(arrays(np.float64, (24, 3), elements=st.floats(0, 1e4)), arrays(np.float64, 24, elements=st.floats(0, 1e4)))
def test_bounds_hold_for_any_problem(matrix: NDArray[np.float64], values: NDArray[np.float64]) -> None:
    found = bounded_least_squares(matrix, values)
    assert found.min() >= 0
    assert found.max() <= 1


def test_lower_bounds_are_scipys_too() -> None:
    rng = np.random.default_rng(12)
    for _ in range(100):
        matrix = rng.normal(size=(20, 3))
        values = matrix @ rng.uniform(-0.6, 1.6, 3) + rng.normal(size=20)
        lower, upper = rng.uniform(0.0, 0.3, 3), rng.uniform(0.5, 1.2, 3)
        found = bounded_least_squares(matrix, values, tuple(upper), tuple(lower))
        wanted = lsq_linear(matrix, values, bounds=(lower, upper), method="bvls").x
        assert found == pytest.approx(wanted, abs=1e-5)


def parts(seed: int = 1) -> Components:
    """Components of a bumpy plane under a light 50 degrees high, as smooth random slopes have them."""
    rng = np.random.default_rng(seed)
    slope = rng.normal(0, 0.35, (2, SIDE, SIDE))
    normal = np.stack([-slope[0], -slope[1], np.ones((SIDE, SIDE))]) / np.sqrt(1 + (slope**2).sum(0))
    light = np.array([np.cos(np.radians(50)), 0, np.sin(np.radians(50))])
    cosine = np.maximum(np.tensordot(light, normal, 1), 0)
    mirrored = np.maximum(2 * cosine * normal[2] - light[2], 0)
    lobes = np.stack([(n + 2) / 2 * mirrored**n * cosine for n in SHININESS])
    ambient = np.clip(0.9 + 0.1 * normal[2] + rng.normal(0, 0.03, (SIDE, SIDE)), 0, 1)
    covered = np.ones((SIDE, SIDE))
    return Components(*(np.asarray(v, dtype=np.float32) for v in (ambient, cosine, lobes)), SHININESS, covered)  # type: ignore[arg-type]


@pytest.mark.parametrize("shininess", SHININESS)
@pytest.mark.parametrize("wanted", [(0.2, 0.5, 0.055), (0.05, 0.8, 0.05), (0.4, 0.1, 0.05)])
def test_known_coefficients_come_back(wanted: tuple[float, float, float], shininess: float) -> None:
    seen = parts()
    photo = seen.luminance(*wanted, shininess)
    # Only its order statistics count: the pixels may lie anywhere.
    shuffled = np.random.default_rng(2).permutation(photo.ravel()).reshape(photo.shape)
    found = solve(shuffled, seen, WHOLE)
    assert found.shininess == shininess
    assert (found.ambient, found.diffuse) == pytest.approx(wanted[:2], abs=0.03)
    assert found.specular == pytest.approx(wanted[2], abs=0.01)
    assert found.residual < 1e-4


def test_a_matt_picture_has_no_highlight_and_none_is_forced() -> None:
    seen = parts()
    photo = seen.luminance(0.2, 0.6, 0.0, 4.0)
    found = solve(photo, seen, WHOLE)
    assert found.specular == pytest.approx(0.0, abs=2e-3)
    assert (found.ambient, found.diffuse) == pytest.approx((0.2, 0.6), abs=0.02)
    glossy = seen.luminance(0.2, 0.6, 0.3, 64.0)
    assert solve(glossy, seen, WHOLE, specular=False).specular == 0.0
    assert solve(glossy, seen, WHOLE).specular == GLOSS_LIMIT


def test_a_highlight_that_gains_little_is_not_taken() -> None:
    seen = parts()
    faint = solve(seen.luminance(0.2, 0.6, 0.0, 16.0) + np.float32(1e-4) * seen.specular[0], seen, WHOLE)
    plain = solve(seen.luminance(0.2, 0.6, 0.05, SHININESS[-1]), seen, WHOLE)
    assert faint.specular == pytest.approx(0.0, abs=2e-4)
    assert plain.specular == pytest.approx(0.05, abs=0.01)


@pytest.mark.parametrize("upper", [(1.0, 1.0, 0.15), (0.5, 0.2, 0.1)])
def test_other_bounds_are_kept_and_the_optimum_is_scipys(upper: tuple[float, float, float]) -> None:
    rng = np.random.default_rng(12)
    for _ in range(100):
        matrix, values = np.abs(rng.normal(size=(24, 3))), np.abs(rng.normal(size=24))
        found = bounded_least_squares(matrix, values, upper)
        wanted = lsq_linear(matrix, values, bounds=(0, upper), method="bvls").x
        assert found == pytest.approx(wanted, abs=1e-4)


def test_only_the_mask_counts() -> None:
    seen = parts()
    photo = seen.luminance(0.2, 0.5, 0.0, 4.0)
    photo[:, SIDE // 2 :] = 5.0
    mask = WHOLE.copy()
    mask[:, SIDE // 2 :] = False
    found = solve(photo, seen, mask)
    assert (found.ambient, found.diffuse) == pytest.approx((0.2, 0.5), abs=0.03)


def test_a_mask_of_fewer_pixels_than_groups_is_solved() -> None:
    seen = parts()
    mask = np.zeros((SIDE, SIDE), dtype=bool)
    mask[10, 10 : 10 + RANKS // 3] = True
    found = solve(seen.luminance(0.2, 0.5, 0.0, 4.0), seen, mask)
    assert np.isfinite([found.ambient, found.diffuse, found.specular, found.residual]).all()
    assert found.residual < 1e-3


@settings(max_examples=40, deadline=None, derandomize=True)
@given(st.integers(0, 2**32 - 1), st.floats(0, 4), st.floats(0, 3), st.booleans())
def test_no_coefficient_leaves_its_bounds_whatever_the_photo(seed: int, level: float, contrast: float, specular: bool) -> None:
    photo = np.abs(level + contrast * np.random.default_rng(seed).normal(size=(SIDE, SIDE))).astype(np.float32)
    found = solve(photo, parts(seed % 7), WHOLE, specular=specular)
    for value in (found.ambient, found.diffuse):
        assert 0 <= value <= 1
    assert 0 <= found.specular <= GLOSS_LIMIT
    assert found.shininess in SHININESS


def cloud(seed: int = 2) -> Components:
    """Components of a cloud: thick and thin parts with their own light."""
    rng = np.random.default_rng(seed)
    covered = np.clip(rng.uniform(-0.3, 1.3, (SIDE, SIDE)), 0, 1).astype(np.float32)
    diffuse = (covered * rng.uniform(0.2, 0.9, (SIDE, SIDE))).astype(np.float32)
    ambient = (covered * rng.uniform(0.7, 1.0, (SIDE, SIDE))).astype(np.float32)
    nothing = np.zeros((len(SHININESS), SIDE, SIDE), dtype=np.float32)
    return Components(ambient, diffuse, nothing, SHININESS, covered)


def test_a_background_that_shows_through_is_found_with_the_rest() -> None:
    seen = cloud()
    photo = 0.3 * seen.ambient + 0.6 * seen.diffuse + 0.2 * (1 - seen.covered)
    found = solve(photo, seen, WHOLE, background=True)
    assert (found.ambient, found.diffuse, found.background) == pytest.approx((0.3, 0.6, 0.2), abs=0.02)
    assert found.specular == 0.0
    # Without one, the sky would have to be cloud.
    assert solve(photo, seen, WHOLE).residual > 10 * found.residual


def test_a_background_is_not_much_darker_and_no_brighter_than_the_photo() -> None:
    seen = cloud()
    bright = np.clip(0.5 * seen.ambient + 0.5 * seen.diffuse, 0.25, None)
    assert solve(bright, seen, WHOLE, background=True).background >= DARKEST_BACKGROUND * 0.25 - 1e-6
    dim = np.full((SIDE, SIDE), 0.1, dtype=np.float32)
    assert solve(dim, seen, WHOLE, background=True).background <= 0.1 + 1e-6


def test_the_colours_of_a_cloud_and_of_the_sky_are_told_apart() -> None:
    seen = cloud()
    white, blue = np.array([1.02, 1.0, 0.9403]), np.array([0.5, 1.0, 2.4723])  # luminance 1
    matt, through = 0.3 * seen.ambient + 0.6 * seen.diffuse, 0.2 * (1 - seen.covered)
    pixels = (matt[..., None] * white + through[..., None] * blue).astype(np.float32)
    tint, behind = colours(pixels, matt, through, WHOLE)
    assert tint == pytest.approx(tuple(white), abs=0.03)
    assert behind == pytest.approx(tuple(blue), abs=0.15)
