"""Synthesis: statistics in 2D and in slices, clamping against supersampled truth, strips, bits."""

from typing import Any

import numpy as np
import pytest
import wavelet_reference as reference
from scipy.special import ndtri
from texture_examples import blotches, grey_noise

from voldetail.backend import mitsuba

mi: Any = mitsuba()  # before Dr.Jit is imported, which would pick an LLVM of its own

import drjit as dr  # noqa: E402

from voldetail.detail.colour import ColourChannel, ColourTexture, Lobe  # noqa: E402
from voldetail.errors import InputError  # noqa: E402
from voldetail.image import to_linear, to_srgb  # noqa: E402
from voldetail.noise.wavelet_spectrum import leak_matrix, variance  # noqa: E402
from voldetail.noise.wavelet_tile import wavelet_tile  # noqa: E402
from voldetail.texture import analyse, colour_at, picture  # noqa: E402
from voldetail.texture.clamping import LARGEST_LOG, SMALLEST_LOG, STEPS, passed_table  # noqa: E402
from voldetail.texture.curve import curve_at, curve_moments, gaussian_curve  # noqa: E402
from voldetail.texture.filtered import COLUMNS, FARTHEST, ROWS, filtered_curve  # noqa: E402
from voldetail.texture.picture import texels_footprint  # noqa: E402
from voldetail.texture.power import band_powers, taper_line  # noqa: E402
from voldetail.texture.solid import PLANE_SHARE, SLICE_SHARE, share_matrix, slice_weights  # noqa: E402

EXAMPLE = analyse(blotches(256, 256), seed=5)


def colours(texture: ColourTexture, x: np.ndarray, footprint: Any = 0.0) -> np.ndarray:
    """Colours (N, 3) at points (N, 2 or 3)."""
    points = tuple(mi.Float(np.ascontiguousarray(x[:, a], np.float32)) for a in range(x.shape[1]))
    return np.stack([v.numpy() for v in colour_at(texture, points, footprint)], -1)


@pytest.mark.parametrize("dims", [2, 3])
@pytest.mark.parametrize("encoding", ["srgb", "linear"])
def test_the_colour_is_the_formula(dims: int, encoding: str) -> None:
    texture = analyse(blotches(64, 64), seed=3, encoding=encoding)
    x = np.random.default_rng(1).uniform(-50, 50, (500, dims)).astype(np.float32)
    values = np.zeros((500, 3))
    for c, channel in enumerate(texture.channels):
        weights = np.array(slice_weights(channel.weights) if dims == 3 else channel.weights)
        noise = sum(w * reference.noise(x.astype(np.float64), i, 3, wavelet_tile(dims))[:, c] for i, w in enumerate(weights))
        values[:, c] = curve_at(channel.curve, noise / np.sqrt(variance(dims) * np.sum(weights**2)))
    expected = values @ np.reshape(texture.axes, (3, 3))
    expected = np.clip(to_linear(expected) if encoding == "srgb" else expected, 0, 1)
    assert np.abs(colours(texture, x) - expected).max() < 2e-3
    assert np.abs(colours(texture, x) - expected).mean() < 1e-4


@pytest.mark.parametrize("dims", [2, 3])
def test_mean_and_deviation_are_the_photos(dims: int) -> None:
    photo = blotches(256, 256)
    x = np.zeros((40_000, dims))
    x[:, :2] = np.random.default_rng(2).uniform(-2e4, 2e4, (40_000, 2))
    encoded = to_srgb(colours(EXAMPLE, x))
    expected = to_srgb(photo).reshape(-1, 3)
    assert encoded.mean(0) == pytest.approx(expected.mean(0), abs=0.01)
    assert np.cov(encoded.T) == pytest.approx(np.cov(expected.T), rel=0.06, abs=1e-5)
    # Each channel has the photo's histogram; sums of channels have it only where the photo's are independent.
    levels, axes = np.linspace(0.02, 0.98, 30), np.reshape(EXAMPLE.axes, (3, 3))
    for made, wanted in zip((encoded @ axes.T).T, (expected @ axes.T).T, strict=True):
        assert np.quantile(made, levels) == pytest.approx(np.quantile(wanted, levels), abs=0.08 * wanted.std())


def test_the_tables_of_shares() -> None:
    assert reference.slice_shares() == pytest.approx(SLICE_SHARE, abs=0.006)  # of a coarser grid
    line = taper_line(4096, 1.0)
    plane = leak_matrix(line, line, 8)[2:5, 3] / variance(2)
    assert plane == pytest.approx(PLANE_SHARE, abs=0.003)
    assert share_matrix(SLICE_SHARE, 12)[:, 0].sum() == pytest.approx(1.0, abs=0.003)
    assert share_matrix(PLANE_SHARE, 12)[:, 3].sum() == pytest.approx(1.0, abs=0.002)


@pytest.mark.parametrize("weights", [(0.4, 0.6, 0.8, 1.0, 0.8, 0.6), (1.0, 0.5, 0.25, 0.2, 0.1, 0.1)])
def test_a_slice_has_the_power_by_octave_of_the_plane(weights: tuple[float, ...]) -> None:
    found = []
    for solid in (False, True):
        powers = np.zeros(8)
        for seed in range(6):
            shown = picture(grey_noise(np.array(weights), seed=seed), (256, 256), (500.0 * seed, 0.0), solid=solid)[..., 0]
            powers += band_powers((shown - 0.5) / 0.05) / 6
        found.append(powers)
    # The slowest octaves differ from slice to slice, and slices have power below the slowest band.
    assert found[1][:5] == pytest.approx(found[0][:5], rel=0.15, abs=0.01)
    assert found[1].sum() == pytest.approx(found[0].sum(), rel=0.12)


def test_what_no_solid_can_have_is_met_as_nearly_as_can_be() -> None:
    # A hole below the finest band: a slice cannot have it, so all goes to the finest band.
    found = np.array(slice_weights((1.0, 0.0, 0.0, 0.0)))
    assert found[0] > 0
    assert (found[1:] < 1e-3 * found[0]).all()
    assert slice_weights((0.0, 0.0)) == (0.0, 0.0)


@pytest.mark.parametrize(("encoding", "bias"), [("linear", 0.004), ("srgb", 0.012)])
@pytest.mark.parametrize("dims", [2, 3])
def test_clamping_has_the_mean_and_variance_of_supersampled_pixels(encoding: str, bias: float, dims: int) -> None:
    texture = analyse(blotches(256, 256), seed=1, encoding=encoding)
    random = np.random.default_rng(4)
    x = np.zeros((4000, dims))
    x[:, :2] = random.uniform(-2e4, 2e4, (4000, 2))
    for side in (1.5, 6.0, 24.0):
        u = ((np.arange(8) + 0.5) / 8 - 0.5) * side
        shifts = np.zeros((64, dims))
        shifts[:, :2] = np.stack(np.meshgrid(u, u), -1).reshape(-1, 2)
        truth = colours(texture, (x[:, None] + shifts).reshape(-1, dims)).reshape(4000, 64, 3).mean(axis=1)
        clamped, sharp = colours(texture, x, side), colours(texture, x)
        assert clamped.mean(0) == pytest.approx(truth.mean(0), rel=bias + 0.008)
        assert clamped.std(0) == pytest.approx(truth.std(0), rel=0.08)
        assert (sharp.std(0) > 1.02 * truth.std(0)).all()
        error, unclamped = (np.sqrt(np.mean((v - truth) ** 2)) for v in (clamped, sharp))
        assert error < 0.65 * unclamped


def test_a_grazing_plane() -> None:
    # Rows of a plane seen at a slant: the footprint grows from row to row, an array.
    footprints = np.repeat(np.geomspace(1.0, 16.0, 8), 800)
    x = np.random.default_rng(5).uniform(-1e4, 1e4, (6400, 2))
    u = (np.arange(8) + 0.5) / 8 - 0.5
    shifts = np.stack(np.meshgrid(u, u), -1).reshape(1, -1, 2) * footprints[:, None, None]
    truth = colours(EXAMPLE, (x[:, None] + shifts).reshape(-1, 2)).reshape(8, 800, 64, 3).mean(axis=2)
    clamped = colours(EXAMPLE, x, mi.Float(footprints)).reshape(8, 800, 3)
    sharp = colours(EXAMPLE, x).reshape(8, 800, 3)
    for row in range(8):
        wanted = truth[row].std(0)
        assert clamped[row].std(0) == pytest.approx(wanted, rel=0.12, abs=0.004)
    assert (sharp[-1].std(0) > 1.5 * truth[-1].std(0)).all()


def test_footprints_agree_as_numbers_and_arrays() -> None:
    x = np.random.default_rng(6).uniform(-99, 99, (500, 2))
    assert np.array_equal(colours(EXAMPLE, x, 3.0), colours(EXAMPLE, x, mi.Float(np.full(500, 3.0))))
    assert np.allclose(colours(EXAMPLE, x, 1e-3), colours(EXAMPLE, x), atol=1e-5)
    far = colours(EXAMPLE, x, 1e5)
    assert np.ptp(far, axis=0).max() < 0.01
    assert far.mean(0) == pytest.approx(blotches(256, 256).mean((0, 1)), rel=0.02)


def test_the_filtered_curve_against_random_numbers() -> None:
    samples = tuple(np.exp(0.6 * np.linspace(-3.2, 3.2, 10)).tolist())
    table = filtered_curve(samples)
    assert table.shape == (ROWS, COLUMNS, 2)
    g = ndtri((np.arange(20_000) + 0.5) / 20_000)
    for row, column in ((0, 128), (8, 100), (16, 160), (32, 128)):
        z = -FARTHEST + 2 * FARTHEST * column / (COLUMNS - 1)
        values = curve_at(samples, z + np.sqrt(row / (ROWS - 1)) * g)
        assert table[row, column] == pytest.approx([values.mean(), values.var()], rel=0.01, abs=1e-6)
    # All removed: the channel's mean, wherever z is 0; nothing removed: the curve itself, without variance.
    assert table[-1, COLUMNS // 2] == pytest.approx(np.square(curve_moments(samples)) ** [0.5, 1.0], rel=0.01)
    assert table[0, :, 1].max() < 1e-12


@pytest.mark.parametrize("dims", [2, 3])
def test_bands_fade_smoothly(dims: int) -> None:
    table = passed_table(dims)
    assert table[0] == 1.0
    assert (np.diff(table) <= 0).all()
    assert np.abs(np.diff(table)).max() < 0.08
    # At a pixel as long as a coefficient, half a wavelength of the finest: 0.60 of the variance is left.
    at_one = np.interp(0.0, np.linspace(SMALLEST_LOG, LARGEST_LOG, STEPS), table)
    assert at_one == pytest.approx(0.596 if dims == 2 else 0.65, abs=0.04)


@pytest.mark.parametrize("solid", [False, True])
def test_the_same_picture_for_any_strips(solid: bool) -> None:
    whole = picture(EXAMPLE, (61, 47), (-7.5, 3.25), 0.7, solid)
    assert whole.shape == (47, 61, 3)
    assert whole.dtype == np.float32
    for pixels in (1, 100, 1000):
        assert np.array_equal(whole, picture(EXAMPLE, (61, 47), (-7.5, 3.25), 0.7, solid, strip_pixels=pixels))
    # A part of the picture is the picture of the part: the offset is of the lower left pixel, upward.
    part = picture(EXAMPLE, (20, 10), (5.0, 9.0))
    assert np.array_equal(part, picture(EXAMPLE, (40, 30))[30 - 9 - 10 : 30 - 9, 5:25])


def test_rows_go_down_and_y_goes_up() -> None:
    shown = picture(EXAMPLE, (4, 3))
    grid = np.array([[x, y] for y in (2.0, 1.0, 0.0) for x in range(4)])
    assert np.allclose(shown.reshape(-1, 3), colours(EXAMPLE, grid), atol=1e-6)


def test_a_smaller_picture_is_the_mean_of_a_larger() -> None:
    large = picture(EXAMPLE, (512, 512))
    blocks = large.reshape(128, 4, 128, 4, 3).mean(axis=(1, 3))
    small = picture(EXAMPLE, (128, 128), zoom=0.25)
    assert texels_footprint(4.0) == pytest.approx(np.sqrt(15.0))
    assert small.mean((0, 1)) == pytest.approx(blocks.mean((0, 1)), rel=0.015)
    assert small.std((0, 1)) == pytest.approx(blocks.std((0, 1)), rel=0.06)
    assert np.corrcoef(small[..., 0].ravel(), blocks[..., 0].ravel())[0, 1] > 0.9


def test_another_texture_compiles_nothing() -> None:
    x = np.random.default_rng(7).uniform(-9, 9, (300, 2))
    colours(EXAMPLE, x, 2.0)
    other = analyse(blotches(64, 80, seed=9), seed=8)
    with dr.scoped_set_flag(dr.JitFlag.KernelHistory, True):
        dr.kernel_history_clear()
        colours(other, x, 5.0)
        history = [k for k in dr.kernel_history() if k["type"] == dr.KernelType.JIT]
    assert all(k["cache_hit"] for k in history)


@pytest.mark.parametrize(("size", "zoom"), [((0, 5), 1.0), ((1 << 20, 1 << 20), 1.0), ((5, 5), 0.0), ((5, 5), float("nan"))])
def test_impossible_pictures_are_refused(size: tuple[int, int], zoom: float) -> None:
    with pytest.raises(InputError):
        picture(EXAMPLE, size, zoom=zoom)


GAUSSIAN = tuple(gaussian_curve(0.5, 0.1).tolist())


def test_channels_of_lobes_have_their_curves_and_their_direction() -> None:
    lobes = ColourChannel(weights=(), lobes=(Lobe(frequency=0.1, angle=0.0, bandwidth=0.01, variance=3.0),), curve=GAUSSIAN)
    still = ColourChannel(weights=(0.0,), curve=(0.0,) * 10)
    texture = ColourTexture(channels=(lobes, still, still), texels=(64, 64), encoding="linear")
    made = picture(texture, (512, 512))[..., 0].astype(np.float64)
    assert made.mean() == pytest.approx(0.5, abs=0.02)
    assert made.std() == pytest.approx(0.1, rel=0.06)
    along, across = np.diff(made, axis=1).std(), np.diff(made, axis=0).std()
    assert along > 5.0 * across
    # What is finer than a pixel is averaged, as a pixel's mean would be.
    small = picture(texture, (128, 128), zoom=1 / 32)[..., 0]
    assert small.std() < 0.005
    assert small.mean() == pytest.approx(0.5, abs=0.01)


def test_a_solid_of_lobes_is_laid_on_from_three_sides() -> None:
    lobes = ColourChannel(weights=(), lobes=(Lobe(frequency=0.1, angle=0.0, bandwidth=0.05, variance=1.0),), curve=GAUSSIAN)
    still = ColourChannel(weights=(0.0,), curve=(0.0,) * 10)
    texture = ColourTexture(channels=(lobes, still, still), texels=(64, 64), encoding="linear")
    random = np.random.default_rng(4)
    points = tuple(mi.Float(random.uniform(0, 3000, 40_000)) for _ in range(3))
    normals = tuple(mi.Float(v) for v in random.standard_normal((3, 40_000)))
    (value, _, _) = colour_at(texture, points, normals=normals)
    assert np.asarray(value).std() == pytest.approx(0.1, rel=0.03)
    (flat, _, _) = colour_at(texture, (*points[:2], mi.Float(0.0)), normals=(mi.Float(0.0), mi.Float(0.0), mi.Float(1.0)))
    assert np.asarray(flat).std() == pytest.approx(0.1, rel=0.03)


def test_a_driven_channel_takes_the_share_that_it_is_given() -> None:
    shares = np.array([1e-6, 0.01, 0.25, 0.5, 0.75, 0.99, 1.0])
    still = ColourChannel(weights=(0.0,), curve=(0.0,) * 10)
    moving = ColourChannel(weights=(1.0, 1.0), curve=GAUSSIAN)
    texture = ColourTexture(channels=(moving, still, still), texels=(64, 64), encoding="linear")
    points = (mi.Float(np.arange(7.0)), mi.Float(np.arange(7.0)))
    (value, _, _) = colour_at(texture, points, 4.0, first=mi.Float(shares))
    found = np.asarray(value)
    assert found[3] == pytest.approx(0.5, abs=0.002)
    # Phi^-1(0.75) = 0.67449, Phi^-1(0.99) = 2.3263 (tables).
    assert found[4] == pytest.approx(0.567449, abs=0.002)
    assert found[5] == pytest.approx(0.73263, abs=0.006)
    assert (np.diff(found) >= 0).all()
