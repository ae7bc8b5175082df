"""Bright and dark spots by size, and slow swells: what each sees, against other ways to compute it."""

import numpy as np
import pytest
from scipy import ndimage

from voldetail.image import to_linear, to_srgb
from voldetail.metric import describe, distance, distance_by_level
from voldetail.metric.granulometry import KINDS, RADII, _residue, measure
from voldetail.metric.layers import layers
from voldetail.metric.low_pass import NAMES

SIDE = 128


def picture(values: np.ndarray) -> np.ndarray:
    """A linear picture whose encoded values are the given ones."""
    return to_linear(np.clip(values, 0, 1).astype(np.float32))


def spots(radius: int, bright: bool, seed: int = 1) -> np.ndarray:
    """Grey with some forty square spots of 2 r + 1 pixels that do not touch."""
    rng, values = np.random.default_rng(seed), np.full((SIDE, SIDE), 0.5, np.float32)
    for row in range(8, SIDE - 16, 16):
        for column in range(8, SIDE - 16, 16):
            y, x = row + rng.integers(0, 16 - 4 * radius), column + rng.integers(0, 16 - 4 * radius)
            values[y : y + 2 * radius + 1, x : x + 2 * radius + 1] = 0.8 if bright else 0.2
    return values


@pytest.mark.parametrize("radius", [1, 2, 3, 5])
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_an_opening_is_scipys(radius: int, sign: float) -> None:
    image = np.random.default_rng(radius).random((64, 80)).astype(np.float32) * sign
    found = _residue(layers(np.abs(image)), 0, image, radius)
    side, margin = 2 * radius + 1, 2 * radius
    expected = (image - ndimage.grey_opening(image, (side, side)))[margin:-margin, margin:-margin]
    assert np.array_equal(found[0], expected.ravel())
    assert found.min() >= 0  # an opening never brightens


def test_what_a_square_takes_is_what_fits_in_it() -> None:
    """Spots of 3 pixels are bright spots that an opening by 5 removes and one by 3 leaves."""
    parts = measure(layers(picture(spots(1, bright=True))), {})
    small, large = parts["bright level 0"]
    assert RADII == (1, 2)
    assert small.max() < 1e-6
    assert 0.25 < large.max() <= 0.3 + 1e-3  # the top 1/32 of the pixels, most of them in spots
    assert parts["dark level 0"].max() < 1e-3


def test_bright_and_dark_change_places_in_the_negative() -> None:
    values = spots(2, bright=True)
    one, other = measure(layers(picture(values)), {}), measure(layers(picture(1 - values)), {})
    for level in ("level 0", "level 1", "level 2"):
        assert one[f"bright {level}"] == pytest.approx(other[f"dark {level}"], abs=1e-4)
    assert {kind for kind, _ in KINDS} == {"bright", "dark"}


def test_it_tells_stones_from_holes_where_the_spectrum_does_not() -> None:
    values = spots(3, True)
    stones, others = picture(values), picture(spots(3, True, seed=2))
    holes = picture(2 * values.mean() - values)  # the same mean, and so the same spectrum

    def apart(metric: str, other: np.ndarray) -> float:
        reference = describe(stones, metric=metric)
        return distance(reference, describe(other, like=reference))

    assert apart("granulometry", holes) > 20 * apart("granulometry", others)
    assert apart("spectrum", holes) < 10 * apart("spectrum", others)


def test_nothing_outside_the_mask_counts() -> None:
    values = spots(2, bright=True)
    mask = np.zeros((SIDE, SIDE), bool)
    mask[:, :80] = True
    spoiled = values.copy()
    spoiled[:, 80:] = np.random.default_rng(3).random((SIDE, SIDE - 80))
    for metric in ("granulometry", "low-pass"):
        reference = describe(picture(values), mask, metric=metric)
        found = distance_by_level(reference, describe(picture(spoiled), mask, like=reference))
        # The pyramid's own blur reaches a pixel or two over the border at the coarser levels.
        assert found[next(iter(found))] < 0.02
        assert sum(found.values()) < 0.15


def test_a_swell_is_seen_at_its_wavelength_and_not_by_what_is_finer() -> None:
    y = np.arange(192)[:, None] * np.ones((1, 192))
    grain = 0.05 * np.random.default_rng(4).standard_normal((192, 192))
    flat = picture(0.5 + grain)
    reference = describe(flat, metric="low-pass")

    def parts(wavelength: float) -> dict[str, float]:
        wave = 0.1 * np.sin(2 * np.pi * y / wavelength)
        return distance_by_level(reference, describe(picture(0.5 + grain + wave), like=reference))

    fine, middle, slow = parts(8), parts(50), parts(100)
    assert max(fine.values()) < 0.3 * min(max(middle.values()), max(slow.values()))
    assert middle[NAMES[0]] > middle[NAMES[1]]
    assert slow[NAMES[1]] > slow[NAMES[0]]


def test_a_picture_in_other_units_is_encoded_before_it_is_measured() -> None:
    values = spots(2, bright=True)
    parts = measure(layers(picture(values)), {})
    assert to_srgb(picture(values)) == pytest.approx(values, abs=1e-5)
    assert parts["bright level 0"].max() <= 0.3 + 1e-3
