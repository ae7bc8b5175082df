"""sRGB, luminance, pyramids and resampling."""

import numpy as np
import pytest

from voldetail.image import gaussian_pyramid, luminance, masked_pyramid, resize, to_linear, to_srgb


def test_srgb_matches_the_standard_at_known_points():
    # IEC 61966-2-1: 18 % grey is 118 of 255, and both pieces meet at 0.0031308 / 0.04045.
    assert to_srgb(np.array([0, 0.0031308, 0.18, 1.0])) == pytest.approx([0, 0.04045, 0.46136, 1.0], abs=1e-5)
    assert to_linear(np.array([0.02, 0.5])) == pytest.approx([0.02 / 12.92, 0.214041], abs=1e-6)


def test_srgb_there_and_back():
    x = np.linspace(0, 2, 10_001, dtype=np.float32)
    back = to_linear(to_srgb(x))
    assert back.dtype == np.float32
    np.testing.assert_allclose(back, x, rtol=2e-5, atol=1e-7)
    assert np.all(np.diff(to_srgb(x)) > 0)


def test_luminance_weighs_the_channels():
    image = np.eye(3, dtype=np.float32)[None]
    assert luminance(image)[0] == pytest.approx([0.2126, 0.7152, 0.0722])
    assert luminance(np.ones((4, 5, 3)) * 0.5) == pytest.approx(np.full((4, 5), 0.5))


def reduce_by_definition(image):
    """REDUCE pixel by pixel from its sum, with the border reflected about the border pixel."""
    w = np.array([1, 4, 6, 4, 1]) / 16
    h, v = image.shape

    def at(i, n):
        return abs(i) if i < n else 2 * (n - 1) - i

    out = np.zeros(((h + 1) // 2, (v + 1) // 2))
    for y in range(out.shape[0]):
        for x in range(out.shape[1]):
            for a in range(-2, 3):
                for b in range(-2, 3):
                    out[y, x] += w[a + 2] * w[b + 2] * image[at(2 * y + a, h), at(2 * x + b, v)]
    return out


@pytest.mark.parametrize("shape", [(8, 8), (9, 12), (7, 5)])
def test_pyramid_is_the_published_sum(shape):
    image = np.random.default_rng(3).random(shape)
    levels = gaussian_pyramid(image, 2)
    assert [level.dtype for level in levels] == [np.float32, np.float32]
    np.testing.assert_allclose(levels[0], image, rtol=1e-6)
    np.testing.assert_allclose(levels[1], reduce_by_definition(image), rtol=1e-5)


def test_pyramid_halves_the_size_and_keeps_a_constant():
    levels = gaussian_pyramid(np.full((101, 64), 0.3), 4)
    assert [level.shape for level in levels] == [(101, 64), (51, 32), (26, 16), (13, 8)]
    for level in levels:
        np.testing.assert_allclose(level, 0.3, rtol=1e-6)


def test_coarse_mask_pixel_is_true_exactly_if_no_false_pixel_reaches_it():
    rng = np.random.default_rng(5)
    mask = rng.random((33, 40)) > 0.02
    masks = masked_pyramid(mask, 3)
    assert [m.shape for m in masks] == [(33, 40), (17, 20), (9, 10)]
    # A pixel is touched by a hole exactly if the pyramid of the holes is not zero there (all weights are
    # positive).
    for kept, hole in zip(masks, gaussian_pyramid(~mask, 3), strict=True):
        np.testing.assert_array_equal(kept, hole == 0)
    assert 0 < masks[1].sum() < masks[1].size


def test_resize_does_not_alias():
    stripes = np.tile([0.0, 1.0], (64, 32))  # one pixel wide: to be grey at half the size
    assert resize(stripes, (32, 32))[:, 4:-4] == pytest.approx(np.full((32, 24), 0.5), abs=0.02)
    assert np.ptp(stripes[::2, ::2]) == 0  # what a resize without a filter would give: all black


def test_resize_keeps_constants_shapes_range_and_channels():
    image = np.random.default_rng(0).random((40, 30, 3)).astype(np.float32) ** 4
    image[..., 1] = 0.25
    for size in [(20, 15), (80, 61), (20, 61), (40, 30), (1, 1)]:
        out = resize(image, size)
        assert out.shape == (*size, 3)
        assert out.dtype == np.float32
        assert out.min() >= image.min()
        assert out.max() <= image.max()
        np.testing.assert_allclose(out[..., 1], 0.25, rtol=1e-5)
    np.testing.assert_allclose(resize(image, (40, 30)), image, atol=1e-6)
    np.testing.assert_allclose(resize(image, (20, 15)).mean(), image.mean(), rtol=0.02)


def test_resize_keeps_the_place_of_things():
    ramp = np.tile(np.arange(64, dtype=np.float32), (8, 1))
    np.testing.assert_allclose(resize(ramp, (8, 32))[0, 4:-4], np.arange(32)[4:-4] * 2 + 0.5, atol=1e-3)
    with pytest.raises(ValueError, match="cannot resize"):
        resize(ramp, (0, 4))
