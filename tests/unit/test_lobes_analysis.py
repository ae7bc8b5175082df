"""From a channel to its lobes: known spectra are recovered, variances add up, masks count, and what is refused."""

import math
from collections.abc import Sequence

import numpy as np
import pytest
from lobes_reference import noise
from numpy.typing import NDArray

from voldetail.detail.colour import Lobe
from voldetail.errors import InputError
from voldetail.texture.lobes import LEAST_BLUR, lobe_rows, lobes_of
from voldetail.texture.mixture import TINY, Bins, Pairs, _halves, binned, first_pairs, fit_pairs
from voldetail.texture.spectrum import power_spectrum

TWO = np.array([[0.1, 0.5, 0.02, 0.01, 0.7], [0.22, 2.2, 0.03, 0.03, 0.3]])


def lobes_power(lobes: Sequence[Lobe], fx: NDArray[np.float64], fy: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return S(f), variance per (cycle per texel)^2, of the lobes' sum at the frequencies ``fx``, ``fy`` (one shape)."""
    total = np.zeros(np.broadcast_shapes(fx.shape, fy.shape))
    for frequency, angle, along, across, variance in lobe_rows(lobes):
        c, s = math.cos(angle), math.sin(angle)
        u, w = fx * c + fy * s, (fy * c - fx * s) / across
        halves = np.exp(-0.5 * ((u - frequency) / along) ** 2) + np.exp(-0.5 * ((u + frequency) / along) ** 2)
        total += variance / (4 * math.pi * along * across) * halves * np.exp(-0.5 * w**2)
    return total


def divergence(bins: Bins, pairs: Pairs) -> float:
    """Return sum_n p_n log(1 / density_n), nats: the Kullback-Leibler divergence but for what no pairs can change."""
    plus, minus = _halves(bins, pairs)
    return float(-(bins.power * np.log(np.maximum(plus.sum(1) + minus.sum(1), TINY))).sum())


def picture(rows: np.ndarray, side: int = 256, seed: int = 1) -> np.ndarray:
    """The noise of lobes as a picture: row r lies at y = -r."""
    r, x = np.mgrid[:side, :side].astype(float)
    return noise(x.ravel(), -r.ravel(), rows, seed).reshape(side, side)


@pytest.fixture(scope="module")
def two() -> np.ndarray:
    return picture(TWO)


def test_two_known_lobes_are_found(two: np.ndarray) -> None:
    found = lobe_rows(lobes_of(two, count=2))
    assert found[:, 4].sum() == pytest.approx(two.var(), rel=1e-9)
    assert found[:, :2] == pytest.approx(TWO[:, :2], abs=0.006, rel=0.03)
    assert found[:, 2:4] == pytest.approx(TWO[:, 2:4], rel=0.25)
    assert found[:, 4] / found[:, 4].sum() == pytest.approx(TWO[:, 4], abs=0.08)


def test_a_mask_hides_what_it_hides(two: np.ndarray) -> None:
    rows, columns = np.mgrid[:256, :256]
    mask = np.hypot(rows - 120, columns - 130) < 110
    mask &= np.hypot(rows - 100, columns - 100) > 20
    spoilt = np.where(mask, two, 1e3 * np.sin(columns))
    found = lobe_rows(lobes_of(spoilt, mask, count=2))
    assert found[:, 4].sum() == pytest.approx(two[mask].var(), rel=1e-9)
    assert found[:, :2] == pytest.approx(TWO[:, :2], abs=0.01, rel=0.05)


def test_the_variance_is_the_channels_for_any_count(two: np.ndarray) -> None:
    for count in (1, 5, 64):
        lobes = lobes_of(3.0 * two + 7.0, count=count)
        assert 1 <= len(lobes) <= count
        assert sum(v.variance for v in lobes) == pytest.approx(9 * two.var(), rel=1e-9)
        assert [v.variance for v in lobes] == sorted((v.variance for v in lobes), reverse=True)


def test_a_quarter_turn_turns_the_lobes(two: np.ndarray) -> None:
    turned = lobe_rows(lobes_of(np.rot90(two), count=2))
    plain = lobe_rows(lobes_of(two, count=2))
    assert (turned[:, 1] - plain[:, 1]) % math.pi == pytest.approx(math.pi / 2, abs=0.02)


def test_a_slow_swell_cannot_make_the_noise_drift() -> None:
    side = 128
    ramp = np.add.outer(np.arange(side) * 0.05, np.zeros(side)) + np.random.default_rng(3).standard_normal((side, side))
    least = LEAST_BLUR / (2 * math.pi * side / 8)
    assert lobe_rows(lobes_of(ramp))[:, 2:4].min() >= least * (1 - 1e-12)


def test_more_lobes_fit_better_and_rounds_never_harm(two: np.ndarray) -> None:
    spectrum = power_spectrum(two)
    bins = binned(spectrum.power, spectrum.fx, spectrum.fy)
    by_count = [divergence(bins, fit_pairs(bins, first_pairs(bins, n, spectrum.blur), spectrum.blur)) for n in (1, 2, 6, 16)]
    assert by_count == sorted(by_count, reverse=True)
    start = first_pairs(bins, 6, spectrum.blur)
    by_round = [divergence(bins, fit_pairs(bins, start, spectrum.blur, rounds)) for rounds in (0, 5, 20, 60)]
    assert by_round == sorted(by_round, reverse=True)


def test_the_spectrum_of_white_noise_is_flat_and_sums_to_its_variance() -> None:
    white = np.random.default_rng(1).standard_normal((200, 160))
    spectrum = power_spectrum(white)
    twice = np.where((spectrum.fx > 0) & (spectrum.fx < 0.5), 2.0, 1.0)
    assert (spectrum.power * twice).sum() == pytest.approx(white.var(), rel=1e-9)
    assert spectrum.power.std() / spectrum.power.mean() < 0.35  # a plain periodogram has 1
    assert spectrum.fy[0] == pytest.approx(0.5)  # the first row is the highest frequency, y up


def test_a_wave_stands_at_its_frequency_whatever_the_edges() -> None:
    r, x = np.mgrid[:150, :131]
    spectrum = power_spectrum(np.cos(2 * math.pi * (0.173 * x - 0.081 * r)))
    row, column = np.unravel_index(np.argmax(spectrum.power), spectrum.power.shape)
    step = spectrum.fx[1]
    assert spectrum.fx[column] == pytest.approx(0.173, abs=step)
    assert spectrum.fy[row] == pytest.approx(0.081, abs=step)  # downwards minus is upwards plus


def test_the_sum_of_lobes_is_a_density() -> None:
    oblique = Lobe(frequency=0.1, angle=1.0, bandwidth=0.03, across=0.01, variance=2.0)
    lobes = (oblique, Lobe(frequency=0, angle=0, bandwidth=0.05, variance=1))
    f = np.linspace(-0.5, 0.5, 801)
    density = lobes_power(lobes, *np.meshgrid(f, f))
    assert density.sum() * (f[1] - f[0]) ** 2 == pytest.approx(3.0, rel=1e-3)
    assert density == pytest.approx(density[::-1, ::-1])


def test_the_same_lobes_again(two: np.ndarray) -> None:
    assert lobes_of(two, count=4) == lobes_of(two, count=4)


@pytest.mark.parametrize(
    ("channel", "said"),
    [
        (np.zeros((64, 64)), "same everywhere"),
        (np.zeros((16, 64)), "at least 32"),
        (np.zeros((64, 64, 3)), "two sides"),
        (np.full((64, 64), np.nan), "finite"),
    ],
)
def test_what_has_no_spectrum_is_refused(channel: np.ndarray, said: str) -> None:
    with pytest.raises(InputError, match=said):
        lobes_of(channel)


def test_masks_and_counts_that_cannot_be(two: np.ndarray) -> None:
    with pytest.raises(InputError, match="the same"):
        lobes_of(two, np.ones((4, 4), bool))
    with pytest.raises(InputError, match="at least 512"):
        lobes_of(two, np.zeros(two.shape, bool))
    for count in (0, 65):
        with pytest.raises(ValueError, match="count"):
            lobes_of(two, count=count)
