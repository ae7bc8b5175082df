"""What is said of a distance."""

import math

import pytest

from voldetail.detail import NoiseFloor
from voldetail.report import verdict

BOTH = NoiseFloor(other_seed=1.0, photo_halves=2.0)


@pytest.mark.parametrize(
    ("distance", "word", "says"),
    [
        (0.0, "as alike", "as near to the photo as the photo's halves are to each other"),
        (2.0, "as alike", "M = 2 (the photo's two halves differ by 2, two seeds of this detail by 1)"),
        (2.1, "close", "close to the photo"),
        (4.1, "alike", "2.0 times as far"),
        (8.1, "no match", "check the light"),
        (math.inf, "no match", "could not be compared"),
    ],
)
def test_words_follow_the_ratio(distance: float, word: str, says: str) -> None:
    found = verdict(distance, BOTH)
    assert found.word == word
    assert says in found.sentence


def test_without_halves_the_seeds_are_the_yardstick() -> None:
    found = verdict(1.5, NoiseFloor(other_seed=1.0))
    assert found.word == "close"
    assert found.ratio == 1.5
    assert "two seeds of the detail" in found.sentence


@pytest.mark.parametrize("floor", [NoiseFloor(), NoiseFloor(other_seed=0.0)])
def test_without_a_yardstick_nothing_is_claimed(floor: NoiseFloor) -> None:
    assert verdict(1.5, floor).word == "not judged"


def test_an_uneven_photo_is_no_yardstick() -> None:
    even, uneven = (verdict(3.0, NoiseFloor(other_seed=1.0, photo_halves=halves)) for halves in (2.5, 3.5))
    assert even.ratio == pytest.approx(1.2)
    assert "uneven" not in even.sentence
    assert uneven.ratio == pytest.approx(3.0)
    assert "uneven" in uneven.sentence
