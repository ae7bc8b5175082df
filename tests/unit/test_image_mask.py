"""Masks."""

import numpy as np
import pytest
from PIL import Image

from voldetail.errors import InputError
from voldetail.image import load_mask, resize_mask

SHAPE = (40, 50)


@pytest.fixture
def disc():
    y, x = np.mgrid[: SHAPE[0], : SHAPE[1]]
    return (x - 30) ** 2 + (y - 18) ** 2 < 14**2


def save(path, values):
    Image.fromarray(values).save(path)
    return path


@pytest.mark.parametrize("high", [1, 128, 255])
def test_two_values_are_a_mask_whatever_the_higher_is(tmp_path, disc, high):
    path = save(tmp_path / "m.png", disc.astype(np.uint8) * np.uint8(high))
    mask = load_mask(path, SHAPE)
    assert mask.dtype == bool
    np.testing.assert_array_equal(mask, disc)


def test_one_bit_sixteen_bit_and_rgb_masks(tmp_path, disc):
    for values in (disc, disc.astype(np.uint16) * 65535, disc[..., None].repeat(3, 2).astype(np.uint8) * 255):
        np.testing.assert_array_equal(load_mask(save(tmp_path / "m.png", values), SHAPE), disc)


def test_jpeg_noise_is_no_grey(tmp_path, disc):
    path = tmp_path / "m.jpg"
    Image.fromarray(disc.astype(np.uint8) * 255).save(path, quality=98)
    np.testing.assert_array_equal(load_mask(path, SHAPE), disc)


def test_smooth_edges_are_cut_at_half_up_to_two_per_cent(tmp_path, disc):
    values = disc.astype(np.uint8) * 255
    edge = np.flatnonzero(disc)[:40]  # 2 % of 2000
    values.flat[edge[:20]], values.flat[edge[20:]] = 120, 140
    mask = load_mask(save(tmp_path / "m.png", values), SHAPE)
    assert not mask.flat[edge[:20]].any()
    assert mask.flat[edge[20:]].all()
    assert mask.sum() == disc.sum() - 20
    values.flat[np.flatnonzero(disc)[40]] = 130
    with pytest.raises(InputError, match=r"not black and white: 2\.\d % .* 2 % are allowed"):
        load_mask(save(tmp_path / "m.png", values), SHAPE)


def test_a_photograph_is_no_mask(tmp_path):
    values = np.random.default_rng(0).integers(0, 256, SHAPE, dtype=np.uint8)
    with pytest.raises(InputError, match="not black and white"):
        load_mask(save(tmp_path / "m.png", values), SHAPE)


def test_colour_is_refused(tmp_path, disc):
    values = np.zeros((*SHAPE, 3), dtype=np.uint8)
    values[disc, 0] = 255
    with pytest.raises(InputError, match="in colour"):
        load_mask(save(tmp_path / "m.png", values), SHAPE)


def test_wrong_size_tells_both_sizes(tmp_path, disc):
    with pytest.raises(InputError, match="50 x 40 pixels and the photo 41 x 50"):
        load_mask(save(tmp_path / "m.png", disc), (50, 41))


@pytest.mark.parametrize("value", [0, 5])
def test_empty_is_refused(tmp_path, value):
    with pytest.raises(InputError, match="is empty"):
        load_mask(save(tmp_path / "m.png", np.full(SHAPE, value, dtype=np.uint8)), SHAPE)


def test_all_white_is_all_and_all_grey_is_refused(tmp_path):
    assert load_mask(save(tmp_path / "m.png", np.full(SHAPE, 255, dtype=np.uint8)), SHAPE).all()
    with pytest.raises(InputError, match=r"not black and white: 100\.0 %"):
        load_mask(save(tmp_path / "m.png", np.full(SHAPE, 128, dtype=np.uint8)), SHAPE)


def test_transparent_pixels_are_not_used(tmp_path, disc):
    white = np.full((*SHAPE, 4), 255, dtype=np.uint8)
    white[..., 3] = disc * 255
    np.testing.assert_array_equal(load_mask(save(tmp_path / "m.png", white), SHAPE), disc)


def test_a_missing_mask_is_called_a_mask(tmp_path):
    with pytest.raises(InputError, match=r"The mask .* does not exist"):
        load_mask(tmp_path / "m.png", SHAPE)


def test_a_reduced_mask_holds_what_lies_wholly_inside():
    mask = np.zeros((12, 12), bool)
    mask[:, 4:] = True
    assert np.array_equal(resize_mask(mask, (12, 12)), mask)
    small = resize_mask(mask, (4, 4))
    assert small[:, 2:].all()  # pixels 6 to 11, away from the edge
    assert not small[:, :1].any()
    assert resize_mask(np.ones((9, 7), bool), (4, 3)).all()
