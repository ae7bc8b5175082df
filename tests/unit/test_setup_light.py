"""The light as text: what it means, and what is refused."""

import math

import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from voldetail.errors import InputError
from voldetail.setup.file import setup_from
from voldetail.setup.light import Light, angles_of, direction_of, light_text, parse_light


@pytest.mark.parametrize(
    ("text", "direction"),
    [
        ("0,45", (math.sqrt(0.5), 0, math.sqrt(0.5))),
        ("90,30", (0, math.sqrt(0.75), 0.5)),
        ("180,60", (-0.5, 0, math.sqrt(0.75))),
        ("-90,30", (0, -math.sqrt(0.75), 0.5)),
        ("123,90", (0, 0, 1)),
        ("0,0,2", (0, 0, 1)),
        (" 3, 0, 4 ", (0.6, 0, 0.8)),
    ],
)
def test_directions(text: str, direction: tuple[float, float, float]) -> None:
    light = parse_light(text)
    assert light.kind == "directional"
    assert light.direction == pytest.approx(direction, abs=1e-15)


def test_flash_and_point() -> None:
    assert parse_light("flash") == Light(kind="flash", foot=None, height=1.0)
    assert parse_light("flash@1.5") == Light(kind="flash", foot=None, height=1.5)
    assert parse_light("flash@0.25,0.75") == Light(kind="flash", foot=(0.25, 0.75), height=1.0)
    assert parse_light("flash@0.25,0.75,2") == Light(kind="flash", foot=(0.25, 0.75), height=2.0)
    assert parse_light(" auto ") == Light(kind="auto")
    assert parse_light("point:1,-2,3") == Light(kind="point", position=(1, -2, 3))


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("", "not understood"),
        ("sun", "not understood"),
        ("flash@", "not understood"),
        ("auto@1", "or auto to have it estimated"),
        ("point:", "not understood"),
        ("1,2,", "not understood"),
        ("45", "has 1 numbers where 2 or 3 are wanted"),
        ("1,2,3,4", "has 4 numbers"),
        ("point:1,2", "has 2 numbers where 3 are wanted"),
        ("spot:1,2,3", "not understood"),
        ("spot:1,2,3@0,0,0", "has 3 numbers where 4 are wanted"),
        ("spot:1,2,3@0,0,0,86", "angle = 86.0 is out of range"),
        ("flash@1,2,3,4", "has 4 numbers where 1 or 2 or 3"),
        ("0,0,0", "zero"),
        ("nan,45", "not finite"),
        ("1,inf,1", "not finite"),
        ("point:0,0,nan", "not finite"),
        ("90,91", "out of range"),
        ("90,-91", "out of range"),
        ("400,45", "out of range"),
        ("flash@1.5,0.5", "foot[0] = 1.5 is out of range"),
        ("flash@0.5,0.5,0", "height = 0.0 is out of range"),
        ("point:0,0,5000", "out of range"),
    ],
)
def test_refusals(text: str, says: str) -> None:
    with pytest.raises(InputError) as refused:
        parse_light(text)
    message = str(refused.value)
    assert says in message
    assert f"The light {text!r}" in message
    assert "\n" not in message


@pytest.mark.parametrize(
    "fields",
    [
        {"kind": "directional"},
        {"kind": "point"},
        {"kind": "spot", "position": (0, 0, 1), "angle": 20},
        {"kind": "point", "position": (0, 0, 1), "target": (0, 0, 0)},
        {"kind": "flash", "direction": (0, 0, 1)},
        {"kind": "directional", "direction": (0, 0, 1), "foot": (0.5, 0.5)},
        {"kind": "point", "position": (0, 0, 1), "direction": (0, 0, 1)},
        {"kind": "auto", "direction": (0, 0, 1)},
        {"kind": "auto", "foot": (0.5, 0.5)},
        {"direction": (0, 0, 1), "strength": 0},
    ],
)
def test_a_light_has_what_its_kind_needs_and_nothing_else(fields: dict[str, object]) -> None:
    with pytest.raises(ValueError, match="validation error"):
        Light.model_validate(fields)


@given(st.floats(0, 359.99), st.floats(0.5, 89.5))
def test_angles_and_direction_are_inverse(azimuth: float, elevation: float) -> None:
    direction = direction_of(azimuth, elevation)
    assert math.hypot(*direction) == pytest.approx(1)
    back = angles_of(direction)
    assert math.cos(math.radians(back[0] - azimuth)) == pytest.approx(1)
    assert back[1] == pytest.approx(elevation)


@pytest.mark.parametrize("text", ["70,50", "auto", "flash@1", "flash@0.25,0.75,2", "point:1,-2,3", "spot:1,-2,3@0,0.5,0,25"])
def test_text_of_a_light_is_what_was_typed(text: str) -> None:
    assert light_text(parse_light(text)) == text


@given(st.text())
@example("9" * 5000)
@example("1e400,1")
@example("\ud800")
@example("flash@\n")
@settings(deadline=None)
def test_any_text_is_a_light_or_refused(text: str) -> None:
    try:
        light = parse_light(text)
    except InputError as refused:
        message = str(refused)
    else:
        message = light_text(light)
    assert message.encode()
    assert "\n" not in message


@pytest.mark.parametrize("text", ["90,0", "90,-10", "0,1,0", "0,1,-1", "point:0,0,-1"])
def test_a_light_from_behind_is_for_a_medium_alone(text: str) -> None:
    light = parse_light(text)
    assert light.behind.startswith("it is behind the surface: z is ")
    medium = {"photo": {"path": "cloud.png"}, "light": text, "mode": "volume", "look": "medium"}
    assert setup_from(medium, "test").light == light
    for fields in ({}, {"mode": "volume"}):
        with pytest.raises(InputError, match="the light cannot be used: it is behind the surface"):
            setup_from({"photo": {"path": "wall.png"}, "light": text, **fields}, "test")
    assert parse_light("90,1").behind == ""
