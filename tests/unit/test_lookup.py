"""Values between cells against SciPy's, gradients of a linear density, and empty blocks."""

import numpy as np
import pytest
from scipy.ndimage import map_coordinates, maximum_filter

from tests.unit.densities import cloud, points, sampled
from voldetail.backend import mitsuba
from voldetail.geometry.lookup import BLOCK, Emptiness, Lookup, with_gradient

RNG = np.random.default_rng(3)
LOWER, EDGE, SHAPE = (-0.3, 0.2, -0.9), 0.11, (5, 9, 13)


def test_values_are_trilinear_and_go_on_to_the_faces() -> None:
    values = RNG.random(SHAPE).astype(np.float32)
    lookup = Lookup(mitsuba().Float(values.ravel()), 1, SHAPE, LOWER, EDGE)
    # Cells are points of SciPy's grid; "nearest" is what clamps.
    place = RNG.uniform(0, 1, (500, 3)) * SHAPE[::-1]
    found = np.asarray(lookup.at(points(np.array(LOWER) + place * EDGE)))
    wanted = map_coordinates(values, place[:, ::-1].T - 0.5, order=1, mode="nearest")
    assert np.allclose(found, wanted, atol=1e-5)


def test_the_gradient_of_a_linear_density_is_exact_inside() -> None:
    grid = sampled(lambda x, y, z: 0.4 + 0.1 * x - 0.2 * y + 0.05 * z, SHAPE, LOWER, EDGE)
    middle = np.array(LOWER) + 0.5 * EDGE * np.array(SHAPE[::-1])
    found = with_gradient(grid).at(points(middle[None]))
    assert np.ravel(found) == pytest.approx([0.1, -0.2, 0.05, 0.4 + middle @ [0.1, -0.2, 0.05]], abs=1e-5)


def test_a_cut_face_has_a_gradient_inwards() -> None:
    found = with_gradient(sampled(lambda x, y, z: 0 * x + 1)).at(points(np.array([[0.99, 0.0, 0.0]])))
    assert found.x[0] < -1
    assert abs(found.y[0]) < 1e-6


def test_blocks_are_empty_only_where_all_their_values_and_neighbours_are() -> None:
    shape = (20, 17, 33)
    values = np.zeros(shape, dtype=np.float32)
    values[tuple(RNG.integers(0, n, 6) for n in shape)] = 0.3
    grid = sampled(lambda x, y, z: values, shape)
    wide = maximum_filter(values, size=3)  # trilinear values draw on the next cell
    padded = np.pad(wide, [(0, -n % BLOCK) for n in shape])
    blocks = [n // BLOCK for n in padded.shape]
    wanted = padded.reshape(blocks[0], BLOCK, blocks[1], BLOCK, blocks[2], BLOCK).max((1, 3, 5))
    assert np.array_equal(np.asarray(Emptiness(grid).most).reshape(blocks), wanted)
    assert (wanted == 0).any()


def test_the_way_out_of_a_block() -> None:
    grid = cloud(32)
    side = BLOCK * grid.edge
    start = points(np.array([[-1.0 + 0.3 * side, -1.0 + 1.25 * side, -1.0 + 2.5 * side]]))
    mi = mitsuba()
    for direction, wanted in [((1, 0, 0), 0.7), ((-1, 0, 0), 0.3), ((0, -1, 0), 0.25), ((0, 0.6, 0.8), 0.5 / 0.8)]:
        _, ahead = Emptiness(grid).ahead(start, mi.Vector3f(*direction))
        assert ahead[0] == pytest.approx(wanted * side, rel=1e-4)
