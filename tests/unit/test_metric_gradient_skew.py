"""The lopsided part of brightness differences: a saw whose numbers are known, its mirror image, noise, and a lit relief."""

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter

from voldetail.image import to_linear
from voldetail.metric import METRICS, describe, distance
from voldetail.metric.gradient_skew import LAGS, measure
from voldetail.metric.layers import layers

Image = NDArray[np.float32]
ACROSS = LAGS.index((0, 2))


def saw(side: int = 192) -> Image:
    """Ten pixels up, three down, along x, encoded 0.3 to 0.7."""
    x = np.arange(side) % 13
    ramp = np.where(x < 10, x / 10, (13 - x) / 3)[None, :] * np.ones((side, 1))
    return to_linear((0.3 + 0.4 * ramp).astype(np.float32))


def noise(seed: int, side: int = 192) -> Image:
    rough = gaussian_filter(np.random.default_rng(seed).standard_normal((side, side)), 1.0, mode="wrap")
    return to_linear((0.5 + 0.1 * rough / rough.std()).astype(np.float32))


def test_a_saw_has_the_numbers_of_its_two_slopes() -> None:
    """Differences over two pixels, by hand: of 13, 8 rise by 2/10 and one falls by 2/3; at the turns +1/10 - 1/3 and -1/3.

    >>> from fractions import Fraction as F
    >>> x = [F(i, 10) if i < 10 else F(13 - i, 3) for i in range(13)]
    >>> d = sorted(x[(i + 1) % 13] - x[i - 1] for i in range(13))
    >>> m = sum(d) / 13; s = float(sum((v - m) ** 2 for v in d) / 13) ** 0.5
    >>> round(float(d[0] + d[-1]) / 2 / s, 3), round(float(d[6]) / s, 3)
    (-0.712, 0.61)
    """
    found = measure(layers(saw()), {})["level 0"][ACROSS]
    assert found[0] == pytest.approx(-0.712, abs=0.03)  # the extremes: the fall outweighs the rise
    assert found[15] == pytest.approx(0.61, abs=0.03)  # the middle: most pixels rise
    assert found == pytest.approx(found[::-1])


@pytest.mark.parametrize("level", ["level 0", "level 1", "level 2"])
def test_half_a_turn_changes_the_sign_and_brightness_changes_little(level: str) -> None:
    picture = lit(5)
    one = measure(layers(picture), {})[level]
    turned = measure(layers(np.ascontiguousarray(picture[::-1, ::-1])), {})[level]
    assert np.abs(turned + one).mean() < 0.4 * np.abs(one).mean()  # levels begin at the other end
    darker = measure(layers(picture * np.float32(0.8)), {})[level]
    assert np.abs(darker - one).mean() < 0.3 * np.abs(one).mean()


def test_noise_has_no_skew() -> None:
    skews = [np.abs(measure(layers(noise(seed)), {})["level 0"]).mean() for seed in range(8)]
    assert max(skews) < 0.03
    assert np.abs(measure(layers(saw()), {})["level 0"][ACROSS]).mean() > 0.3


def lit(seed: int, slope: float = 0.6) -> Image:
    """Bumps under a side light: bright towards it, dark and in sharp shadow away from it."""
    rough = gaussian_filter(np.random.default_rng(seed).standard_normal((192, 192)), 3.0, mode="wrap")
    gradient = np.gradient(np.maximum(rough * 12, 0), axis=1)
    return np.clip(0.5 + slope * gradient, 0.02, 1.0).astype(np.float32)


def test_it_knows_a_relief_lit_from_the_other_side_and_the_others_hardly_do() -> None:
    ratios = {}
    for metric in ("gradient-skew", "combined", "published"):
        asking = describe(lit(1), metric=metric)
        same, other = (
            np.mean([distance(asking, describe(lit(seed, slope), like=asking)) for seed in (2, 3, 4)]) for slope in (0.6, -0.6)
        )
        ratios[metric] = other / same
    assert "gradient-skew" in METRICS
    assert ratios["gradient-skew"] > 4
    assert max(ratios["combined"], ratios["published"]) < 2


def test_a_mask_keeps_out_what_is_beyond_it() -> None:
    picture, mask = saw(), np.ones((192, 192), bool)
    mask[:, 120:] = False
    spoilt = picture.copy()
    spoilt[:, 121:] = 0.9
    one, other = (measure(layers(p, mask), {}) for p in (picture, spoilt))
    assert other["level 0"] == pytest.approx(one["level 0"], abs=1e-6)
