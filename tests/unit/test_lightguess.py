"""The guessed light: what it must not depend on, and how near it is where the light is known."""

from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter

from tests.benchmarks.recovery import photo_of, truth_of
from voldetail.errors import InputError
from voldetail.fit.autolight import resolve_light
from voldetail.fit.lightguess import FLOOR, guess_light
from voldetail.image import Photo, load_photo, luminance
from voldetail.setup.file import setup_from
from voldetail.setup.light import angles_of
from voldetail.setup.setup import Setup


def lumps(azimuth: float, elevation: float = 40.0, side: int = 160, seed: int = 1) -> NDArray[np.float32]:
    """Round lumps, the higher of two everywhere, under Lambert shading: h = max of blurred noises."""
    draw = np.random.default_rng(seed)
    noises = [gaussian_filter(draw.normal(size=(side, side)), 4.0, mode="wrap") for _ in range(2)]
    height = 4.0 * np.maximum(*(n / n.std() for n in noises))
    down, right = np.gradient(height)
    a, e = np.radians(azimuth), np.radians(elevation)
    facing = (-right * np.cos(a) + down * np.sin(a)) * np.cos(e) + np.sin(e)
    return np.float32(0.05 + 0.6 * np.maximum(facing, 0) / np.sqrt(1 + right**2 + down**2))


def off(one: float, other: float) -> float:
    return abs((one - other + 180) % 360 - 180)


def setup(**fields: object) -> Setup:
    return setup_from({"photo": {"path": "lumps.png"}, "light": "auto", **fields})


def photo(picture: NDArray[np.float32]) -> Photo:
    return Photo(np.repeat(picture[..., None], 3, axis=2), "0" * 64, ())


@pytest.mark.parametrize("azimuth", [10.0, 75.0, 140.0, 215.0, 300.0])
def test_the_axis_of_isotropic_relief_is_found(azimuth: float) -> None:
    guess = guess_light(lumps(azimuth))
    error = off(guess.azimuth, azimuth)
    assert min(error, 180 - error) < 15
    assert guess.confidence > 0.3
    assert 0 < guess.elevation <= 90


def test_a_turned_photo_turns_the_guess() -> None:
    picture = lumps(75.0)
    first = guess_light(picture)
    for turns in (1, 2, 3):
        guess = guess_light(np.rot90(picture, turns))
        assert off(guess.azimuth, first.azimuth + 90 * turns) < 1
        assert guess.confidence == pytest.approx(first.confidence, abs=0.02)
        assert guess.elevation == first.elevation


def test_a_mirrored_photo_mirrors_the_guess() -> None:
    picture = lumps(75.0)
    assert off(guess_light(picture[:, ::-1]).azimuth, 180 - guess_light(picture).azimuth) < 1


def test_exposure_does_not_matter() -> None:
    picture = lumps(75.0)
    first = guess_light(picture)
    for factor in (0.1, 0.5, 3.0):
        guess = guess_light(factor * picture)
        assert off(guess.azimuth, first.azimuth) < 1
        assert guess.confidence == pytest.approx(first.confidence, abs=0.02)


def test_what_the_mask_hides_does_not_matter() -> None:
    picture = lumps(75.0, side=200)
    mask = np.zeros(picture.shape, bool)
    mask[:, :140] = True
    other = np.where(mask, picture, lumps(165.0, side=200, seed=9))
    hidden = np.where(mask, picture, np.float32(np.nan))
    first = guess_light(picture, mask)
    assert off(first.azimuth, 75) < 20 or off(first.azimuth, 255) < 20
    assert guess_light(hidden, mask).azimuth == pytest.approx(guess_light(other, mask).azimuth, abs=1)
    assert guess_light(hidden, mask) == guess_light(hidden)


@pytest.mark.parametrize(
    "picture",
    [np.zeros((64, 64)), np.full((64, 64), 0.4), np.full((5, 5), 0.4), np.eye(6), np.full((64, 64), np.nan)],
)
def test_no_picture_no_confidence(picture: NDArray[np.float64]) -> None:
    guess = guess_light(picture)
    assert guess.confidence == 0
    assert guess.sign_confidence == 0.5
    assert not guess_light(np.ones((64, 64)), np.zeros((64, 64), bool)).confidence


def test_noise_without_direction_is_not_trusted() -> None:
    draw = np.random.default_rng(4)
    for blur in (1.0, 2.0, 3.0):
        noise = gaussian_filter(draw.normal(size=(256, 256)), blur)
        assert guess_light(0.4 + 0.05 * noise / noise.std()).confidence < 0.25


def test_a_texture_with_a_direction_lowers_the_confidence() -> None:
    draw = np.random.default_rng(4)
    ripples = gaussian_filter(draw.normal(size=(256, 256)), (2, 12))
    guess = guess_light(0.4 + 0.05 * ripples / ripples.std())
    assert guess.confidence < 0.3
    assert "the texture itself has a direction" in guess.sentence


def test_rendered_details_under_known_lights() -> None:
    axis, end = [], []
    for index in range(24):
        detail, light = truth_of(f"guess-{index}")
        azimuth = float(light.split(",")[0])
        error = off(guess_light(luminance(photo_of(detail, light))).azimuth, azimuth)
        axis.append(min(error, 180 - error))
        end.append(error < 90)
    assert np.median(axis) < 15
    assert np.mean(end) > 0.5  # 0.72 over 300; the rest are mostly reliefs of pits


def test_the_pebble_wall_under_four_lights(shared_data: Path) -> None:
    folder = shared_data / "multilight" / "nmo_pebble_wall_4light"
    for name, azimuth in (("right", 0), ("above", 90), ("left", 180), ("below", 270)):
        guess = guess_light(luminance(load_photo(folder / f"{name}.jpg").pixels))
        assert off(guess.azimuth, azimuth) < 25
        assert guess.confidence > 0.4


def test_auto_becomes_a_direction() -> None:
    picture = photo(lumps(75.0))
    made, guess = resolve_light(setup(), picture)
    assert guess is not None
    assert made.light.kind == "directional"
    assert made.light.direction is not None
    assert angles_of(made.light.direction) == pytest.approx((guess.azimuth, guess.elevation))
    assert resolve_light(setup(), picture) == (made, guess)
    assert resolve_light(made, picture) == (made, None)


def test_auto_looks_at_the_zone() -> None:
    both = np.concatenate([lumps(0.0), lumps(90.0, seed=2)], axis=1)
    _, guess = resolve_light(setup(photo={"path": "lumps.png", "zone": [160, 0, 160, 160]}), photo(both))
    assert guess is not None
    assert abs(off(guess.azimuth, 0) - 90) < 20


def test_auto_is_refused_where_nothing_is_known() -> None:
    with pytest.raises(InputError, match=rf"cannot be told.*at least {FLOOR:g}.*give --light as AZ,EL"):
        resolve_light(setup(), photo(np.full((64, 64), 0.4, np.float32)))
    with pytest.raises(InputError, match="reaches outside the photo"):
        resolve_light(setup(photo={"path": "lumps.png", "zone": [200, 0, 64, 64]}), photo(lumps(75.0)))
    with pytest.raises(InputError, match="a plane that faces the camera"):
        resolve_light(setup(proxy={"kind": "sphere"}), photo(lumps(75.0)))
