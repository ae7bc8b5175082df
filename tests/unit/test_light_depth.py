"""The density between a place and a light, against closed forms: box, ramp, ball."""

import itertools
import math

import numpy as np
import pytest

from tests.unit.densities import points, sampled, sphere
from voldetail.render.optical_depth import LightDepth
from voldetail.setup.lamp import Lamp

SHAPE, LOWER, EDGE = (10, 24, 16), (-0.8, -1.2, -0.5), 0.1
UPPER = np.array(LOWER) + EDGE * np.array(SHAPE[::-1])
SIGNS = list(itertools.product((1, -1), repeat=3))
DIRECTIONS = [tuple((np.array(s) * d / np.linalg.norm(d)).tolist()) for s in SIGNS for d in ((5, 2, 1), (1, 4, 3), (2, 1, 3))]
POSITIONS = [(2.0, 0.3, 0.2), (-3.0, 1.5, -1.0), (0.1, 2.5, 0.0), (0.2, -1.9, 0.3), (0.0, 0.0, 2.0), (0.5, 0.4, -1.5)]
LAMPS = [Lamp(direction=d) for d in [(0.0, 0.0, 1.0), (-1.0, 0.0, 0.0), *DIRECTIONS]] + [Lamp(position=p) for p in POSITIONS]


def inside(count: int = 300, margin: float = 0.0) -> np.ndarray:
    return np.random.default_rng(5).uniform(np.array(LOWER) + margin, UPPER - margin, (count, 3))


def towards(lamp: Lamp, places: np.ndarray) -> np.ndarray:
    if lamp.direction is not None:
        return np.broadcast_to(lamp.direction, places.shape)
    offset = np.array(lamp.position) - places
    return offset / np.linalg.norm(offset, axis=1, keepdims=True)


def way_out(places: np.ndarray, direction: np.ndarray) -> np.ndarray:
    """Return the distance to the box's faces."""
    with np.errstate(divide="ignore", invalid="ignore"):
        reach = (np.where(direction > 0, UPPER, LOWER) - places) / direction
    return np.where(direction == 0, np.inf, reach).min(axis=1)


@pytest.mark.parametrize("lamp", LAMPS, ids=lambda lamp: str(lamp.direction or lamp.position))
def test_a_full_box_is_as_deep_as_the_way_out(lamp: Lamp) -> None:
    places = inside()
    found = np.asarray(LightDepth(sampled(lambda x, y, z: 0 * x + 1, SHAPE, LOWER, EDGE), lamp).at(points(places)))
    wanted = way_out(places, towards(lamp, places))
    # Where ways out through two faces meet, the depth has a kink, which a cell smooths; elsewhere it is linear. Measured
    # over these lamps: at most 2.7, 0.13 and 0.002 edges.
    apart = np.abs(found - wanted) / EDGE
    assert apart.max() < 3
    assert apart.mean() < 0.16
    assert np.median(apart) < 0.004


def test_a_lamp_close_to_the_box_is_still_near_the_truth() -> None:
    """A cell from the face its columns fan out, wider apart than cells: measured 0.14 edges in the mean."""
    lamp, places = Lamp(position=(0.2, -0.1, 0.6)), inside()
    found = np.asarray(LightDepth(sampled(lambda x, y, z: 0 * x + 1, SHAPE, LOWER, EDGE), lamp).at(points(places)))
    assert np.abs(found - way_out(places, towards(lamp, places))).mean() < 0.2 * EDGE


@pytest.mark.parametrize("direction", [(0.48, 0.36, 0.8), (-0.48, 0.36, -0.8), (0.8, 0.0, 0.6)])
def test_a_density_linear_in_height_gives_a_quadratic_depth(direction: tuple[float, float, float]) -> None:
    """Depth = integral from z to the top of (z' - z0) / L dz' / |l_z|, where the way leads out of the top or bottom."""
    grid = sampled(lambda x, y, z: (z - LOWER[2]) / 1.0, SHAPE, LOWER, EDGE)
    places = inside(margin=EDGE / 2)
    way = way_out(places, towards(Lamp(direction=direction), places))
    out = places + way[:, None] * np.array(direction)
    through = np.abs(out[:, 2] - (UPPER[2] if direction[2] > 0 else LOWER[2])) < 1e-9
    through &= ((out[:, :2] > np.array(LOWER[:2]) + 2 * EDGE) & (out[:, :2] < UPPER[:2] - 2 * EDGE)).all(axis=1)
    assert through.sum() > 20
    height = places[:, 2] - LOWER[2]
    end = out[:, 2] - LOWER[2]
    wanted = (end**2 - height**2) / 2 / direction[2]
    found = np.asarray(LightDepth(grid, Lamp(direction=direction)).at(points(places)))
    # The outermost half cell holds one value, an eighth of a cell squared too little, and the depth is linear between
    # nodes, another eighth at most; both are longer along a low light. Measured for all
    # but the twentieth nearest to the sides: 0.16, 0.16 and 0.5.
    assert np.quantile(np.abs(found - wanted)[through], 0.95) < 0.55 * EDGE**2


def test_the_error_in_a_ball_falls_with_the_square_of_the_edge() -> None:
    """Depth of a ball of density (1 - r^2 / R^2)^2 below the point at distance s along the light, from the axis b:
    integral of (1 - (b^2 + t^2) / R^2)^2 from s to sqrt(R^2 - b^2), polynomial in t."""
    radius, lamp = 0.8, Lamp(direction=(0.48, 0.36, 0.8))
    places = np.random.default_rng(6).uniform(-0.45, 0.45, (400, 3))
    s = places @ np.array(lamp.direction)
    b2 = (places**2).sum(axis=1) - s**2
    c = 1 - b2 / radius**2

    def primitive(t: np.ndarray) -> np.ndarray:
        return c**2 * t - 2 * c * t**3 / 3 / radius**2 + t**5 / 5 / radius**4

    wanted = primitive(np.sqrt(radius**2 - b2)) - primitive(s)
    errors = []
    for cells in (16, 32, 64):
        grid = sampled(lambda x, y, z: np.clip(1 - (x * x + y * y + z * z) / radius**2, 0, 1) ** 2, (cells,) * 3, edge=2 / cells)
        errors.append(float(np.abs(np.asarray(LightDepth(grid, lamp).at(points(places))) - wanted).mean()))
    # Measured 7.5e-3, 2.0e-3, 4.8e-4: the grid's own trilinear error and the sweep's, both of second order.
    assert errors[0] / errors[1] > 3
    assert errors[1] / errors[2] > 3
    assert errors[2] < 7e-4


def test_outside_of_the_ball_nothing_is_in_the_way_and_behind_it_all() -> None:
    depth = LightDepth(sphere(32, 0.5), Lamp(direction=(0.0, 0.6, 0.8)))
    before, beside, behind = (np.array([[0.0, y, z]]) for y, z in ((0.5, 0.65), (-0.7, 0.5), (-0.55, -0.7)))
    assert float(depth.at(points(before))[0]) == 0
    assert float(depth.at(points(beside))[0]) == 0
    assert float(depth.at(points(behind))[0]) == pytest.approx(2 * math.sqrt(0.25 - 0.02**2), rel=0.02)
