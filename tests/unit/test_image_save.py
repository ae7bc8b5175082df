"""Saving pictures by suffix."""

import resource

import numpy as np
import pytest
from PIL import Image

from voldetail.errors import InputError, VoldetailError
from voldetail.image import load_photo, save_image


@pytest.fixture
def linear():
    return np.random.default_rng(1).random((40, 50, 3)).astype(np.float32)


def test_exr_keeps_every_bit_also_above_one(tmp_path, linear):
    linear *= 100
    save_image(tmp_path / "a.exr", linear)
    np.testing.assert_array_equal(load_photo(tmp_path / "a.exr").pixels, linear)
    save_image(tmp_path / "grey.EXR", linear[..., 0])
    np.testing.assert_array_equal(load_photo(tmp_path / "grey.EXR").pixels[..., 2], linear[..., 0])


def test_png_is_srgb_rounded_to_eight_bits_and_clipped(tmp_path):
    image = np.zeros((32, 32, 3), dtype=np.float32)
    image[0, 0] = [0.18, 5.0, -1.0]
    save_image(tmp_path / "a.png", image)
    with Image.open(tmp_path / "a.png") as saved:
        assert saved.mode == "RGB"
        assert saved.getpixel((0, 0)) == (118, 255, 0)
    codes = np.arange(256, dtype=np.uint8).reshape(8, 32).repeat(4, axis=0)
    Image.fromarray(codes).save(tmp_path / "codes.png")
    save_image(tmp_path / "again.png", load_photo(tmp_path / "codes.png").pixels)
    with Image.open(tmp_path / "again.png") as saved:
        np.testing.assert_array_equal(np.asarray(saved)[..., 0], codes)


def test_jpeg_is_near(tmp_path):
    ramp = np.linspace(0, 1, 64, dtype=np.float32)[None, :, None].repeat(64, 0).repeat(3, 2)
    save_image(tmp_path / "a.jpg", ramp)
    with Image.open(tmp_path / "a.jpg") as saved:
        assert saved.format == "JPEG"
    assert np.abs(load_photo(tmp_path / "a.jpg").pixels - ramp).max() < 0.02


@pytest.mark.parametrize("name", ["a.bmp", "a", "a.png.txt"])
def test_another_suffix_is_refused_with_the_known_ones(tmp_path, linear, name):
    with pytest.raises(InputError, match=r"\.png, \.exr, \.jpg"):
        save_image(tmp_path / name, linear)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("suffix", [".png", ".exr", ".jpg"])
def test_nothing_is_left_where_saving_fails(tmp_path, linear, suffix):
    linear[3, 4, 0] = np.nan
    with pytest.raises(VoldetailError, match="1 values that are NaN"):
        save_image(tmp_path / f"a{suffix}", linear)
    with pytest.raises(InputError, match="Cannot write"):
        save_image(tmp_path / "missing" / f"a{suffix}", np.zeros((4, 4, 3)))
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("room", [0.1, 0.999])
@pytest.mark.parametrize("suffix", [".png", ".exr", ".jpg"])
def test_a_full_disk_leaves_the_old_picture(tmp_path, linear, suffix, room):
    path = tmp_path / f"a{suffix}"
    save_image(path, linear)
    old = path.read_bytes()
    limits = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (int(room * len(old)), limits[1]))
    try:
        with pytest.raises(InputError, match="Cannot write"):
            save_image(path, linear[::-1])
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limits)
    assert path.read_bytes() == old
    assert [p.name for p in tmp_path.iterdir()] == [path.name]
