"""Two tones of a photo, GKHF14 section 3: found again where they were put, and what may be given."""

import numpy as np
import pytest

from voldetail.errors import InputError
from voldetail.image import luminance, to_linear, to_srgb
from voldetail.library import recolour, two_tone

DARK, BRIGHT = np.array([0.2, 0.1, 0.05], np.float32), np.array([0.9, 0.8, 0.3], np.float32)


def structure(seed: int = 0) -> np.ndarray:
    s = np.random.default_rng(seed).random((40, 50)).astype(np.float32)
    s[0, 0], s[1, 1] = 0.0, 1.0
    return s


def test_two_tones_are_found_again_with_their_structure() -> None:
    found = two_tone(recolour(structure(), DARK, BRIGHT))
    assert found.dark == pytest.approx(DARK, abs=2e-4)
    assert found.bright == pytest.approx(BRIGHT, abs=2e-4)
    assert found.structure == pytest.approx(structure(), abs=4e-4)
    assert found.explained == pytest.approx(1.0, abs=1e-5)
    assert found.poor == ""


def test_recolouring_gives_the_photo_back_and_swapping_the_tones_swaps_the_structure() -> None:
    photo = recolour(structure(), DARK, BRIGHT)
    found = two_tone(photo)
    assert recolour(found.structure, found.dark, found.bright) == pytest.approx(photo, abs=1e-3)
    assert recolour(1 - found.structure, found.bright, found.dark) == pytest.approx(photo, abs=1e-3)


def test_the_first_component_is_that_of_a_singular_value_decomposition() -> None:
    rng = np.random.default_rng(2)
    colours = 0.5 + 0.1 * rng.standard_normal((30, 30, 1)) * [0.8, 0.5, 0.3] + 0.02 * rng.standard_normal((30, 30, 3))
    encoded = np.clip(colours, 0, 1).astype(np.float32)
    found = two_tone(to_linear(encoded))
    flat = encoded.reshape(-1, 3).astype(float) - encoded.reshape(-1, 3).mean(axis=0)
    _, values, axes = np.linalg.svd(flat, full_matrices=False)
    direction = (found.bright - found.dark) / np.linalg.norm(found.bright - found.dark)
    assert abs(direction @ axes[0]) == pytest.approx(1, abs=1e-5)
    assert found.explained == pytest.approx(values[0] ** 2 / np.sum(values**2), abs=1e-4)
    places = flat @ direction
    expected = (places - places.min()) / np.ptp(places)
    assert found.structure.ravel() == pytest.approx(expected, abs=1e-3)


def test_tones_outside_the_cube_move_to_its_surface_along_the_line() -> None:
    # Mostly a line that rises to white in red; some pixels, far off it, project beyond the cube.
    s = np.linspace(0, 1, 400).reshape(20, 20)
    encoded = np.stack([0.5 + 0.5 * s, 0.4 + 0.3 * s, 0.3 + 0.3 * s], axis=2)
    encoded[-1, -4:] = [1.0, 1.0, 1.0]
    found = two_tone(to_linear(encoded))
    assert found.bright[0] == pytest.approx(1.0, abs=1e-6)
    assert (found.bright <= 1).all()
    assert (found.dark >= 0).all()
    assert np.sum(found.structure == 1) >= 4
    assert 0 <= found.structure.min() <= found.structure.max() <= 1


def test_the_darker_tone_is_first_by_luminance_and_else_by_channels() -> None:
    found = two_tone(recolour(structure(), BRIGHT, DARK))
    assert luminance(to_linear(found.dark)) < luminance(to_linear(found.bright))
    assert found.structure == pytest.approx(1 - structure(), abs=4e-4)
    red = np.array([0.8, 0.3, 0.3])
    # A green of the same luminance as the red.
    light = float(luminance(to_linear(red)))
    green = to_srgb((light - (0.2126 + 0.0722) * to_linear(np.array([0.3]))) / 0.7152)[0]
    tied = two_tone(recolour(structure(), red, [0.3, green, 0.3]))
    assert tied.dark[0] < tied.bright[0]


def test_a_grey_photo_of_one_channel_has_grey_tones() -> None:
    found = two_tone(to_linear(0.2 + 0.5 * structure()))
    assert found.dark == pytest.approx([0.2] * 3, abs=2e-4)
    assert found.bright == pytest.approx([0.7] * 3, abs=2e-4)


def test_many_colours_are_told() -> None:
    found = two_tone(np.random.default_rng(0).random((32, 32, 3)))
    assert found.explained < 0.5
    assert "more than two tones" in found.poor


def test_only_the_mask_counts_and_specks_may_be_trimmed() -> None:
    photo = recolour(structure(), DARK, BRIGHT)
    photo[:, :10] = np.nan
    mask = np.ones((40, 50), bool)
    mask[:, :10] = False
    found = two_tone(photo, mask)
    assert (found.structure[:, :10] == 0).all()
    assert found.bright == pytest.approx(BRIGHT, abs=5e-3)
    s = 0.3 + 0.2 * structure()
    s[20, 20] = 1.0
    assert two_tone(to_linear(s), trim=0.001).bright[0] == pytest.approx(0.5, abs=0.01)
    assert two_tone(to_linear(s)).bright[0] == pytest.approx(1.0, abs=1e-3)


@pytest.mark.parametrize(
    ("photo", "mask", "trim", "complaint"),
    [
        (np.full((16, 16, 3), 0.5), None, 0.0, "one colour only"),
        (np.full((16, 16, 3), np.nan), None, 0.0, "NaN or infinite"),
        (np.zeros((16, 16, 4)), None, 0.0, "has the shape"),
        (np.zeros(5), None, 0.0, "has the shape"),
        ("stone", None, 0.0, "no array of numbers"),
        (np.zeros((16, 16)), np.ones((4, 4), bool), 0.0, "The mask has the shape"),
        (np.zeros((16, 16)), np.zeros((16, 16), bool), 0.0, "at least 64"),
        (np.zeros((0, 0, 3)), None, 0.0, "at least 64"),
        (np.eye(16), None, 0.7, "The trim is 0.7"),
        (np.eye(16), None, float("nan"), "The trim is nan"),
        (np.eye(100), None, 0.1, "trim less"),
    ],
)
def test_what_cannot_be_used_is_refused(photo: object, mask: np.ndarray | None, trim: float, complaint: str) -> None:
    with pytest.raises(InputError, match=complaint):
        two_tone(photo, mask, trim=trim)  # type: ignore[arg-type]


def test_recolouring_needs_a_map_and_tones() -> None:
    with pytest.raises(InputError, match="three numbers"):
        recolour(structure(), [0.1, 0.2], BRIGHT)
    with pytest.raises(InputError, match="three numbers"):
        recolour(structure(), [0.1, 0.2, np.nan], BRIGHT)
    with pytest.raises(InputError, match="finite"):
        recolour(np.full((4, 4), np.nan), DARK, BRIGHT)
