"""The texture file: a round trip, and one sentence for each thing that is wrong."""

import json
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from voldetail.detail.colour import ColourChannel, ColourTexture, Lobe
from voldetail.detail.texture_file import load_texture, save_texture, texture_from_text, texture_to_text
from voldetail.errors import InputError

CURVE = (0.1, 0.2, 0.25, 0.3, 0.35, 0.4, 0.5, 0.6, 0.7, 0.9)
BANDS = ColourChannel(weights=(0.5, 0.25, 0.0), curve=CURVE)
LOBES = ColourChannel(weights=(), lobes=(Lobe(frequency=0.1, angle=0.5, bandwidth=0.02, variance=1.5),), curve=CURVE)
TEXTURE = ColourTexture(name="Stein", seed=7, channels=(BANDS, BANDS, LOBES), texels=(64, 32), photo="stein.png")


def changed(**changes: Any) -> str:
    return json.dumps({**json.loads(texture_to_text(TEXTURE)), **changes})


def with_channel(**changes: Any) -> str:
    data = json.loads(texture_to_text(TEXTURE))
    data["channels"][0] |= changes
    return json.dumps({**data, "channels": [{k: v for k, v in c.items() if v is not None} for c in data["channels"]]})


def test_round_trip(tmp_path: Path) -> None:
    save_texture(tmp_path / "t.json", TEXTURE)
    assert load_texture(tmp_path / "t.json") == TEXTURE
    text = (tmp_path / "t.json").read_text()
    assert text.startswith('{\n  "format": "voldetail.texture",\n  "version": 1,')
    assert '"weights": [0.5, 0.25, 0.0]' in text  # a list of numbers is on one line
    assert max(map(len, text.splitlines())) < 130


numbers = st.floats(min_value=0, max_value=1e4, allow_nan=False)


curves = st.lists(st.floats(-1e3, 1e3), min_size=10, max_size=10)


@given(st.lists(numbers, min_size=1, max_size=14), curves, st.text(min_size=1, max_size=50))
def test_any_texture_comes_back_to_seven_digits(weights: list[float], curve: list[float], name: str) -> None:
    channel = ColourChannel(weights=tuple(weights), curve=tuple(sorted(curve)))
    texture = ColourTexture(name=name, channels=(channel, BANDS, BANDS), texels=(3, 4))
    text = texture_to_text(texture)
    again = texture_from_text(text)
    assert texture_to_text(again) == text
    assert again.name == name
    assert again.channels[0].weights == pytest.approx(texture.channels[0].weights, rel=1e-6)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", ["T is not valid JSON"]),
        ("[1]", ["T is not a texture file", "not a table"]),
        ("{}", ['"format"', "voldetail.texture"]),
        (changed(format="voldetail.detail"), ["T is not a texture file", "voldetail.detail"]),
        (changed(version=2), ["newer voldetail"]),
        (changed(version="1"), ["no usable"]),
        (changed(seed=-1), ["seed = -1", "out of range", "at least 0"]),
        (changed(seed="7"), ["seed", "wrong kind"]),
        (changed(colour=1), ["no setting colour"]),
        (changed(axes=[1.0] * 9), ["no rotation"]),
        (changed(channels=[]), ["channels"]),
        (with_channel(weights=[0.5, -0.25]), ["channels[0].weights[1] = -0.25", "out of range"]),
        (with_channel(weights=None), ["channels[0].weights is missing"]),
        (with_channel(weights=[1.0, -0.5]), ["channels[0].weights[1] = -0.5", "at least 0 and at most 10000"]),
        (with_channel(weights=[]), ["either the weights of bands or lobes"]),
        (with_channel(weights=[1.0] * 15), ["channels[0].weights", "wrong length"]),
        (with_channel(curve=CURVE[::-1]), ["the curve decreases"]),
        (with_channel(curve=CURVE[:9]), ["channels[0].curve", "wrong length"]),
        (changed(texels=[1e999, 1]).replace("Infinity", "1e999"), ["not a finite number"]),
    ],
)
def test_what_is_wrong_is_said(text: str, words: list[str]) -> None:
    with pytest.raises(InputError) as caught:
        texture_from_text(text, where="T")
    sentence = str(caught.value)
    assert sentence.startswith("T")
    assert sentence.endswith(".")
    assert "\n" not in sentence
    for word in words:
        assert word in sentence


@given(st.text(max_size=200))
def test_any_text_is_refused_in_a_sentence(text: str) -> None:
    with pytest.raises(InputError):
        texture_from_text(text)


def test_a_missing_file(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"texture file .* does not exist"):
        load_texture(tmp_path / "none.json")
