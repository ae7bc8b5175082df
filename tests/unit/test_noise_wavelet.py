"""Wavelet noise: its tile, its law, both implementations, and independence."""

from types import ModuleType
from typing import Any

import numpy as np
import pytest
import wavelet_reference as reference

from voldetail.backend import mitsuba

mi: ModuleType = mitsuba()  # before Dr.Jit is imported, which would pick an LLVM of its own

import drjit as dr  # noqa: E402

from voldetail.noise.wavelet import WaveletNoise, wavelet_noise  # noqa: E402
from voldetail.noise.wavelet_spectrum import (  # noqa: E402
    PHASE,
    covariance_lines,
    leak_matrix,
    passed_variance,
    spline,
    variance,
)
from voldetail.noise.wavelet_tile import projection, wavelet_tile  # noqa: E402


def columns(x: np.ndarray) -> tuple[Any, ...]:
    return tuple(mi.Float(np.ascontiguousarray(x[:, axis], np.float32)) for axis in range(x.shape[1]))


def band(x: np.ndarray, number: int, seed: int, noise: WaveletNoise | None = None) -> np.ndarray:
    """Values (4, N) of the package's noise."""
    noise = noise or wavelet_noise(x.shape[1], mi.Float)
    scale = dr.opaque(mi.Float, 2.0**-number)
    return noise.band(columns(x), scale, dr.opaque(mi.UInt32, number), dr.opaque(mi.UInt32, seed)).numpy()


def raster(side: int, number: int, seed: int) -> np.ndarray:
    """A picture (4, side, side) of one 2D band, a pixel a texel."""
    g = np.arange(side, dtype=np.float32)
    return band(np.stack([np.tile(g, side), np.repeat(g, side)], -1), number, seed).reshape(4, side, side)


def test_the_projection_is_the_published_filter() -> None:
    line = np.random.default_rng(1).standard_normal(64)
    # Cook and DeRose print six digits and cut the filter at 32 numbers.
    assert np.abs(projection(64) @ line - reference.low_part(line)).max() < 4e-3
    part = projection(64)
    assert np.allclose(part @ part, part, atol=1e-12)
    assert np.trace(part) == pytest.approx(32.0, abs=1e-9)


def test_what_half_the_resolution_can_represent_is_gone() -> None:
    # In one image: the part along both axes that P keeps, after 1 - P x P, is none.
    image = np.random.default_rng(2).standard_normal((64, 64))
    part = projection(64)
    rest = image - part @ image @ part.T
    assert np.abs(part @ rest @ part.T).max() < 1e-12


@pytest.mark.parametrize(("dims", "side"), [(2, 128), (3, 32)])
def test_the_tile_has_the_expected_variance_and_is_cached(dims: int, side: int) -> None:
    tile = wavelet_tile(dims, side)
    assert tile is wavelet_tile(dims, side)
    assert tile.shape == (side,) * dims + (4,)
    assert not tile.flags.writeable
    # 2 (1 - 2 tr(P)^d / n^d + tr(PP')^d / n^d), from the matrices themselves.
    part = projection(side)
    kept, squared = np.trace(part) / side, np.trace(part @ part.T) / side
    expected = 2.0 * (1.0 - 2.0 * kept**dims + squared**dims)
    assert tile.reshape(-1, 4).var(axis=0) == pytest.approx(np.full(4, expected), rel=0.04)
    correlation = np.corrcoef(tile.reshape(-1, 4).T) - np.eye(4)
    assert np.abs(correlation).max() < 5.0 / np.sqrt(side**dims)


@pytest.mark.parametrize("side", [8, 100, 0x7FFF])
def test_another_side_is_refused(side: int) -> None:
    with pytest.raises(ValueError, match="power of two"):
        wavelet_tile(2, side)


def test_the_expected_variance() -> None:
    # Cook and DeRose measured 0.265 and 0.210 on tiles; the expectation of this construction is near both.
    assert variance(2) == pytest.approx(0.26993, abs=2e-5)
    assert variance(3) == pytest.approx(0.19560, abs=2e-5)
    # A spline's products from the spline itself: 11/20 at no distance.
    x = np.linspace(-2, 2, 40_001)
    assert np.sum(spline(x) ** 2) * (x[1] - x[0]) == pytest.approx(0.55, abs=1e-6)
    assert covariance_lines(np.zeros(1))[0, 0] == pytest.approx(0.55, abs=1e-3)
    at_phase = covariance_lines(np.zeros(1), 1.0)[:, 0]
    assert 2.0 * (at_phase[0] ** 2 - 2.0 * at_phase[1] ** 2 + at_phase[2] ** 2) == pytest.approx(variance(2), rel=1e-3)


@pytest.mark.parametrize(("dims", "number"), [(2, 0), (2, 2), (3, 0), (3, 3)])
def test_measured_variance_and_gaussian_law(dims: int, number: int) -> None:
    x = np.random.default_rng(3).uniform(-3e4, 3e4, (40_000, dims))
    values = band(x, number, 11)
    assert values.var(axis=1) == pytest.approx(np.full(4, variance(dims)), rel=0.04)
    assert np.abs(values.mean(axis=1)).max() < 0.02
    z = values / np.sqrt(variance(dims))
    # The variance differs from place to place in a cell, so the law over all places has slightly longer tails.
    assert (z**4).mean() == pytest.approx(3.0, abs=0.35)


@pytest.mark.parametrize("dims", [2, 3])
@pytest.mark.parametrize("number", [0, 1, 4])
def test_both_implementations_agree(dims: int, number: int) -> None:
    x = np.random.default_rng(4).uniform(-400, 400, (3000, dims)).astype(np.float32)
    expected = reference.noise(x.astype(np.float64), number, 77, wavelet_tile(dims))
    # Single precision holds a place 400 coefficients away to 3e-5; the noise is about as steep as it is high.
    assert np.abs(band(x, number, 77).T - expected).max() < 3e-4


def test_the_same_bits_for_any_split_and_number_of_threads() -> None:
    x = np.random.default_rng(5).uniform(-100, 100, (50_001, 2))
    whole = band(x, 1, 3)
    parts = np.concatenate([band(x[:777], 1, 3), band(x[777:], 1, 3)], axis=1)
    assert np.array_equal(whole, parts)
    count = dr.thread_count()
    try:
        dr.set_thread_count(1)
        assert np.array_equal(whole, band(x, 1, 3))
    finally:
        dr.set_thread_count(count)


@pytest.mark.parametrize("number", [0, 1, 2, 3])
def test_power_by_octave_is_the_expected_one(number: int) -> None:
    line = np.ones(256)
    expected = leak_matrix(line, line, 8)[:, number]
    edges = 2.0 ** -np.arange(1.0, 9.0)
    f = np.abs(np.fft.fftfreq(256))
    largest = np.maximum(f[:, None], f[None])
    found = np.zeros(8)
    for seed in (1, 2):
        for picture in raster(256, number, seed):
            power = np.abs(np.fft.fft2(picture)) ** 2 / 256**4
            for b in range(8):
                found[b] += power[(largest <= edges[b]) & (largest > (edges[b] / 2 if b < 7 else 0))].sum() / 8
    assert found == pytest.approx(expected, rel=0.05, abs=0.004)
    # The band limit: what lies outside its own octave.
    assert 1.0 - expected[number] / expected.sum() < (0.10, 0.18, 0.20, 0.24)[number]  # 16 % without an end
    assert found[np.abs(np.arange(8) - number) > 1].sum() < 0.03 * found.sum()


def test_bands_channels_and_seeds_are_independent() -> None:
    pictures = [raster(128, number, seed).reshape(4, -1) for number, seed in ((0, 1), (1, 1), (2, 1), (0, 2), (1, 2))]
    found = np.corrcoef(np.concatenate(pictures))
    # Of band 2's 128 x 128 texels about one in 8 is independent: four of their deviations.
    assert np.abs(found - np.eye(len(found))).max() < 4.5 / np.sqrt(128 * 128 / 8)


def test_a_tile_does_not_repeat() -> None:
    side = wavelet_noise(2, mi.Float).side
    x = np.random.default_rng(6).uniform(0, 4000, (20_000, 2))
    here = band(x, 0, 9)[0]
    for step in ((side, 0), (0, side), (side, side), (-side, 2 * side)):
        assert abs(np.corrcoef(here, band(x + np.array(step), 0, 9)[0])[0, 1]) < 0.04


def test_other_coordinates_are_refused() -> None:
    with pytest.raises(ValueError, match="2 or 3"):
        WaveletNoise(1, mi.Float)


def test_what_passes_a_pixel() -> None:
    sides = np.array([0.0, 0.1, 0.5, 1.0, 2.0, 4.0, 64.0])
    passed = passed_variance(sides)
    assert passed[0] == 1.0
    assert (np.diff(passed) < 0).all()
    assert passed[-1] < 1e-3
    # Means over boxes of 16 x 16 places, of band 3, whose coefficients are 8 texels apart.
    for side in (4, 8, 16):
        u = (np.arange(16) + 0.5) / 16 * side
        x = np.random.default_rng(side).uniform(-2e4, 2e4, (2000, 2))
        every = (x[:, None] + np.stack(np.meshgrid(u, u), -1).reshape(1, -1, 2)).reshape(-1, 2)
        means = band(every, 3, 5).reshape(4, 2000, 256).mean(axis=2)
        assert means.var() / variance(2) == pytest.approx(passed_variance(np.array([side / 8]))[0], rel=0.06)


def test_nothing_is_compiled_anew_for_other_numbers() -> None:
    x = np.random.default_rng(7).uniform(0, 50, (100, 2))
    band(x, 0, 1)
    with dr.scoped_set_flag(dr.JitFlag.KernelHistory, True):
        dr.kernel_history_clear()
        band(x + 1, 3, 8)
        history = [k for k in dr.kernel_history() if k["type"] == dr.KernelType.JIT]
    assert history
    assert all(k["cache_hit"] for k in history)
    assert 0 < PHASE < 0.5
