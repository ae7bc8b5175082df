"""The benchmark's rivals: a pyramid that keeps energy, statistics against other ways to compute them, and what noise gives."""

import numpy as np
import pytest
from skimage import data

from tests.benchmarks.rivals import RIVALS, contours, portilla, random_features, sliced
from tests.benchmarks.rivals.steerable import LEVELS, ORIENTATIONS, doubled, pyramid
from voldetail.image import to_linear
from voldetail.metric.layers import Layers, layers

every_rival = pytest.mark.parametrize("rival", RIVALS)


def crop(name: str, y: int = 0, x: int = 0) -> Layers:
    photo = getattr(data, name)()[y : y + 192, x : x + 192]
    return layers(to_linear(photo / np.float32(255)))


def noise(seed: int) -> Layers:
    values = 0.5 + 0.1 * np.random.default_rng(seed).standard_normal((192, 192)).clip(-4, 4)
    return layers(to_linear(values.astype(np.float32)))


def apart(rival: str, one: Layers, other: Layers) -> float:
    statistic = RIVALS[rival]
    basis = statistic.basis(one)
    a, b = statistic.measure(one, basis), statistic.measure(other, basis)
    return sum(statistic.compare(a[name], b[name], basis.get(name)) for name in a)


def test_the_pyramid_keeps_the_energy() -> None:
    image = crop("gravel").images[0]
    image = image - image.mean()
    high, bands, lows = pyramid(image)
    # Analytic bands have twice the energy of their real parts.
    parts = [np.mean(high**2), *(np.mean(np.abs(b) ** 2) / 2 for level in bands for b in level), np.mean(lows[-1] ** 2)]
    assert sum(parts) == pytest.approx(float(np.mean(image**2)), rel=1e-4)
    assert [len(level) for level in bands] == [ORIENTATIONS] * LEVELS


def test_a_wave_lies_in_the_band_of_its_direction_and_doubling_keeps_it() -> None:
    y, x = np.mgrid[0:64, 0:64]
    wave = np.cos(2 * np.pi * (12 * x - 12 * y) / 64).astype(np.float32)  # crests rise to the right: 45 degrees
    _, bands, _ = pyramid(wave)
    strength = np.abs(bands[0]).mean(axis=(1, 2))
    assert int(np.argmax(strength)) == 1
    assert doubled(bands[1])[:, ::2, ::2] == pytest.approx(bands[1], abs=1e-4)


@every_rival
def test_no_distance_from_itself_little_to_another_crop_and_much_to_another_texture(rival: str) -> None:
    assert apart(rival, crop("gravel"), crop("gravel")) == 0
    other = apart(rival, crop("gravel"), crop("gravel", 300, 256))
    assert 0 < 1.2 * other < apart(rival, crop("gravel"), crop("brick"))


@every_rival
def test_two_fields_of_white_noise_are_alike(rival: str) -> None:
    """A law of large numbers: what is measured is of the process and not of the one field."""
    assert apart(rival, noise(1), noise(2)) < 0.5 * apart(rival, noise(1), crop("gravel"))


def test_white_noise_has_the_moments_and_correlations_of_a_gaussian_process() -> None:
    found = portilla.measure(noise(3), portilla.basis(noise(3)))
    _, deviation, skewness, kurtosis, *_ = found["pixels"] / [1, 0.1, 1, 1, 1, 1]
    # Skewness and kurtosis of n normal numbers deviate by sqrt(6 / n) and sqrt(24 / n); n = 36864.
    assert (deviation, skewness, np.exp(kurtosis)) == pytest.approx((1, 0, 3), abs=4 * np.sqrt(24 / 192**2))
    assert np.abs(found["phase"]).max() < 0.1
    assert np.abs(found["magnitude across"]).max() < 0.25


def test_an_autocorrelation_is_the_sum_of_products() -> None:
    values = np.random.default_rng(4).standard_normal((16, 16)).astype(np.float32)
    found, centred = portilla._autocorrelation(values), values - values.mean()
    # Row by row from shift (-3, -3); (0, 0) is the last of the 25.
    shifts = [(y, x) for y in range(-3, 4) for x in range(-3, 4)][:25]
    expected = [np.sum(centred * np.roll(centred, shift, (0, 1))) / np.sum(centred**2) for shift in shifts]
    assert found == pytest.approx(expected, abs=1e-5)


def test_a_layer_of_random_filters_is_a_sum_over_its_window_that_is_never_negative() -> None:
    first, _ = random_features._filters()
    maps = np.random.default_rng(5).standard_normal((1, 20, 20)).astype(np.float32)
    found = random_features._layer(maps, first, 7, 1)
    expected = [max(float(np.sum(maps[0, 4:11, 9:16] * kernel.reshape(7, 7))), 0) for kernel in first]
    assert found[:, 4, 9] == pytest.approx(expected, abs=1e-4)
    assert found.min() == 0


def test_slices_are_sorted_projections() -> None:
    seen = crop("grass")
    vectors = sliced._vectors(seen)["level 3"]
    direction = sliced._directions(len(vectors))[7]
    assert np.linalg.norm(direction) == pytest.approx(1, abs=1e-5)
    ordered = np.sort(direction @ vectors)
    assert sliced.measure(seen, {})["level 3"][7] == pytest.approx(ordered.reshape(32, -1).mean(axis=1), abs=1e-4)


def test_contours_are_edges_counted_and_pieces_less_holes() -> None:
    y, x = np.mgrid[0:12, 0:12]
    ring = (np.hypot(y - 5.5, x - 5.5) < 4.5) & (np.hypot(y - 5.5, x - 5.5) > 2)
    dots = np.zeros((12, 12), bool)
    dots[2:4, 2:4] = dots[7:9, 3:6] = True
    for above, euler in ((ring, 0), (dots, 2)):
        bits = above.astype(np.int8)
        pattern = bits[:-1, :-1] | bits[:-1, 1:] << 1 | bits[1:, :-1] << 2 | bits[1:, 1:] << 3
        found = contours._FUNCTIONALS @ np.bincount(pattern.ravel(), minlength=16)
        assert found[4] == pytest.approx(euler)
        # Each edge lies in two squares, half in each.
        assert found[0] == np.count_nonzero(np.diff(bits, axis=1))
        assert found[1] == np.count_nonzero(np.diff(bits, axis=0))


def test_contours_do_not_see_tone_and_change_sign_in_the_negative() -> None:
    seen = crop("gravel")
    flat = Layers(tuple(np.sqrt(image) for image in seen.images), seen.masks)
    negative = Layers(tuple(1 - image for image in seen.images), seen.masks)
    one, other, turned = (contours.measure(picture, {})["level 2"] for picture in (seen, flat, negative))
    assert other == pytest.approx(one, abs=0.006)  # blurring comes after the change of tone
    assert turned[4, ::-1] == pytest.approx(-one[4], abs=0.002)
    assert np.abs(one[4]).max() > 0.01
