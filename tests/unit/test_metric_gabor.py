"""The Gabor descriptor of GKHF14: equation 5 written out, what turning a picture does, and white noise's responses."""

import numpy as np
import pytest
from skimage import data

from voldetail.image import to_linear
from voldetail.metric import describe, distance
from voldetail.metric.gabor import CYCLES, NAMES, ORIENTATIONS, SIGMAS, apart, cycles, measure, weights
from voldetail.metric.layers import layers
from voldetail.metric.sensitivity import contrast_sensitivity


def picture(values: np.ndarray) -> np.ndarray:
    """A linear picture whose encoded values are the given ones."""
    return to_linear(np.clip(values, 0, 1).astype(np.float32))


def gravel(side: int = 128) -> np.ndarray:
    return to_linear(data.gravel()[:side, :side] / np.float32(255))


def equation_5(values: np.ndarray, sigma: float, frequency: float, angle: float) -> tuple[float, float]:
    """Mean and deviation of |I * g| over the disc A_i, by sums over pixels; the integral of |g| is taken as a sum too."""
    half = int(np.ceil(5 * sigma))
    b, a = np.mgrid[-half : half + 1, -half : half + 1]
    window = np.exp(-(a * a + b * b) / (2 * sigma**2)) / (2 * np.pi * sigma**2)
    f = frequency / sigma
    bias = np.exp(-2 * np.pi**2 * frequency**2) if frequency else 0.0
    kernel = window * (np.exp(2j * np.pi * f * (a * np.cos(angle) - b * np.sin(angle))) - bias)
    middle, radius = (len(values) - 1) / 2, len(values) / 2 - 2.5 * sigma
    padded = np.pad(values, half, mode="wrap")  # as a product of spectra has it
    responses = [
        abs(np.sum(padded[y : y + 2 * half + 1, x : x + 2 * half + 1] * kernel[::-1, ::-1]))
        for y in range(len(values))
        for x in range(len(values))
        if np.hypot(y - middle, x - middle) <= radius
    ]
    return float(np.mean(responses) / np.abs(kernel).sum()), float(np.std(responses) / np.abs(kernel).sum())


@pytest.mark.parametrize(("scale", "frequency", "index"), [(0, None, 0), (0, 0, 5), (0, 2, 3), (1, 0, 15), (1, 3, 8), (2, 1, 11)])
def test_responses_are_equation_5(scale: int, frequency: int | None, index: int) -> None:
    values = 0.5 + 0.15 * np.random.default_rng(scale).standard_normal((48, 48)).clip(-3, 3)
    found = measure(layers(picture(values)), {})[f"scale {scale}"]
    column = 0 if frequency is None else 1 + ORIENTATIONS * frequency + index
    cycle = 0.0 if frequency is None else CYCLES[frequency]
    expected = equation_5(values, SIGMAS[scale], cycle, index * np.pi / ORIENTATIONS)
    # Coarse scales are evaluated at fewer points of the same area.
    assert found[:, column] == pytest.approx(expected, rel=0.06 if scale else 0.01)


def test_there_are_374_responses_and_their_weights_follow_the_eye() -> None:
    found = weights()
    assert sum(found[name].size for name in NAMES if name != "global") == 374
    assert [len(cycles(scale)) for scale in range(6)] == [3, 4, 4, 4, 4, 4]
    # >>> f = 8.0; 2.6 * (0.0192 + 0.114 * f) * math.exp(-((0.114 * f) ** 1.1))      0.9808...
    # >>> f = 20.0; 2.6 * (0.0192 + 0.114 * f) * math.exp(-((0.114 * f) ** 1.1))     0.5026...
    assert contrast_sensitivity(np.array([0.2, 0.5])) == pytest.approx([0.98083, 0.50259], abs=1e-4)


def test_turning_the_picture_moves_orientations_on_and_changes_nothing_else() -> None:
    one, turned = measure(layers(gravel(127)), {}), measure(layers(np.rot90(gravel(127))), {})
    for scale in range(6):
        straight, moved = one[f"scale {scale}"], turned[f"scale {scale}"]
        if np.isnan(straight).all():
            assert np.isnan(moved).all()
            continue
        by_frequency = straight[:, 1:].reshape(2, -1, ORIENTATIONS)
        expected = np.roll(by_frequency, ORIENTATIONS // 2, axis=2)
        assert moved[:, 1:].reshape(by_frequency.shape) == pytest.approx(expected, rel=0.1, abs=4e-4)
        # And not by accident: without the turn they differ by more.
        assert np.abs(by_frequency - expected).mean() > 3 * np.abs(moved[:, 1:].reshape(expected.shape) - expected).mean()


def test_brightness_reaches_the_global_part_and_the_isotropic_kernels_only() -> None:
    values = 0.4 + 0.05 * np.random.default_rng(3).standard_normal((96, 96)).clip(-3, 3)
    dark, bright = measure(layers(picture(values)), {}), measure(layers(picture(values + 0.2)), {})
    assert bright["global"] - dark["global"] == pytest.approx(np.array([[0.2], [0]]), abs=1e-4)
    for scale in range(5):
        gap = bright[f"scale {scale}"] - dark[f"scale {scale}"]
        assert gap[0, 0] == pytest.approx(0.2, abs=1e-4)
        assert np.abs(gap[:, 1:]).max() < 1e-4


def test_white_noise_has_rayleigh_responses_of_the_filters_own_energy() -> None:
    """|I * g| of white noise of deviation s: mean square s^2 / (4 pi sigma^2), mean and deviation as Rayleigh's."""
    deviation, runs = 0.1, []
    for seed in range(4):
        noise = 0.5 + deviation * np.random.default_rng(seed).standard_normal((192, 192))
        runs.append(measure(layers(picture(noise)), {}))
    for scale in (1, 2, 3):
        last = np.mean([run[f"scale {scale}"][:, -ORIENTATIONS:] for run in runs], axis=(0, 2))
        energy = deviation**2 / (4 * np.pi * SIGMAS[scale] ** 2)
        assert last[0] == pytest.approx(np.sqrt(np.pi / 4 * energy), rel=0.03)
        assert last[1] == pytest.approx(np.sqrt((1 - np.pi / 4) * energy), rel=0.05)


def test_a_wave_answers_where_it_belongs() -> None:
    y, x = np.mgrid[0:128, 0:128]
    sigma, angle = SIGMAS[2], 3 * np.pi / ORIENTATIONS
    wave = 0.5 + 0.2 * np.cos(2 * np.pi * (x * np.cos(angle) - y * np.sin(angle)) / sigma)
    means = measure(layers(picture(wave)), {})["scale 2"][0, 1:].reshape(4, ORIENTATIONS)
    assert np.unravel_index(np.argmax(means), means.shape) == (3, 3)
    assert means[3, 3] == pytest.approx(0.1, rel=0.02)  # half the amplitude, the integral of |g| being 1


def test_gaussians_are_compared_by_the_closed_form() -> None:
    one, other = np.array([[0.3, 0.1], [0.2, 0.4]]), np.array([[0.1, 0.1], [0.3, np.nan]])
    assert apart(one, other, None) == pytest.approx(0.2**2 + 0.1**2)  # what one of them lacks is left out
    assert apart(one, other, np.array([[2.0, 5.0]])) == pytest.approx(4 * (0.2**2 + 0.1**2))


def test_a_small_picture_has_the_scales_that_fit() -> None:
    reference = describe(gravel(40), metric="gabor")
    assert np.isnan(reference.features["gabor"]["scale 5"]).all()
    assert np.isfinite(distance(reference, describe(gravel(128), like=reference)))
