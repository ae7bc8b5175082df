"""From a photo whose relief is known to its maps: nearer than flat, and what is said of photos that cannot be read."""

import numpy as np
import pytest

from tests.unit.relief_examples import apart, distant, lambert, photo_of, smooth_noise, view_of_size
from voldetail.detail.relief_maps import normals_of
from voldetail.errors import InputError
from voldetail.image import Photo, with_mask
from voldetail.recover.place import box_of, lamp_about
from voldetail.recover.recovery import recover
from voldetail.recover.reflectance import surface_of
from voldetail.recover.shading import shading_of
from voldetail.recover.slopes import Method
from voldetail.recover.tile import tile_of
from voldetail.setup.lamp import Lamp
from voldetail.setup.light import Light, direction_of, parse_light

SHAPE = (128, 160)
LIGHT = Light(direction=direction_of(30, 45))


def made(azimuth: float = 30.0) -> tuple[Photo, np.ndarray]:
    height = 1.4 * smooth_noise(SHAPE, 9.0, 4)
    return photo_of(lambert(height, azimuth, 45)), normals_of(height, 1.0)


@pytest.mark.parametrize("method", ["linear", "network"])
def test_normals_are_nearer_than_flat(method: Method) -> None:
    photo, true = made()
    flat = np.zeros_like(true)
    flat[..., 2] = 1
    found = recover(photo, LIGHT, method=method)
    # The linear step lands at a half of flat's error here; less than seven tenths is asked of both.
    assert apart(found.normal, true) < 0.7 * apart(flat, true)
    assert found.height.shape == SHAPE
    assert found.height.min() == 0


def test_the_same_photo_gives_the_same_maps() -> None:
    photo, _ = made()
    one, other = recover(photo, LIGHT), recover(photo, LIGHT)
    assert np.array_equal(one.detail.height, other.detail.height)
    assert np.allclose(one.albedo, other.albedo, atol=1e-6)


def test_size_and_zone() -> None:
    photo, _ = made()
    assert recover(photo, LIGHT, size=80, method="linear").height.shape == (64, 80)
    cut = recover(photo, LIGHT, zone=(32, 16, 96, 64), method="linear")
    assert cut.height.shape == (64, 96)
    assert cut.detail.record.texels_per_unit == pytest.approx(48)
    assert cut.detail.record.provenance is not None
    assert cut.detail.record.provenance.zone == (32, 16, 96, 64)


def test_a_mask_of_islands_is_its_box_filled_between() -> None:
    photo, _ = made()
    mask = np.zeros(SHAPE, bool)
    mask[20:70, 20:70] = mask[60:110, 90:150] = True
    found = recover(with_mask(photo, mask), LIGHT, method="linear")
    assert box_of(mask) == (20, 20, 130, 90)
    assert found.height.shape == (90, 130)
    inside = (slice(10, 40), slice(10, 40))
    whole = recover(photo, LIGHT, method="linear").normal[20:110, 20:150]
    assert np.abs(found.normal[inside] - whole[inside]).mean() < 0.05
    assert np.isfinite(found.albedo).all()


def test_half_burnt_out_is_said_and_filled() -> None:
    photo, _ = made()
    pixels = photo.pixels.copy()
    pixels[:, 80:] = 1.0
    found = recover(Photo(pixels, "b" * 64), LIGHT, method="linear")
    assert any("burnt out" in note for note in found.notes)
    assert np.isfinite(found.height).all()


def test_what_cannot_be_read_is_refused() -> None:
    white = Photo(np.ones((*SHAPE, 3), np.float32), "c" * 64)
    with pytest.raises(InputError, match="burnt out"):
        recover(white, LIGHT)
    photo, _ = made()
    for size in (8, 100_000):
        with pytest.raises(InputError, match="size"):
            recover(photo, LIGHT, size=size)
    with pytest.raises(InputError, match="outside the photo"):
        recover(photo, LIGHT, zone=(100, 100, 90, 90))
    with pytest.raises(InputError, match="auto"):
        recover(photo, parse_light("auto"))


def test_an_even_photo_has_no_relief_and_that_is_said() -> None:
    found = recover(Photo(np.full((64, 64, 3), 0.3, np.float32), "d" * 64), LIGHT, method="linear")
    assert any("No relief" in note for note in found.notes)
    assert found.confidence == 0
    assert found.normal[..., 2].min() > 0.999


def test_a_wrong_light_is_said() -> None:
    photo, _ = made(azimuth=120)
    assert any("contradicts" in note for note in recover(photo, LIGHT, method="linear").notes)


def test_the_smallest_photo() -> None:
    photo, _ = made()
    small = Photo(np.ascontiguousarray(photo.pixels[:32, :32]), "e" * 64)
    for method in ("linear", "network"):
        assert recover(small, LIGHT, method=method).height.shape == (32, 32)  # type: ignore[arg-type]


@pytest.mark.parametrize("light", ["flash", "flash@0.3,0.6,1.2", "point:-0.5,0.4,1.5", "0.3,0.2,1"])
def test_any_light(light: str) -> None:
    photo, _ = made()
    found = recover(photo, parse_light(light), method="linear")
    assert np.isfinite(found.height).all()
    assert np.isfinite(found.again).all()


def test_a_zone_is_a_picture_of_its_own_under_a_near_lamp() -> None:
    """A lamp one unit over the right half's middle: there it stands two units over the middle of 2 units."""
    view = view_of_size((100, 200))
    half = type(view)(left=0.0, right=1.0, bottom=-0.5, top=0.5, columns=100, rows=100)
    lamp = lamp_about(Lamp(position=(0.5, 0.0, 1.0)), half)
    assert lamp.position == pytest.approx((0.0, 0.0, 2.0))


class TestSurface:
    """Coefficients and albedo of a relief that is known."""

    def test_albedo_of_a_known_relief(self) -> None:
        height = smooth_noise(SHAPE, 9.0, 4)
        view = view_of_size(SHAPE)
        shading = shading_of(height * np.float32(view.pixel), Lamp(direction_of(30, 45)), view)
        paint = np.where(smooth_noise(SHAPE, 14.0, 9) > 0, 0.6, 0.3)[..., None] * np.array([1.0, 0.9, 0.7])
        pixels = ((0.25 * shading.ambient + 0.75 * shading.diffuse)[..., None] * paint).astype(np.float32)
        ones = np.ones(SHAPE, np.float32)
        found = surface_of(pixels, ones, None, shading)
        ratio = found.albedo / paint
        assert ratio.std() / ratio.mean() < 0.12
        assert found.reflectance.specular <= 0.06
        assert 0 < found.reflectance.diffuse <= 1

    def test_gloss_is_seen(self) -> None:
        height = smooth_noise(SHAPE, 9.0, 4)
        view = view_of_size(SHAPE)
        shading = shading_of(height * np.float32(view.pixel), Lamp(direction_of(30, 60)), view)
        matt = 0.1 * shading.ambient + 0.3 * shading.diffuse
        ones = np.ones(SHAPE, np.float32)

        def grey(light: np.ndarray) -> np.ndarray:
            return np.repeat(light[..., None], 3, axis=2).astype(np.float32)

        dull = surface_of(grey(matt), ones, None, shading)
        shiny = surface_of(grey(matt + 0.03 * shading.specular[1]), ones, None, shading)
        assert dull.reflectance.specular == 0
        assert dull.roughness == 0.9
        assert shiny.reflectance.specular == pytest.approx(0.03, abs=0.015)
        assert shiny.reflectance.shininess == 32
        assert shiny.roughness == pytest.approx(np.sqrt(2 / 34))

    def test_blocks_are_the_whole(self, monkeypatch: pytest.MonkeyPatch) -> None:
        height = (smooth_noise(SHAPE, 9.0, 4) * 0.01).astype(np.float32)
        view, lamp = view_of_size(SHAPE), Lamp(direction_of(30, 45))
        whole = shading_of(height, lamp, view)
        monkeypatch.setattr("voldetail.recover.shading.BLOCK", 70)
        parts = shading_of(height, lamp, view)
        assert np.abs(parts.diffuse - whole.diffuse).mean() < 1e-3
        assert np.abs(parts.ambient - whole.ambient).max() < 1e-3

    def test_a_flat_surface_reflects_what_it_gets(self) -> None:
        view = view_of_size(SHAPE)
        found = shading_of(np.zeros(SHAPE, np.float32), Lamp(direction_of(30, 45)), view)
        assert np.allclose(found.ambient, 1.0, atol=1e-4)
        assert np.allclose(found.diffuse, np.sin(np.radians(45)), atol=1e-4)


def test_a_tile_is_periodic_and_of_the_photos_relief() -> None:
    photo, _ = made()
    found = recover(photo, LIGHT, method="linear")
    tile = tile_of(found, 64, seed=1)
    assert tile.record.periodic
    assert tile.height.shape == (64, 64)
    rms = [float(np.sqrt(np.mean(np.diff(d.height * d.relief.amplitude, axis=1) ** 2))) for d in (tile, found.detail)]
    assert rms[0] == pytest.approx(rms[1], rel=0.5)
    jump = np.abs(tile.height[:, 0] - tile.height[:, -1]).mean()
    assert jump < 2.5 * np.abs(np.diff(tile.height, axis=1)).mean()
    for side, words in ((16, "out of range"), (500, "at most 128")):
        with pytest.raises(InputError, match=words):
            tile_of(found, side)


def test_the_light_of_each_pixel() -> None:
    far = distant(SHAPE, 30, 45)
    assert not far.varies
    assert np.allclose(far.direction[3, 5], direction_of(30, 45), atol=1e-6)
