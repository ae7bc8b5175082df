"""Words of the command line: what they mean, and the sentence for those that mean nothing."""

from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from voldetail.cli.arguments import angles, mesh, numbers, size, whole_numbers
from voldetail.errors import InputError

KINDS, SUFFIXES = ("plane", "sphere"), (".obj", ".ply")


def any_angle(text: str) -> list[float]:
    return angles(text, "--azimuth", lambda a: abs(a) <= 720, "-720 to 720")


@pytest.mark.parametrize(
    ("text", "found"),
    [
        ("30", [30]),
        ("-15.5", [-15.5]),
        ("0,90, 180", [0, 90, 180]),
        ("0:360:4", [0, 90, 180, 270]),
        ("0:360:1", [0]),
        ("90:-90:3", [90, 30, -30]),
    ],
)
def test_angles(text: str, found: list[float]) -> None:
    assert any_angle(text) == pytest.approx(found)


def test_twelve_steps_go_round_without_the_end() -> None:
    assert any_angle("0:360:12") == [30.0 * i for i in range(12)]


@pytest.mark.parametrize("text", ["", "a", "0:360", "0:360:0", "0:360:1.5", "0:360:-2", "1,,2", "nan", "inf", "0:inf:3"])
def test_angles_that_are_not_understood(text: str) -> None:
    with pytest.raises(InputError, match="START:STOP:COUNT"):
        any_angle(text)


def test_angles_out_of_range() -> None:
    with pytest.raises(InputError, match="has 1000 degrees, out of range; allowed: -720 to 720"):
        any_angle("0,1000")
    with pytest.raises(InputError, match="at most 360"):
        any_angle("0:360:361")


@given(st.text(max_size=20))
def test_any_text_is_angles_or_refused(text: str) -> None:
    try:
        found = any_angle(text)
    except InputError as refused:
        found, sentence = [0.0], str(refused)
    else:
        sentence = ""
    assert "\n" not in sentence
    assert found
    assert all(abs(v) <= 720 for v in found)


@pytest.mark.parametrize(("text", "found"), [("640x480", (640, 480)), (" 16 X 9 ", (16, 9))])
def test_sizes(text: str, found: tuple[int, int]) -> None:
    assert size(text) == found


@pytest.mark.parametrize("text", ["640", "640x", "640x480x3", "-1x5", "1e3x5", "6.5x5", "9999999x1", ""])
def test_sizes_that_are_not_understood(text: str) -> None:
    with pytest.raises(InputError, match="WIDTHxHEIGHT"):
        size(text)


def test_numbers() -> None:
    assert numbers("1,-2.5,1e1", 3, "--rotation", "X,Y,Z") == [1, -2.5, 10]
    assert whole_numbers("1,2", 2, "--zone", "X,Y") == [1, 2]
    for text in ("1,2", "1,2,x", "1,2,nan", "1;2;3"):
        with pytest.raises(InputError, match="--rotation"):
            numbers(text, 3, "--rotation", "X,Y,Z")
    with pytest.raises(InputError, match="fraction"):
        whole_numbers("1,2.5", 2, "--zone", "X,Y")


def test_shapes(tmp_path: Path) -> None:
    rock = tmp_path / "rock.obj"
    rock.write_text("v 0 0 0")
    assert mesh("sphere", KINDS, SUFFIXES) == "sphere"
    assert mesh(str(rock), KINDS, SUFFIXES) == str(rock)
    for text, says in (
        ("shpere", "nearest one is sphere"),
        ("no.obj", "does not exist"),
        ("rock.blend", ".blend"),
    ):
        with pytest.raises(InputError, match=says):
            mesh(text, KINDS, SUFFIXES)
