"""The zone that is fitted when the user names none."""

import numpy as np
import pytest
from numpy.typing import NDArray

from voldetail.errors import InputError
from voldetail.fit.zone import FEATURE_PIXELS, default_zone, main_wavelength
from voldetail.image import to_linear


def stripes(rows: int, columns: int, wavelength: float, turn: float = 0.4) -> NDArray[np.float32]:
    """A picture of stripes, sinusoidal as they are encoded."""
    y, x = np.mgrid[:rows, :columns]
    phase = 2 * np.pi * (x * np.cos(turn) + y * np.sin(turn)) / wavelength
    return np.asarray(to_linear(0.5 + 0.2 * np.sin(phase)), dtype=np.float32)


def whole(picture: NDArray[np.float32]) -> NDArray[np.bool_]:
    return np.ones(picture.shape, dtype=bool)


@pytest.mark.parametrize("wavelength", [5.0, 8.0, 16.0, 30.0])
def test_the_wavelength_of_stripes(wavelength: float) -> None:
    assert main_wavelength(stripes(300, 400, wavelength)) == pytest.approx(wavelength, rel=0.05)


def test_slow_shading_is_not_the_texture() -> None:
    picture = stripes(300, 400, 16.0) * np.linspace(0.3, 1.5, 400, dtype=np.float32)
    assert main_wavelength(picture) == pytest.approx(16.0, rel=0.1)


def test_grain_of_the_sensor_is_not_the_texture() -> None:
    grain = np.random.default_rng(1).normal(0, 0.02, (300, 400)).astype(np.float32)
    assert main_wavelength(stripes(300, 400, 16.0) + grain) == pytest.approx(16.0, rel=0.1)


def test_a_large_photo_is_measured_in_its_own_pixels() -> None:
    assert main_wavelength(stripes(700, 2100, 40.0)) == pytest.approx(40.0, rel=0.05)


def test_a_flat_picture_has_no_wavelength_and_still_a_zone() -> None:
    flat = np.full((100, 120), 0.3, dtype=np.float32)
    assert main_wavelength(flat) == FEATURE_PIXELS
    assert default_zone(flat, whole(flat), 96)[2:] == (96, 96)


def test_a_zone_is_as_wide_as_makes_its_texture_fit_the_resolution() -> None:
    picture = stripes(600, 800, 30.0)
    x, y, w, h = default_zone(picture, whole(picture), 96)
    assert w == h == pytest.approx(96 * 30 / FEATURE_PIXELS, rel=0.06)
    assert abs(x + w / 2 - 400) <= 45
    assert abs(y + h / 2 - 300) <= 45  # in the middle, to the step of the search


def test_a_zone_is_no_larger_than_the_photo_and_not_enlarged_without_need() -> None:
    coarse, fine = stripes(200, 300, 60.0), stripes(200, 300, 4.0)
    assert default_zone(coarse, whole(coarse), 192)[2:] == (200, 200)
    assert default_zone(fine, whole(fine), 96)[2:] == (96, 96)


@pytest.mark.parametrize("value", [1.0, 0.0])
def test_a_zone_avoids_the_half_that_is_burnt_out_or_black(value: float) -> None:
    picture = stripes(800, 800, 12.0)
    picture[:, 400:] = value
    x, _, w, _ = default_zone(picture, whole(picture), 128)
    assert x + w <= 400
    # It would be in the middle else.
    x, _, w, _ = default_zone(stripes(800, 800, 12.0), whole(picture), 128)
    assert x + w > 400


def test_a_zone_stays_in_the_mask() -> None:
    picture = stripes(400, 400, 12.0)
    mask = np.zeros((400, 400), dtype=bool)
    mask[30:230, 150:390] = True
    x, y, w, h = default_zone(picture, mask, 128)
    assert mask[y : y + h, x : x + w].all()
    narrow = np.zeros((400, 400), dtype=bool)
    narrow[100:120, :] = True
    with pytest.raises(InputError, match=r"box is 400 x 20 pixels, too small to fit: at least 32"):
        default_zone(picture, narrow, 128)
