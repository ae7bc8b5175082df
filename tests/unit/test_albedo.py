"""Colour apart from relief: what is taken out of a photo's luminance, and what is left alone."""

import numpy as np
import pytest
from scipy.ndimage import gaussian_filter

from voldetail.fit.albedo import albedo_apart
from voldetail.fit.colour import ColourDistance
from voldetail.image import luminance

SIDE = 160


def field(seed, sigma, deviation):
    """A Gaussian field of one size and deviation, mean 0."""
    found = gaussian_filter(np.random.default_rng(seed).normal(size=(SIDE, SIDE)), sigma, mode="wrap")
    return found * (deviation / found.std())


def photo(albedo_level, shading_level, chroma=None):
    """A grey photo exp(albedo + shading), with a chromaticity along red against blue."""
    level = np.exp(albedo_level + shading_level - 1.5)
    colour = np.stack([level, level, level], axis=-1)
    if chroma is not None:
        colour = colour * np.exp(chroma[..., None] * np.array([1.0, 0.0, -1.0]))
    return colour.astype(np.float32)


def grey(level):
    return np.exp(level - 1.5).astype(np.float32)


MASK = np.ones((SIDE, SIDE), bool)


def deviation(albedo):
    return float(np.log(luminance(albedo)).std())


def test_powers_add():
    # Albedo 0.3 and shading 0.4 of one size: of a deviation of 0.5, 0.3 are left.
    found = albedo_apart(photo(field(1, 3, 0.3), field(2, 3, 0.4)), MASK, [grey(field(3 + i, 3, 0.4)) for i in range(3)])
    assert deviation(found) == pytest.approx(0.3, rel=0.15)


def test_relief_that_makes_all_the_contrast_leaves_none():
    found = albedo_apart(photo(np.zeros((SIDE, SIDE)), field(2, 3, 0.4)), MASK, [grey(field(3 + i, 3, 0.4)) for i in range(3)])
    assert deviation(found) < 0.12


def test_what_is_of_another_size_stays():
    # Fine shading does not touch coarse stains.
    stains = field(1, 12, 0.3)
    shadings = [grey(field(9 + i, 1.5, 0.3)) for i in range(3)]
    found = np.log(luminance(albedo_apart(photo(stains, field(2, 1.5, 0.3)), MASK, shadings)))
    assert np.corrcoef(found.ravel(), stains.ravel())[0, 1] > 0.9
    assert found.std() == pytest.approx(0.3, rel=0.15)


def test_chromaticity_is_albedos_alone():
    chroma = field(4, 3, 0.2)
    shaded = photo(np.zeros((SIDE, SIDE)), field(2, 3, 0.4), chroma)
    found = albedo_apart(shaded, MASK, [grey(field(3 + i, 3, 0.4)) for i in range(3)])
    ratio = np.log(found[..., 0] / found[..., 2])
    assert np.corrcoef(ratio.ravel(), (2 * chroma).ravel())[0, 1] > 0.98


def test_without_relief_the_photo_is_the_albedo():
    stains = field(1, 4, 0.3)
    found = albedo_apart(photo(stains, np.zeros((SIDE, SIDE))), MASK, [])
    assert np.corrcoef(np.log(luminance(found)).ravel(), stains.ravel())[0, 1] > 0.98


def test_albedo_is_at_most_one_and_masked_pixels_do_not_count():
    pixels = photo(field(1, 3, 0.4), field(2, 3, 0.2), field(5, 3, 0.3))
    mask = MASK.copy()
    mask[40:80, 40:80] = False
    spoilt = pixels.copy()
    spoilt[~mask] = 50.0
    shading = [grey(field(3, 3, 0.2))]
    one, other = (albedo_apart(p, mask, shading) for p in (pixels, spoilt))
    assert one.max() <= 1.0
    assert one.min() >= 0.0
    np.testing.assert_allclose(one[mask], other[mask], rtol=1e-4)


def test_distance_of_colours():
    chroma = field(4, 3, 0.3)
    own = photo(field(1, 3, 0.2), np.zeros((SIDE, SIDE)), chroma)
    judge = ColourDistance(own, MASK, "combined")
    assert judge(own) == pytest.approx(0.0, abs=1e-6)
    alike = photo(field(11, 3, 0.2), np.zeros((SIDE, SIDE)), field(14, 3, 0.3))
    without = photo(field(11, 3, 0.2), np.zeros((SIDE, SIDE)))
    coarse = photo(field(11, 3, 0.2), np.zeros((SIDE, SIDE)), field(14, 9, 0.3))
    assert judge(alike) < 0.5 * judge(coarse)
    assert judge(alike) < 0.5 * judge(without)


def test_a_grey_photo_is_judged_by_its_luminance_alone():
    own = photo(field(1, 3, 0.3), np.zeros((SIDE, SIDE)))
    noisy = own * np.exp(np.random.default_rng(1).normal(0, 0.002, own.shape)).astype(np.float32)
    assert len(ColourDistance(noisy, MASK, "combined")._own) == 1
