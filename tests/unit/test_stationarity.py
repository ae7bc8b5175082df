"""Measures of stationarity: on known pictures, against invariants and against their definitions written out."""

import numpy as np
import pytest

from voldetail.errors import InputError
from voldetail.stationary.colour import from_lab, to_lab, usable
from voldetail.stationary.local import neighbourhoods, product
from voldetail.stationary.measure import BINS, MEASURES, mean_difference, stationarity
from voldetail.stationary.steerable import bands, with_bands


def noise(side: int = 48, seed: int = 0) -> np.ndarray:
    """Grey noise of 0.3 to 0.5, (side, side, 3) linear: no rare values, which high moments would be all about."""
    grey = np.random.default_rng(seed).uniform(0.3, 0.5, (side, side, 1))
    return np.repeat(grey, 3, axis=2).astype(np.float32)


def halves(side: int = 48) -> np.ndarray:
    """Dark noise on the left, bright noise on the right."""
    picture = noise(side)
    picture[:, : side // 2] *= 0.4
    return picture


@pytest.mark.parametrize("measure", MEASURES)
def test_a_constant_is_stationary(measure: str) -> None:
    found = stationarity(np.full((40, 50, 3), 0.3, np.float32), measure=measure)
    assert found.value == pytest.approx(0, abs=1e-4)
    assert found.map.shape == (40, 50)
    assert np.abs(found.map).max() < 1e-4


@pytest.mark.parametrize("measure", MEASURES)
def test_two_halves_are_less_stationary_than_one(measure: str) -> None:
    even, uneven = stationarity(noise(), measure=measure, sigma=6), stationarity(halves(), measure=measure, sigma=6)
    assert uneven.value > (1.5 if measure == "steerable" else 3) * even.value
    assert np.isfinite(uneven.map).all()
    assert float(uneven.map.mean()) == pytest.approx(uneven.value, rel=0.05)


@pytest.mark.parametrize("measure", MEASURES)
def test_a_tile_has_no_edges(measure: str) -> None:
    """At one point a pixel the measure is the same wherever the torus is cut open."""
    picture = halves(32)
    here = stationarity(picture, measure=measure, sigma=3, toroidal=True).value
    rolled = stationarity(np.roll(picture, (5, 11), (0, 1)), measure=measure, sigma=3, toroidal=True).value
    assert rolled == pytest.approx(here, rel=1e-3)


@pytest.mark.parametrize("measure", MEASURES)
def test_mirrors_do_not_matter(measure: str) -> None:
    picture = halves()
    here = stationarity(picture, measure=measure, sigma=6).value
    assert stationarity(picture[::-1, ::-1], measure=measure, sigma=6).value == pytest.approx(here, rel=2e-2)


def test_a_spot_is_where_the_map_is_high() -> None:
    picture = noise(64)
    picture[40:52, 10:22] = 0.9
    found = stationarity(picture, sigma=5)
    row, column = np.unravel_index(np.argmax(found.map), found.map.shape)
    assert 38 <= row < 54
    assert 8 <= column < 24


def test_what_is_masked_does_not_count() -> None:
    picture, mask = noise(64), np.ones((64, 64), bool)
    mask[20:40, 30:44] = False
    spoilt = picture.copy()
    spoilt[~mask] = np.nan
    spoilt[0, 0] = np.inf
    found = stationarity(spoilt, mask, sigma=6)
    assert np.isnan(found.map[~mask]).all()
    assert np.isfinite(found.map[mask]).sum() == mask.sum() - 1
    assert "1 pixels" in found.sentence
    assert found.value == pytest.approx(stationarity(picture, sigma=6).value, rel=0.35)
    shaded = np.where(mask[..., None], picture, 0.9)
    assert stationarity(shaded, mask, sigma=6).value == pytest.approx(found.value, rel=0.02)


def test_moments_agree_with_their_definition() -> None:
    """Eq. 1 and 2 as loops over all pixels of a small tile."""
    picture = halves(12)
    lab = to_lab(picture).astype(np.float64)
    offset = np.arange(12)[:, None] - np.arange(12)[None, :]
    window = sum(np.exp(-((offset + 12 * k) ** 2) / (2 * 2.0**2)) for k in (-1, 0, 1))
    window /= window.sum(axis=1, keepdims=True)
    expected = 0.0
    for c in range(3):
        f = lab[..., c]
        spread = f.std()
        if spread < 1e-3:
            continue
        for p in (1, 2, 3):
            local = (window @ ((f - f.mean()) / spread) ** p @ window.T * spread).ravel()
            expected += ((local[:, None] - local[None, :]) ** 2).mean()
    found = stationarity(picture, measure="moments3", sigma=2, toroidal=True).value
    assert found == pytest.approx(expected, rel=1e-3)


def test_histograms_agree_with_the_earth_movers_distance() -> None:
    """Eq. 1 and 3: transport between weighted samples, by scipy, for all pairs of a small tile's pixels."""
    from scipy.stats import wasserstein_distance

    picture = halves(8)
    lab = to_lab(picture).astype(np.float64)[..., 0]
    offset = np.arange(8)[:, None] - np.arange(8)[None, :]
    window = sum(np.exp(-((offset + 8 * k) ** 2) / (2 * 2.0**2)) for k in (-1, 0, 1))
    weights = np.einsum("ay,bx->abyx", window, window).reshape(64, 64)
    values = lab.ravel()
    pairs = [wasserstein_distance(values, values, weights[i], weights[j]) for i in range(64) for j in range(64)]
    bin_width = np.ptp(values) / BINS
    assert stationarity(picture, sigma=2, toroidal=True).value == pytest.approx(np.mean(pairs), abs=bin_width)


def test_mean_difference_is_over_all_pairs() -> None:
    rng = np.random.default_rng(1)
    values, share = rng.standard_normal((5, 4)), rng.random((5, 4))
    share /= share.sum()
    flat, portion = values.ravel(), share.ravel()
    expected = (np.abs(flat[:, None] - flat[None, :]) * portion[None, :]).sum(axis=1).reshape(5, 4)
    np.testing.assert_allclose(mean_difference(values, share), expected, atol=1e-12)


@pytest.mark.parametrize("shape", [(32, 32), (31, 45)])
def test_the_pyramid_puts_a_picture_together_again(shape: tuple[int, int]) -> None:
    plane = np.random.default_rng(2).standard_normal(shape).astype(np.float32)
    np.testing.assert_allclose(with_bands(plane, bands(plane)), plane, atol=1e-4)


def test_bands_answer_to_their_direction() -> None:
    x = np.arange(64)
    stripes = np.broadcast_to(np.sin(2 * np.pi * x / 4), (64, 64)).astype(np.float32)
    strength = [float(band.std()) for band in bands(stripes)]
    assert strength[0] == max(strength)
    assert strength[2] < 1e-3 * strength[0]


def test_products_in_parts_are_products() -> None:
    rng = np.random.default_rng(3)
    a, b = rng.standard_normal((37, 700)).astype(np.float32), rng.standard_normal((700, 530)).astype(np.float32)
    np.testing.assert_allclose(product(a, b), a @ b, atol=1e-3)


def test_blending_keeps_a_constant() -> None:
    near = neighbourhoods((20, 26), 3, 2, toroidal=True)
    np.testing.assert_allclose(near.blend(np.full((*near.grid, 2), 7, np.float32)), 7, rtol=1e-5)


def test_colours_go_there_and_back() -> None:
    picture = np.random.default_rng(4).random((9, 9, 3)).astype(np.float32)
    np.testing.assert_allclose(from_lab(to_lab(picture)), picture, atol=2e-3)


@pytest.mark.parametrize(
    ("photo", "options", "words"),
    [
        (noise(), {"measure": "entropy"}, "use one of mean"),
        (noise(), {"sigma": 0.0}, "1 to 48 pixels"),
        (noise(), {"sigma": float("nan")}, "1 to 48 pixels"),
        (noise(), {"mask": np.zeros((48, 48), bool)}, "mask is empty"),
        (noise(), {"mask": np.ones((40, 48), bool)}, "photo's size"),
        (np.full((48, 48, 3), np.nan), {}, "finite"),
        (np.zeros((48, 48, 4)), {}, "(height, width, 3)"),
    ],
)
def test_what_cannot_be_measured_is_refused(photo: np.ndarray, options: dict, words: str) -> None:
    with pytest.raises(InputError) as refusal:
        stationarity(photo, **options)
    assert words in str(refusal.value)


def test_a_grey_photo_counts_as_three_equal_channels() -> None:
    assert usable(np.full((12, 13), 0.5), None)[0].shape == (12, 13, 3)
