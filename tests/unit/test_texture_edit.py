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
from voldetail.texture.edit import bands_named, faced, mean_colour  # noqa: E402

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
    assert end.seed == A.seed
    # The law of B, whose axes may face the other way.
    assert mean_colour(end) == pytest.approx(mean_colour(B), abs=1e-6)
    for q, made in zip(B.channels, end.channels, strict=True):
        assert made.weights[: len(q.weights)] == pytest.approx(q.weights)
        assert np.ptp(made.curve) == pytest.approx(np.ptp(q.curve))
    assert np.array_equal(picture(morph(A, B, 0.0), (16, 16)), picture(A, (16, 16)))


def test_the_middle_of_a_morph() -> None:
    made = morph(A, B, 0.5)
    turn = [Rotation.from_matrix(np.reshape(x.axes, (3, 3))) for x in (A, made, faced(B, A))]
    # Half of the angle between the two, about one axis.
    angle = (turn[0].inv() * turn[2]).magnitude()
    assert (turn[0].inv() * turn[1]).magnitude() == pytest.approx(angle / 2, abs=1e-6)
    assert (turn[1].inv() * turn[2]).magnitude() == pytest.approx(angle / 2, abs=1e-6)
    assert mean_colour(made) == pytest.approx((mean_colour(A) + mean_colour(B)) / 2, abs=1e-6)
    for p, m, q in zip(A.channels, made.channels, faced(B, A).channels, strict=True):
        assert np.diff(m.curve) == pytest.approx(np.diff((np.array(p.curve) + q.curve) / 2), abs=1e-9)
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


def lobed(frequencies: tuple[float, ...], seed: int = 0) -> ColourTexture:
    lobes = tuple(Lobe(frequency=f, angle=0.3, bandwidth=0.02, variance=1.0 / len(frequencies)) for f in frequencies)
    curve = tuple(np.linspace(0.1, 0.9, 10).tolist())
    moving, still = ColourChannel(weights=(), lobes=lobes, curve=curve), ColourChannel(weights=(0.0,), curve=(0.0,) * 10)
    return ColourTexture(channels=(moving, still, still), texels=(64, 64), seed=seed)


def test_lobes_are_edited_by_the_band_of_their_frequency() -> None:
    made = edit(lobed((0.3, 0.2, 0.1, 0.01)), {0: 2.0, 2: 0.0}).channels[0].lobes
    # Wavelengths of 3.3, 5, 10 and 100 texels: bands 0, 1, 2 and the last.
    assert [lobe.variance for lobe in made] == pytest.approx([1.0, 0.25, 0.0, 0.25])
    with pytest.raises(InputError, match="without any band"):
        edit(lobed((0.3,)), {0: 0.0})


def test_lobes_are_morphed_by_their_variances() -> None:
    made = morph(lobed((0.3,)), lobed((0.1,)), 0.25).channels[0].lobes
    assert [(lobe.frequency, lobe.variance) for lobe in made] == [(0.3, 0.75), (0.1, 0.25)]
    assert morph(lobed((0.3,)), lobed((0.1,)), 1.0).channels[1].weights == (0.0,)


def test_axes_face_the_nearer_way() -> None:
    turned = A.model_copy(update={
        "axes": tuple(v * s for v, s in zip(A.axes, (-1,) * 6 + (1,) * 3, strict=True)),
        "channels": tuple(
            c.model_copy(update={"curve": tuple(-v for v in reversed(c.curve))}) if i < 2 else c for i, c in enumerate(A.channels)
        ),
    })  # fmt: skip
    assert np.allclose(faced(turned, A).axes, A.axes)
    assert mean_colour(turned) == pytest.approx(mean_colour(A), abs=1e-6)
    assert morph(A, turned, 0.5).axes == pytest.approx(A.axes)
