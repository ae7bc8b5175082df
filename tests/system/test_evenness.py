"""Whether a photo is even, what is said of one that is not, and fits to an even picture of it."""

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter

from voldetail.cli import main
from voldetail.detail import load_detail
from voldetail.errors import InputError
from voldetail.fit.evenness import evened, unevenness, warning
from voldetail.fit.target import make_target
from voldetail.fit.zone import around
from voldetail.image import Photo, luminance, save_image
from voldetail.results import EVEN_ENOUGH
from voldetail.setup.file import setup_from
from voldetail.setup.light import Light
from voldetail.setup.photo import PhotoSetup
from voldetail.setup.setup import Setup

SIDE = 128
ALL = np.ones((SIDE, SIDE), bool)


def grain(seed: int = 0, side: int = SIDE) -> NDArray[np.float32]:
    """Even grain of a few pixels, grey, linear."""
    field = gaussian_filter(np.random.default_rng(seed).standard_normal((side, side)), 1.5, mode="wrap")
    level = (0.3 * np.exp(0.3 * field / field.std())).astype(np.float32)
    return np.repeat(level[..., None], 3, axis=2)


def shaded(seed: int = 0, side: int = SIDE) -> NDArray[np.float32]:
    """The same, four times darker towards the right."""
    return (grain(seed, side) * np.geomspace(1.0, 0.25, side, dtype=np.float32)[None, :, None]).astype(np.float32)


def value(pixels: NDArray[np.float32], mask: NDArray[np.bool_] = ALL) -> float:
    found = unevenness(pixels, mask)
    assert found is not None
    return found


def test_even_and_uneven() -> None:
    assert value(grain()) < 0.2
    assert value(shaded()) > EVEN_ENOUGH
    # Brightness and contrast of the photo as a whole do not matter much, nor does which way it darkens.
    assert value(shaded()[:, ::-1]) == pytest.approx(value(shaded()), rel=0.02)
    assert value(shaded() * 0.5) == pytest.approx(value(shaded()), rel=0.15)


def test_what_is_masked_does_not_count() -> None:
    pixels, mask = grain(), ALL.copy()
    pixels[:40, :40] = 0.9
    mask[:40, :40] = False
    assert value(pixels, mask) < 0.2 < value(pixels)


def test_one_colour_has_no_evenness() -> None:
    assert unevenness(np.full((SIDE, SIDE, 3), 0.3, np.float32), ALL) is None
    assert warning(None) == ""


def test_the_warning_is_one_sentence_that_says_what_to_do() -> None:
    said = warning(0.62)
    assert "0.62" in said
    assert "--zone" in said
    assert "--stationarize" in said
    assert said.count(". ") == 0
    assert warning(EVEN_ENOUGH) == ""


def test_evened_is_even_and_made_of_the_photo() -> None:
    made = evened(shaded(), ALL, (96, 96), seed=1)
    assert made.shape == (96, 96, 3)
    assert value(made, np.ones((96, 96), bool)) < 0.7 * value(shaded())
    assert luminance(made).min() >= luminance(shaded()).min() * 0.9
    assert np.array_equal(made, evened(shaded(), ALL, (96, 96), seed=1))


def test_wide_pictures_repeat_a_tile() -> None:
    made = evened(shaded(), ALL, (64, 160), seed=1)
    np.testing.assert_array_equal(made[:, :64], made[:, 64:128])


@pytest.mark.parametrize(
    ("zone", "reach", "expected"),
    [
        ((10, 20, 30, 40), 1.0, (10, 20, 30, 40)), ((50, 50, 20, 20), 3.0, (30, 30, 60, 60)),
        ((0, 90, 20, 10), 3.0, (0, 70, 60, 30)), ((40, 40, 60, 60), 5.0, (0, 0, 100, 100)),
    ],
)  # fmt: skip
def test_around(zone: Any, reach: float, expected: Any) -> None:
    assert around(zone, (100, 100), reach) == expected


def asked(**fields: Any) -> Setup:
    photo = PhotoSetup(path="shaded.png", resolution=64, **fields)
    return Setup(photo=photo, light=Light(direction=(0.5, 0.3, 0.7)))


def test_a_target_is_evened() -> None:
    photo = Photo(shaded(side=192), "ab" * 32)
    as_it_is, even = (make_target(asked(stationarize=s), photo) for s in (False, True))
    assert as_it_is.unevenness == even.unevenness
    assert even.pixels.shape == as_it_is.pixels.shape
    whole = np.ones(even.mask.shape, bool)
    assert value(even.pixels, whole) < value(shaded(side=192)[::3, ::3], np.ones((64, 64), bool))
    assert even.mask.all()


@pytest.mark.parametrize("change", [{"proxy": {"kind": "sphere"}}, {"mode": "volume", "look": "medium"}])
def test_only_flat_surfaces_are_evened(change: dict[str, Any]) -> None:
    data = {"photo": {"path": "a.png", "stationarize": True}, "light": "30,40", **change}
    with pytest.raises(InputError, match="flat surface"):
        setup_from(data, "the setup")


def test_the_command_warns_and_evens(tmp_path: Any, capsys: Any) -> None:
    save_image(tmp_path / "shaded.png", shaded(side=160))
    base = ["fit", str(tmp_path / "shaded.png"), "--light", "30,50", "--evaluations", "20", "--resolution", "64"]
    zone = ["--zone", "0,0,160,160"]
    assert main([*base, *zone, "--colour", "none", "-o", str(tmp_path / "a")]) == 0
    assert "--stationarize" in capsys.readouterr().err
    assert main([*base, *zone, "--colour", "none", "--stationarize", "-o", str(tmp_path / "b")]) == 0
    assert "is uneven" not in capsys.readouterr().err
    made = load_detail(tmp_path / "b" / "detail.json").provenance
    assert made is not None
    assert made.settings["stationarized"] is True
    assert float(made.settings["unevenness"]) > EVEN_ENOUGH  # type: ignore[arg-type]
