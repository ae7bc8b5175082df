"""Where a curve of distances over amplitudes stays near its lowest."""

import math

import numpy as np
import pytest

from voldetail.fit import interval
from voldetail.fit.interval import TOLERANCE, _ends, _lamps
from voldetail.setup.lamp import Lamp

AMPLITUDES = np.array([0.01, 0.02, 0.04, 0.08, 0.16])


def test_ends_lie_where_straight_lines_in_the_logarithm_cross_the_tolerance() -> None:
    # From 1 at 0.04 to 1 + 2 (TOLERANCE - 1) at 0.02 and 0.08: half the way, that is a factor sqrt(2) each way.
    step = 2 * (TOLERANCE - 1)
    low, high = _ends(AMPLITUDES, np.array([3.0, 1 + step, 1.0, 1 + step, 3.0]))
    assert low == pytest.approx(0.04 / math.sqrt(2))
    assert high == pytest.approx(0.04 * math.sqrt(2))


def test_an_end_that_is_not_met_is_the_last_that_was_looked_at() -> None:
    low, high = _ends(AMPLITUDES, np.array([1.0, 1.0, 1.0, 1.0, 1.0]))
    assert (low, high) == (pytest.approx(0.01), pytest.approx(0.16))
    low, high = _ends(AMPLITUDES, np.array([1.0, 5.0, 6.0, 7.0, 1.001]))
    assert low == pytest.approx(0.01)
    assert high < 0.02  # the far valley is no part of the one about the lowest


@pytest.mark.parametrize("scale", [1e-3, 1.0, 40.0])
def test_the_unit_of_the_distance_does_not_matter(scale: float) -> None:
    distances = np.array([3.0, 1.05, 1.0, 1.3, 2.0])
    assert _ends(AMPLITUDES, distances * scale) == pytest.approx(_ends(AMPLITUDES, distances))


def test_a_light_that_is_nowhere_near_adds_nothing() -> None:
    low, high = _ends(AMPLITUDES, np.array([9.0, 5.0, 4.0, 5.0, 9.0]), best=1.0)
    assert low > high


def test_lights_are_lower_and_higher_by_the_stated_degrees_and_keep_their_azimuth() -> None:
    given = Lamp(direction=(0.48, 0.36, 0.8), strength=1.7)
    lamps = list(_lamps(given))
    assert given in lamps
    elevations = [math.degrees(lamp.elevation) for lamp in lamps]
    assert np.diff(elevations) == pytest.approx(np.diff(interval.ELEVATIONS))
    for lamp in lamps:
        assert lamp.direction is not None
        assert np.linalg.norm(lamp.direction) == pytest.approx(1.0)
        assert lamp.direction[1] / lamp.direction[0] == pytest.approx(0.75)
        assert lamp.strength == 1.7


def test_a_light_never_passes_the_zenith_or_the_horizon() -> None:
    for z in (1.0, 0.05):
        level = math.sqrt(1 - z * z)
        assert all(lamp.direction and lamp.direction[2] > 0 for lamp in _lamps(Lamp(direction=(level, 0.0, z))))


def test_a_near_light_is_left_where_it_is() -> None:
    flash = Lamp(position=(0.0, 0.0, 2.0), at_camera=True)
    assert list(_lamps(flash)) == [flash]
