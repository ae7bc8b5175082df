"""Analysis of a photo: colour axes, histogram, weights, and input that is wrong."""

import numpy as np
import pytest
from scipy.special import ndtr, ndtri
from texture_examples import blotches, grey_noise

from voldetail.backend import mitsuba

mitsuba()  # before Dr.Jit is imported, which would pick an LLVM of its own

from voldetail.errors import InputError  # noqa: E402
from voldetail.image import to_srgb  # noqa: E402
from voldetail.noise.wavelet_spectrum import variance  # noqa: E402
from voldetail.texture import CURVE_PROBABILITIES, analyse, picture  # noqa: E402
from voldetail.texture.analysis import principal_axes  # noqa: E402
from voldetail.texture.curve import PLACES, curve_at, curve_moments, fitted_curve  # noqa: E402
from voldetail.texture.gaussian import gaussianise  # noqa: E402
from voldetail.texture.power import band_powers, bands_in, weights_of  # noqa: E402


def test_the_axes_decorrelate_and_are_a_rotation() -> None:
    colours = blotches().reshape(-1, 3)
    axes = principal_axes(colours)
    covariance = np.cov((colours.astype(np.float64) @ axes.T).T)
    scale = np.sqrt(np.outer(np.diag(covariance), np.diag(covariance)))
    assert np.abs((covariance - np.diag(np.diag(covariance))) / scale).max() < 1e-4
    assert np.abs(covariance - np.diag(np.diag(covariance))).max() < 1e-6 * covariance[0, 0]
    assert (np.diff(np.diag(covariance)) <= 0).all()
    assert np.linalg.det(axes) == pytest.approx(1.0, abs=1e-12)
    assert axes[0].sum() > 0
    assert axes[1].sum() > 0


def test_shuffled_pixels_have_the_same_axes() -> None:
    colours = blotches().reshape(-1, 3)
    shuffled = colours[np.random.default_rng(1).permutation(len(colours))]
    assert principal_axes(shuffled) == pytest.approx(principal_axes(colours), abs=5e-5)  # float sums in another order


@pytest.mark.parametrize("shape", ["uniform", "two", "ties", "exponential"])
def test_gaussianised_values(shape: str) -> None:
    random = np.random.default_rng(2)
    values = {
        "uniform": random.uniform(-3, 5, 20_000), "exponential": random.exponential(1.0, 20_000),
        "two": np.where(random.uniform(size=20_000) < 0.3, 0.0, 1.0), "ties": np.round(random.standard_normal(20_000) * 4),
    }[shape]  # fmt: skip
    z, quantiles = gaussianise(values.astype(np.float32), PLACES)
    order = np.argsort(values, kind="stable")
    assert (np.diff(z[order]) >= 0).all()
    if shape in ("uniform", "exponential"):
        assert z.mean() == pytest.approx(0.0, abs=1e-3)
        assert z.std() == pytest.approx(1.0, abs=2e-3)
        assert quantiles == pytest.approx(np.quantile(values, ndtr(PLACES)), abs=0.02 * np.ptp(values))
    else:  # equal values have their mean rank
        for value in np.unique(values):
            below, equal = (values < value).mean(), (values == value).mean()
            assert np.allclose(z[values == value], ndtri(below + equal / 2), atol=1e-5)


def test_the_curve_goes_round() -> None:
    assert np.allclose(CURVE_PROBABILITIES, ndtr(np.linspace(-3.2, 3.2, 10)))
    z = np.linspace(-3.2, 3.2, 500)
    # A Gaussian histogram is a straight line, exactly; a lognormal one is nearly met.
    assert curve_at(0.3 + 0.1 * PLACES, z) == pytest.approx(0.3 + 0.1 * z, abs=1e-12)
    assert np.abs(curve_at(np.exp(0.5 * PLACES), z) - np.exp(0.5 * z)).max() < 0.06
    assert (np.diff(curve_at(np.exp(PLACES), z)) >= 0).all()
    mean, deviation = curve_moments(fitted_curve(np.exp(0.5 * PLACES), 1.0, 0.2))
    assert (mean, deviation) == pytest.approx((1.0, 0.2), abs=1e-9)


def test_powers_add_up_to_the_variance() -> None:
    picture_ = np.random.default_rng(3).standard_normal((100, 77)).astype(np.float32)
    picture_ -= picture_.mean()
    assert band_powers(picture_, share=0.0).sum() == pytest.approx(picture_.var(), rel=1e-5)
    assert band_powers(picture_).sum() == pytest.approx(1.0, rel=0.05)
    # Bands by max(|fx|, |fy|): white noise has as much in each as the band has frequencies, 3/4 of all in the finest.
    assert band_powers(picture_)[0] == pytest.approx(0.75, abs=0.03)


@pytest.mark.parametrize(("shape", "count"), [((512, 512), 9), ((256, 256), 8), ((100, 300), 8), ((8, 8), 3), ((70000, 8), 14)])
def test_the_number_of_bands(shape: tuple[int, int], count: int) -> None:
    assert bands_in(shape) == count


def test_a_wave_is_in_its_band() -> None:
    x = np.arange(256)
    for wavelength, band in ((2.5, 0), (5.0, 1), (12.0, 2), (40.0, 4)):
        wave = np.tile(np.sin(2 * np.pi * x / wavelength), (256, 1))
        assert int(np.argmax(band_powers(wave))) == band


def test_random_weights_are_recovered() -> None:
    errors, plain, sampled = [], [], []
    for seed in range(20):
        weights = np.random.default_rng(seed).uniform(0.2, 1.0, 7)
        texture = grey_noise(weights, seed=seed)
        shown = picture(texture, (256, 256))[..., 0].astype(np.float64)
        z = (shown - 0.5) / 0.05 * np.sqrt(np.sum(weights**2) * 0.26993)
        powers = band_powers(z)
        errors.append(weights_of(powers, z.shape)[:7] - weights)
        plain.append(np.sqrt(powers / variance(2))[:7] - weights)  # eq. 12 alone, without the leak
        # What a finite sample explains: chi-square with as many degrees of freedom as the tapered octave has frequencies.
        degrees = 3.0 * 4.0 ** (7 - np.arange(7)) * 0.5
        sampled.append(weights / np.sqrt(2.0 * degrees))
    error, direct = (np.sqrt(np.mean(np.square(v), axis=0)) for v in (errors, plain))
    assert (error[:4] < [0.01, 0.015, 0.03, 0.06]).all(), error
    assert (error[:5] < 4.0 * np.mean(sampled, axis=0)[:5] + 0.01).all(), (error, np.mean(sampled, axis=0))
    assert np.abs(np.mean(errors, axis=0))[:4].max() < 0.03
    # Eq. 12 by itself counts its neighbours' leak as its own.
    assert error[:5].mean() < direct[:5].mean()


def test_an_edge_does_not_become_fine_detail() -> None:
    # A slope from left to right is a jump where the picture meets itself: power at all frequencies, unless it is faded.
    slope = np.tile(np.linspace(-1, 1, 256), (256, 1))
    assert band_powers(slope)[:4].sum() < 5e-5 * slope.var()
    assert band_powers(slope, share=0.0)[:4].sum() > 2e-2 * slope.var()


def test_a_colour_photo_of_512_is_66_numbers() -> None:
    made = analyse(blotches(512, 512))
    assert sum(len(c.weights) + len(c.curve) for c in made.channels) + len(made.axes) == 66
    assert made.texels == (512, 512)


@pytest.mark.parametrize("shape", [(97, 61), (8, 8), (33, 200)])
def test_any_size(shape: tuple[int, int]) -> None:
    made = analyse(blotches(*shape))
    assert made.texels == (shape[1], shape[0])
    assert all(any(c.weights) for c in made.channels)


@pytest.mark.parametrize("encoding", ["srgb", "linear"])
def test_mean_and_deviation_are_in_the_curve(encoding: str) -> None:
    photo = blotches()
    made = analyse(photo, encoding=encoding)
    encoded = to_srgb(photo) if encoding == "srgb" else photo
    values = encoded.reshape(-1, 3).astype(np.float64) @ np.reshape(made.axes, (3, 3)).T
    for c, channel in enumerate(made.channels):
        mean, deviation = curve_moments(channel.curve)
        assert mean == pytest.approx(values[:, c].mean(), abs=1e-5)
        assert deviation == pytest.approx(values[:, c].std(), rel=1e-3)


def test_without_the_histogram_the_curves_are_straight() -> None:
    made = analyse(blotches(), match_histogram=False)
    for channel in made.channels:
        assert np.ptp(np.diff(channel.curve)) < 1e-5 * np.ptp(channel.curve)


def test_a_grey_photo_has_one_channel() -> None:
    grey = blotches()[..., 1]
    made = analyse(grey)
    assert [len(c.weights) > 1 for c in made.channels] == [True, False, False]
    assert np.ptp(made.axes[:3]) < 1e-6
    shown = picture(made, (64, 64))
    assert np.ptp(shown, axis=2).max() < 1e-5
    assert made == analyse(np.repeat(grey[..., None], 3, axis=2))


def test_a_constant_photo_is_a_flat_texture() -> None:
    made = analyse(np.full((40, 50, 3), (0.2, 0.5, 0.7), np.float32))
    assert picture(made, (9, 7)) == pytest.approx(np.broadcast_to((0.2, 0.5, 0.7), (7, 9, 3)), abs=1e-5)


def test_a_mask_leaves_out_what_is_outside() -> None:
    photo = blotches(128, 128)
    mask = np.ones((128, 128), bool)
    mask[:, 100:] = False
    spoilt = photo.copy()
    spoilt[:, 100:] = np.nan
    made = analyse(spoilt, mask)
    assert made == analyse(np.where(mask[..., None], photo, np.float32(1.0)), mask)
    whole = analyse(photo)
    # The power is that of the part inside, not less by the part left out.
    assert np.sum(np.square(made.channels[0].weights)) == pytest.approx(np.sum(np.square(whole.channels[0].weights)), rel=0.25)
    assert made.channels[0].weights[:4] == pytest.approx(whole.channels[0].weights[:4], rel=0.2)
    assert analyse(photo, np.ones((128, 128))) == whole


@pytest.mark.parametrize(
    ("photo", "mask", "message"),
    [
        (np.zeros((20, 1, 3)), None, "1 x 20 pixels"),
        (np.zeros((20, 20, 4)), None, "shape"),
        (np.zeros(20), None, "shape"),
        (np.full((20, 20, 3), np.nan), None, "NaN"),
        (np.full((20, 20, 3), np.inf), None, "infinite"),
        (np.zeros((20, 20, 3)), np.zeros((20, 20)), "leaves 0 pixels"),
        (np.zeros((20, 20, 3)), np.ones((20, 21)), "shape"),
        ("a word", None, "no array"),
    ],
)
def test_wrong_input_is_refused(photo: object, mask: object, message: str) -> None:
    with pytest.raises(InputError, match=message):
        analyse(photo, mask)  # type: ignore[arg-type]


def test_an_unknown_encoding_is_refused() -> None:
    with pytest.raises(InputError, match="srgb or linear"):
        analyse(blotches(), encoding="lab")
