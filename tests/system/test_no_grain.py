"""What the metric sees has no Monte-Carlo grain: samples lie on a grid, so no seed, order or number of them is texture."""

import numpy as np
import pytest

from tests.system.scenes import detail
from voldetail.metric import describe, distance
from voldetail.render.heightfield import HeightField
from voldetail.render.unit_components import components
from voldetail.setup.lamp import Lamp
from voldetail.setup.view import View

SIDE = 96
LAMP = Lamp(direction=(0.48, 0.36, 0.8))


def shown(surface: HeightField, scale: float, subsamples: int) -> np.ndarray:
    surface.update(detail(noise__scale=scale, noise__octaves=2))
    return components(surface, LAMP, subsamples=subsamples).luminance(0.1, 0.5, 0.0, 0.0)


@pytest.fixture(scope="module")
def surface() -> HeightField:
    return HeightField(View(-1.0, 1.0, -1.0, 1.0, SIDE, SIDE))


@pytest.mark.parametrize("subsamples", [1, 2])
def test_a_picture_is_the_same_to_the_bit_whatever_was_rendered_before_it(surface: HeightField, subsamples: int) -> None:
    once = shown(surface, 4.0, subsamples)
    shown(surface, 7.0, 3)
    again = shown(surface, 4.0, subsamples)
    elsewhere = shown(HeightField(surface.view), 4.0, subsamples)
    assert np.array_equal(once, again)
    assert np.array_equal(once, elsewhere)


@pytest.mark.parametrize("metric", ["combined", "published"])
def test_more_samples_change_a_distance_less_than_other_pixels_do(surface: HeightField, metric: str) -> None:
    """From 1 to 4 samples a pixel's side; grain of a path tracer at 4 samples a pixel is an order more."""
    photo = shown(surface, 5.0, 4)
    reference = describe(photo, metric=metric)
    found = [distance(reference, describe(shown(surface, 4.0, n), like=reference)) for n in (1, 2, 3, 4)]
    assert max(found[1:]) - min(found[1:]) < 0.05 * found[-1], found
    rng = np.random.default_rng(1)
    grainy = shown(surface, 4.0, 4) * (1 + 0.1 * rng.standard_normal((SIDE, SIDE))).astype(np.float32)
    moved = distance(reference, describe(grainy, like=reference)) - found[-1]
    assert abs(moved) > 4 * (max(found[1:]) - min(found[1:])), (moved, found)
