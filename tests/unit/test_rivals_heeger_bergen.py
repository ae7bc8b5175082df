"""The synthesis of Heeger & Bergen 1995: the histograms it promises, of pixels and of bands, at the photo's size and larger."""

import numpy as np
import pytest

from tests.benchmarks.rivals.heeger_bergen import LEVELS, bands, decorrelated, inner, matched, synthesise
from voldetail.image import to_linear, to_srgb

pytest.importorskip("pyrtools", reason="the steerable pyramid comes with the extra 'test'")

SIDE = 128


def photo(seed: int = 1) -> np.ndarray:
    """Blots of three sizes in two colours with grain, neither Gaussian nor grey, that wrap around."""
    rng = np.random.default_rng(seed)
    radius = np.hypot(*np.meshgrid(np.fft.fftfreq(SIDE), np.fft.fftfreq(SIDE)))
    fields = []
    for frequency in (0.04, 0.1, 0.2):
        ring = np.exp(-(((radius - frequency) / 0.03) ** 2))
        field = np.fft.ifft2(np.fft.fft2(rng.standard_normal((SIDE, SIDE))) * ring).real
        fields.append(field / field.std())
    blots = np.tanh(3 * fields[0]) + 0.4 * fields[1]
    colours = blots[..., None] * [0.16, 0.10, 0.02] + fields[2][..., None] * [0.01, 0.0, 0.05] + [0.5, 0.45, 0.4]
    return to_linear(np.clip(colours + 0.02 * rng.standard_normal(colours.shape), 0, 1))


def channels(picture: np.ndarray, like: np.ndarray) -> np.ndarray:
    mean, axes = decorrelated(to_srgb(like))
    return (to_srgb(picture) - mean) @ axes


def test_matched_has_the_other_histogram_and_keeps_the_order() -> None:
    rng = np.random.default_rng(2)
    values, like = rng.standard_normal((20, 30)), rng.exponential(size=(20, 30))
    found = matched(values, like)
    assert np.sort(found, axis=None) == pytest.approx(np.sort(like, axis=None))
    assert np.array_equal(np.argsort(found, axis=None), np.argsort(values, axis=None))
    larger = matched(rng.standard_normal((80, 90)), like)
    for share in (0.1, 0.5, 0.9):
        assert np.quantile(larger, share) == pytest.approx(np.quantile(like, share), abs=0.02)


def test_the_pyramid_is_put_together_again() -> None:
    from pyrtools.pyramids import SteerablePyramidFreq

    plane = np.random.default_rng(3).standard_normal((SIDE, SIDE))
    assert SteerablePyramidFreq(plane, height=LEVELS, order=3).recon_pyr() == pytest.approx(plane, abs=1e-4)


@pytest.mark.parametrize("size", [(SIDE, SIDE), (160, 2 * SIDE)])
def test_pixels_and_bands_have_the_photos_histograms(size: tuple[int, int]) -> None:
    like = photo()
    made = synthesise(like, size, seed=4)
    assert made.shape == (*size, 3)
    shares = np.linspace(0.02, 0.98, 25)
    a, b = channels(like, like), channels(made, like)
    for c in range(3):
        deviation = a[..., c].std()
        # Colours that leave the cube are clipped, so not all is exact.
        assert np.quantile(b[..., c], shares) == pytest.approx(np.quantile(a[..., c], shares), abs=0.03 * deviation)
        found, wanted = bands(b[..., c]), bands(a[..., c])
        for key, band in wanted.items():
            # The pixels' histogram is given last and disturbs the bands a little.
            assert found[key].std() == pytest.approx(inner(band).std(), rel=0.2)
            if band.size > 1000:
                wanted_quantiles = np.quantile(inner(band), shares[4:-4])
                assert np.quantile(found[key], shares[4:-4]) == pytest.approx(wanted_quantiles, abs=0.2 * band.std())


def test_the_same_seed_gives_the_same_texture_and_another_another() -> None:
    like = photo()[:64, :64]
    once, again, other = (synthesise(like, (64, 64), seed=seed, iterations=2) for seed in (5, 5, 6))
    assert np.array_equal(once, again)
    assert not np.allclose(once, other, atol=0.05)


def test_sides_that_do_not_halve_are_refused() -> None:
    with pytest.raises(ValueError, match="multiples of 16"):
        synthesise(photo(), (100, 128))
