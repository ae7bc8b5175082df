"""Textures edited and morphed by their numbers."""

from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from texture_examples import blotches

from voldetail.backend import mitsuba

mitsuba()  # before Dr.Jit is imported, which would pick an LLVM of its own

from voldetail.detail.colour import ColourChannel, ColourTexture, Lobe  # noqa: E402
from voldetail.errors import InputError  # noqa: E402
from voldetail.image import to_srgb  # noqa: E402
from voldetail.texture import analyse, band_count, edit, morph, picture  # noqa: E402
from voldetail.texture.curve import curve_moments  # noqa: E402
from voldetail.texture.edit import bands_named  # noqa: E402

A = analyse(blotches(128, 128), seed=3, name="a")
B = analyse(blotches(64, 48, seed=2)[..., ::-1], seed=4, name="b")


@pytest.mark.parametrize(
    ("name", "bands"),
    [("0", [0]), (6, [6]), ("1-3", [1, 2, 3]), ("fine", [0, 1]), ("middle", [2, 3, 4]), ("coarse", [5, 6]), (" 2 ", [2])],
)
def test_names_of_bands(name: str | int, bands: list[int]) -> None:
    assert list(bands_named(name, 7)) == bands


@pytest.mark.parametrize("name", ["7", "-1", "3-1", "", "rough", "0-7", "1.5", "1-", "99999999999999999999"])
def test_unknown_bands(name: str) -> None:
    with pytest.raises(InputError, match="0 \\(the finest\\) to 6"):
        bands_named(name, 7)


def test_gains_multiply_weights() -> None:
    made = edit(A, {0: 0.5, "0-1": 2.0, "coarse": 0.0}, seed=9, name="new")
    assert (made.seed, made.name, band_count(made)) == (9, "new", 7)
    for before, after in zip(A.channels, made.channels, strict=True):
        assert after.weights == pytest.approx((before.weights[0], 2 * before.weights[1], *before.weights[2:5], 0.0, 0.0))
        assert after.curve == pytest.approx(before.curve, abs=1e-12)
    assert edit(A).channels[0].weights == A.channels[0].weights
    smooth = picture(edit(A, {"fine": 0.0}), (64, 64))
    assert np.abs(np.diff(smooth, axis=1)).mean() < 0.7 * np.abs(np.diff(picture(A, (64, 64)), axis=1)).mean()


def test_contrast_is_about_the_mean() -> None:
    for before, after in zip(A.channels, edit(A, contrast=0.5).channels, strict=True):
        mean, deviation = curve_moments(before.curve)
        assert curve_moments(after.curve) == pytest.approx((mean, deviation / 2), abs=1e-9)
    flat = to_srgb(picture(edit(A, contrast=0.0), (8, 8)))
    assert np.ptp(flat, axis=(0, 1)).max() < 1e-5


def test_a_gain_beyond_the_largest_weight_keeps_the_ratios() -> None:
    loud = ColourChannel(weights=(9000.0, 4500.0), curve=A.channels[0].curve)
    made = edit(A.model_copy(update={"channels": (loud, *A.channels[1:])}), {0: 100.0}).channels[0]
    assert made.weights[0] / made.weights[1] == pytest.approx(200.0)


@pytest.mark.parametrize(
    "wrong", [{"gains": {0: -1.0}}, {"gains": {0: float("nan")}}, {"gains": {"0-6": 0.0}}, {"contrast": -1.0}, {"seed": -4}]
)
def test_wrong_edits_are_refused(wrong: dict[str, Any]) -> None:
    with pytest.raises(InputError):
        edit(A, **wrong)


def test_the_ends_of_a_morph() -> None:
    assert morph(A, B, 0.0) == A
    end = morph(A, B, 1.0)
    assert end == B.model_copy(update={"seed": A.seed})
    assert np.array_equal(picture(morph(A, B, 0.0), (16, 16)), picture(A, (16, 16)))


def test_the_middle_of_a_morph() -> None:
    made = morph(A, B, 0.5)
    turn = [Rotation.from_matrix(np.reshape(x.axes, (3, 3))) for x in (A, made, B)]
    # Half of the angle between the two, about one axis.
    angle = (turn[0].inv() * turn[2]).magnitude()
    assert (turn[0].inv() * turn[1]).magnitude() == pytest.approx(angle / 2, abs=1e-6)
    assert (turn[1].inv() * turn[2]).magnitude() == pytest.approx(angle / 2, abs=1e-6)
    for p, m, q in zip(A.channels, made.channels, B.channels, strict=True):
        assert m.curve == pytest.approx((np.array(p.curve) + q.curve) / 2)
        assert len(m.weights) == 7
        padded = np.pad(q.weights, (0, 7 - len(q.weights)))
        assert m.weights == pytest.approx((np.array(p.weights) + padded) / 2)
    assert made.texels == (88, 96)


def test_a_morph_is_continuous() -> None:
    steps = [picture(morph(A, B, t), (32, 32)) for t in np.linspace(0, 1, 21)]
    changes = [np.abs(q - p).mean() for p, q in pairwise(steps)]
    assert max(changes) < 4.0 * np.mean(changes)


def test_what_cannot_be_morphed() -> None:
    for t in (-0.1, 1.1, float("nan")):
        with pytest.raises(InputError, match="out of range"):
            morph(A, B, t)
    with pytest.raises(InputError, match="encoding"):
        morph(A, analyse(blotches(), encoding="linear"), 0.5)
    lobes = ColourChannel(weights=(), lobes=(Lobe(frequency=0.1, angle=0.0, bandwidth=0.02, variance=1.0),), curve=(0.0,) * 10)
    texture = ColourTexture(channels=(lobes, lobes, lobes), texels=(8, 8))
    with pytest.raises(InputError, match="lobes"):
        morph(A, texture, 0.5)
    with pytest.raises(InputError, match="lobes"):
        edit(texture)
