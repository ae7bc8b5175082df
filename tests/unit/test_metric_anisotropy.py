"""Elongation of a texture from its spectrum, on noise of known stretch."""

import numpy as np
import pytest
from skimage import data

from voldetail.errors import InputError
from voldetail.image import to_linear
from voldetail.metric.anisotropy import anisotropy


def stretched_noise(factor: float, angle: float, seed: int, slope: float | None = None, side: int = 192) -> np.ndarray:
    """Noise `factor` times longer along `angle` (counter-clockwise, y up); band-passed, or falling as r^-slope."""
    x, y = np.fft.fftfreq(side)[None, :], -np.fft.fftfreq(side)[:, None]
    along, across = np.cos(angle) * x + np.sin(angle) * y, np.cos(angle) * y - np.sin(angle) * x
    radius = np.hypot(along * np.sqrt(factor), across / np.sqrt(factor)) + 1e-9
    amplitude = (radius + 0.01) ** -slope if slope else np.exp(-(np.log(radius / 0.06) ** 2) / 0.25)
    noise = np.fft.ifft2(np.fft.fft2(np.random.default_rng(seed).standard_normal((side, side))) * amplitude).real
    return to_linear(np.clip(0.5 + 0.12 * noise / noise.std(), 0, 1).astype(np.float32))


def turned(angle: float, expected: float) -> float:
    """Difference of two directions that have no sign."""
    return abs((angle - expected + np.pi / 2) % np.pi - np.pi / 2)


@pytest.mark.parametrize("slope", [None, 1.5])
@pytest.mark.parametrize(("factor", "angle"), [(1.5, 0.4), (2.0, 2.5), (3.0, 1.2), (5.0, 0.0)])
def test_it_finds_a_known_stretch(factor: float, angle: float, slope: float | None) -> None:
    for seed in range(3):
        found, direction = anisotropy(stretched_noise(factor, angle, seed, slope))
        assert found == pytest.approx(factor, rel=0.15)
        assert turned(direction, angle) < 0.15


def test_isotropic_noise_is_not_stretched() -> None:
    assert max(anisotropy(stretched_noise(1, 0, seed, 1.5))[0] for seed in range(4)) < 1.15


def test_slow_shading_does_not_matter() -> None:
    noise = stretched_noise(2, 0.8, 3)
    shaded = noise * np.linspace(0.4, 1.0, noise.shape[1], dtype=np.float32)
    factor, angle = anisotropy(shaded)
    assert factor == pytest.approx(anisotropy(noise)[0], rel=0.1)
    assert turned(angle, 0.8) < 0.1


def test_only_the_masked_part_counts() -> None:
    both = np.hstack([stretched_noise(3, 0.5, 0), stretched_noise(3, 2.0, 1)])
    mask = np.zeros(both.shape, bool)
    mask[:, 200:] = True
    both[:50, :50] = np.nan
    factor, angle = anisotropy(both, mask)
    assert factor == pytest.approx(3, rel=0.15)
    assert turned(angle, 2.0) < 0.1


def test_upright_bricks_are_long_upright() -> None:
    factor, angle = anisotropy(to_linear(data.brick()[:256, :256] / np.float32(255)))
    assert factor > 1.5
    assert turned(angle, np.pi / 2) < 0.3


def test_a_blank_picture_has_no_direction() -> None:
    assert anisotropy(np.full((64, 64), 0.3, np.float32))[0] == 1


@pytest.mark.parametrize(
    ("picture", "mask", "words"),
    [
        (np.zeros((16, 64), np.float32), None, "smaller than 32 x 32"),
        (np.zeros((64, 64), np.float32), np.zeros((64, 64), bool), "smaller than 32 x 32"),
        (np.zeros((64, 64, 3), np.float32), None, "height, width"),
        (np.full((64, 64), np.inf, np.float32), None, "finite"),
    ],
)
def test_unusable_input_is_refused(picture: np.ndarray, mask: np.ndarray | None, words: str) -> None:
    with pytest.raises(InputError, match=words):
        anisotropy(picture, mask)
