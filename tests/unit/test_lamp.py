"""The light at each point, and where a flash stands."""

import math

import numpy as np
import pytest
from numpy.typing import NDArray

from voldetail.backend import mitsuba
from voldetail.errors import InputError
from voldetail.setup.lamp import Lamp
from voldetail.setup.light import Light, lamp_of, parse_light
from voldetail.setup.lights.flash import flash_foot


def spot(rows: int, columns: int, row: float, column: float, width: float = 0.2) -> NDArray[np.float32]:
    y, x = np.mgrid[:rows, :columns]
    away = np.hypot(y - row, x - column) / (width * max(rows, columns))
    return (0.05 + 0.6 * np.exp(-(away**2))).astype(np.float32)


@pytest.mark.parametrize(("row", "column"), [(100, 200), (60, 90), (140, 330), (199, 0)])
def test_the_foot_of_a_flash_is_its_bright_spot(row: int, column: int) -> None:
    u, v = flash_foot(spot(200, 400, row, column))
    # Within 2% of the photo's longest side, though sampled at a half and blurred by 6%.
    assert abs(u * 400 - column) < 8
    assert abs(v * 200 - row) < 8


def test_a_glint_does_not_win_over_the_broad_spot() -> None:
    photo = spot(256, 256, 180, 70)
    photo[40:43, 200:203] = 1.0
    u, v = flash_foot(photo)
    assert np.hypot(u * 256 - 70, v * 256 - 180) < 8


def test_a_flash_stands_over_its_foot_in_scene_units() -> None:
    photo = spot(200, 400, 50, 300)
    lamp = lamp_of(parse_light("flash@0.8"), photo)
    assert lamp.position is not None
    assert lamp.at_camera
    x, y, z = lamp.position
    assert x == pytest.approx((300 / 400 - 0.5) * 2, abs=0.03)
    assert y == pytest.approx((0.5 - 50 / 200) * 1, abs=0.03)
    assert z == pytest.approx(1.6)  # the photo's longest side is 2
    given = lamp_of(parse_light("flash@0.25,0.5,1"), photo)
    assert given.position == pytest.approx((-0.5, 0.0, 2.0))  # the user's foot wins
    assert lamp_of(Light(kind="flash")).position == pytest.approx((0.0, 0.0, 2.0))


def test_directions_and_points_are_taken_as_they_are() -> None:
    assert lamp_of(parse_light("90,30")).direction == pytest.approx((0, math.cos(math.pi / 6), 0.5))
    assert lamp_of(parse_light("point:1,2,3")).position == (1, 2, 3)
    assert not lamp_of(parse_light("point:1,2,3")).at_camera
    assert lamp_of(Light(direction=(0, 0, 1), strength=2.5)).strength == 2.5
    assert lamp_of(parse_light("0,30")).elevation == pytest.approx(math.pi / 6)


def test_the_fall_off_on_a_plane_in_closed_form() -> None:
    lamp = Lamp(position=(0.3, -0.2, 1.5), strength=0.7)
    x, y = (v.ravel().astype(np.float32) for v in np.meshgrid(np.linspace(-1, 1, 9), np.linspace(-1, 1, 7)))
    squared = (x - 0.3) ** 2 + (y + 0.2) ** 2 + 1.5**2
    cosine = 1.5 / np.sqrt(squared)
    expected = 0.7 * 1.5**2 / squared * cosine
    assert lamp.on_plane(x, y) == pytest.approx(expected, rel=1e-5)
    assert lamp.on_plane(np.float32([0.3]), np.float32([-0.2])) == pytest.approx([0.7])  # strength at the foot
    assert Lamp(direction=(0.6, 0.0, 0.8), strength=2.0).on_plane(x, y) == pytest.approx(1.6)


@pytest.mark.parametrize(
    "lamp",
    [
        Lamp(position=(0.3, -0.2, 1.5), strength=0.7),
        Lamp(direction=(0.6, 0.0, 0.8)),
        Lamp(position=(0.3, -0.2, 1.5), strength=0.7, axis=(0.0, 0.6, -0.8), cone=0.7),
    ],
)
def test_on_a_plane_and_at_points_are_the_same_light(lamp: Lamp) -> None:
    mi = mitsuba()
    x, y = np.random.default_rng(3).uniform(-1, 1, (2, 50)).astype(np.float32)
    direction, distance, irradiance = lamp.at(mi.Point3f(x, y, np.zeros(50, np.float32)))
    seen = np.broadcast_to(np.array(direction.z) * np.array(irradiance), 50)  # a distant light is one number
    assert seen == pytest.approx(lamp.on_plane(x, y), rel=1e-5, abs=1e-6)
    assert np.linalg.norm(np.array(direction), axis=0) == pytest.approx(1.0, rel=1e-5)
    if lamp.position is not None:
        expected = np.linalg.norm(np.array([x - 0.3, y + 0.2, np.full(50, 1.5)]), axis=0)
        assert np.array(distance) == pytest.approx(expected, rel=1e-5)


def test_a_spot_light_is_bright_in_its_beam_and_dark_beyond_its_cone() -> None:
    lamp = lamp_of(parse_light("spot:0,0,2@0,0,0,40"))
    angles = np.radians([0.0, 29.9, 35.0, 40.1, 60.0])
    x = (2.0 * np.tan(angles)).astype(np.float32)
    # Half of the way from 30 degrees (3/4 of 40) to 40 half of the strength is left; a point light's fall-off is cos^3.
    share = lamp.on_plane(x, np.zeros_like(x)) / np.cos(angles) ** 3
    assert share == pytest.approx([1.0, 1.0, 0.5, 0.0, 0.0], abs=1e-5)
    assert lamp.emitter((1.0, 1.0, 1.0))["cutoff_angle"] == pytest.approx(40.0)
    turned = lamp_of(parse_light("spot:0,0,2@2,0,0,40"))  # its middle is 45 degrees to the right
    assert turned.on_plane(np.float32([2.0, -2.0]), np.float32([0.0, 0.0])) == pytest.approx([2.0**-1.5, 0.0], abs=1e-6)


def test_a_spot_light_needs_somewhere_to_shine() -> None:
    with pytest.raises(InputError, match="aimed at the place where it stands"):
        lamp_of(parse_light("spot:0,0,2@0,0,2,40"))


def test_auto_is_no_lamp() -> None:
    with pytest.raises(InputError, match="light auto is estimated from a photo, by fit alone"):
        lamp_of(parse_light("auto"))
