"""Pixels and scene units."""

import math

import numpy as np
import pytest

from voldetail.setup.camera import CameraSetup
from voldetail.setup.view import view_of, whole_view

ORTHOGRAPHIC = CameraSetup()


def test_the_longest_side_of_the_photo_is_two_units_wide() -> None:
    view = view_of(ORTHOGRAPHIC, (300, 400), None, 200)
    assert (view.left, view.right) == (-1.0, 1.0)
    assert (view.bottom, view.top) == (-0.75, 0.75)
    assert (view.columns, view.rows) == (200, 150)
    assert view.pixel == pytest.approx(0.01)


def test_a_zone_is_a_window_of_the_photo() -> None:
    view = view_of(ORTHOGRAPHIC, (300, 400), (100, 50, 80, 40), 160)
    assert (view.left, view.right) == pytest.approx((-0.5, -0.1))
    assert (view.top, view.bottom) == pytest.approx((0.5, 0.3))  # row 0 is on top, y points up
    assert (view.columns, view.rows) == (160, 80)


def test_samples_lie_regularly_inside_the_pixels_row_by_row() -> None:
    view = view_of(ORTHOGRAPHIC, (2, 4), None, 4)
    x, y = view.coordinates(1)
    assert x == pytest.approx([-0.75, -0.25, 0.25, 0.75] * 2)
    assert y == pytest.approx([0.25] * 4 + [-0.25] * 4)
    finer_x, finer_y = (v.reshape(4, 8) for v in view.coordinates(2))
    # The mean of a pixel's samples is its middle.
    assert finer_x.reshape(2, 2, 4, 2).mean((1, 3)).ravel() == pytest.approx(x)
    assert finer_y.reshape(2, 2, 4, 2).mean((1, 3)).ravel() == pytest.approx(y)


def test_the_pixel_of_the_zone_shows_the_same_place_as_in_the_photo() -> None:
    whole = view_of(ORTHOGRAPHIC, (128, 128), None, 128)
    part = view_of(ORTHOGRAPHIC, (128, 128), (32, 64, 64, 64), 64)
    x, y = (v.reshape(128, 128)[64:, 32:96] for v in whole.coordinates(1))
    a, b = (v.reshape(64, 64) for v in part.coordinates(1))
    assert a == pytest.approx(x, abs=1e-6)
    assert b == pytest.approx(y, abs=1e-6)


def test_a_perspective_camera_at_its_own_distance_sees_the_same_window() -> None:
    camera = CameraSetup(kind="perspective", field_of_view=60.0)
    view = view_of(camera, (100, 100), None, 100)
    assert view.perspective
    assert view.distance == pytest.approx(1 / math.tan(math.radians(30)))
    assert (view.left, view.right, view.bottom, view.top) == pytest.approx((-1, 1, -1, 1))


def test_a_perspective_camera_moved_back_sees_more() -> None:
    view = view_of(CameraSetup(kind="perspective", field_of_view=90.0, distance=3.0), (100, 100), None, 100)
    assert (view.left, view.right) == pytest.approx((-3.0, 3.0))


@pytest.mark.parametrize(("columns", "rows"), [(200, 100), (100, 200), (64, 64)])
def test_a_whole_view_shows_a_proxy_with_a_margin_in_square_pixels(columns: int, rows: int) -> None:
    view = whole_view(columns, rows)
    assert min(view.right, view.top) == pytest.approx(1.15)
    assert (view.right - view.left) / columns == pytest.approx((view.top - view.bottom) / rows)
    assert (view.left, view.bottom) == (-view.right, -view.top)
    assert np.hypot(*whole_view(columns, rows, CameraSetup(kind="perspective")).coordinates(1)).min() < 0.05
