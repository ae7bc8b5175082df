"""The windowed Fourier responses against GD10 eq. 4 written out."""

import numpy as np
import pytest

from voldetail.metric.filters import FREQUENCIES, HALF_WINDOW, WINDOW_SIGMA, responses


def equation_4(image: np.ndarray, x: int, y: int, u: int, v: int) -> float:
    """|rho| around pixel (x, y), term by term."""
    total = 0j
    for a in range(-HALF_WINDOW + 1, HALF_WINDOW + 1):
        for b in range(-HALF_WINDOW + 1, HALF_WINDOW + 1):
            window = np.exp(-(a * a + b * b) / (2 * WINDOW_SIGMA**2))
            phase = 2 * np.pi * ((a + HALF_WINDOW - 1) * u + (b + HALF_WINDOW - 1) * v) / (2 * HALF_WINDOW)
            total += image[y + b, x + a] * window * np.exp(-1j * phase)
    return abs(total)


@pytest.mark.parametrize(("height", "width", "stride"), [(13, 22, 1), (9, 8, 1), (30, 19, 2), (40, 41, 1)])
def test_responses_are_equation_4(height: int, width: int, stride: int) -> None:
    image = np.random.default_rng(3).random((height, width)).astype(np.float32)
    found = responses(image, stride)
    assert found.shape == (17, (height - 8) // stride + 1, (width - 8) // stride + 1)
    rng = np.random.default_rng(4)
    for y, x in [(0, 0), (found.shape[1] - 1, found.shape[2] - 1), *rng.integers(0, found.shape[1:], (6, 2))]:
        for index, (u, v) in enumerate(FREQUENCIES):
            expected = equation_4(image, stride * x + 3, stride * y + 3, u, v)
            assert found[index, y, x] == pytest.approx(expected, abs=1e-4)


def test_large_images_are_filtered_in_pieces_alike() -> None:
    image = np.random.default_rng(5).random((24, 2600)).astype(np.float32)
    piece = responses(np.ascontiguousarray(image[:, 2000:2100]))
    np.testing.assert_allclose(responses(image)[:, :, 2000:2093], piece, atol=1e-5)


def test_the_paper_s_17_frequencies_are_distinct_also_up_to_conjugation() -> None:
    assert len({max((u, v), (-u, -v)) for u, v in FREQUENCIES}) == 17


def test_a_wave_answers_at_its_own_frequency_and_side() -> None:
    y, x = np.mgrid[0:32, 0:32]
    wave = np.cos(2 * np.pi * (2 * x + 2 * y) / 8).astype(np.float32)
    mean = responses(wave).mean(axis=(1, 2))
    assert FREQUENCIES[int(np.argmax(mean))] == (2, 2)
    assert mean[FREQUENCIES.index((2, 2))] > 10 * mean[FREQUENCIES.index((2, -2))]
