"""Whatever a setup file or an override holds, it is read or refused; what is written reads back equal."""

import tomllib
from pathlib import Path
from typing import Any

import pytest
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st

from voldetail.errors import InputError
from voldetail.setup.file import (
    load_setup,
    setup_from,
    setup_from_text,
    setup_to_toml,
)
from voldetail.setup.setup import Setup
from voldetail.setup.shapes import SHAPES

SMALL = """
light = "70,50"
[photo]
path = "wall.jpg"
"""
NUMBERS = st.floats(-300, 300)
TEXT = st.text(st.characters(exclude_categories=["Cs"]), min_size=1, max_size=20)


@st.composite
def setups(draw: st.DrawFn) -> dict[str, Any]:
    light = draw(
        st.fixed_dictionaries({"direction": st.tuples(NUMBERS, NUMBERS, st.floats(0.01, 300))})
        | st.fixed_dictionaries({"kind": st.just("point"), "position": st.tuples(NUMBERS, NUMBERS, st.floats(0.01, 300))})
        | st.fixed_dictionaries({"kind": st.just("flash"), "height": st.floats(0.05, 100)})
    )
    kind = draw(st.sampled_from([k for k in SHAPES if k != "mesh"]))
    return {
        "photo": {"path": draw(TEXT), "zone": draw(st.none() | st.tuples(*[st.integers(32, 5000)] * 4))},
        "mask": draw(st.none() | TEXT),
        "proxy": {"kind": kind, "rotation": draw(st.tuples(NUMBERS, NUMBERS, NUMBERS))},
        "light": {**light, "strength": draw(st.floats(1e-9, 1e6))},
        "amplitude": draw(st.none() | st.floats(1e-9, 1)),
        "fit": {"metric": draw(TEXT), "specular": draw(st.booleans())},
        "seed": draw(st.integers(0, 2**32 - 1)),
    }


@given(setups())
@settings(deadline=None)
def test_the_resolved_file_reads_back_equal(data: dict[str, Any]) -> None:
    try:
        setup = setup_from(data)
    except InputError as refused:  # a path may name no scikit-image photo
        assert "skimage:" in str(refused)  # noqa: PT017
        return
    text = setup_to_toml(setup)
    assert tomllib.loads(text)["seed"] == setup.seed
    assert setup_from_text(text) == setup
    assert setup_to_toml(setup_from_text(text)) == text


def accepted_or_refused(text: str, overrides: list[str]) -> None:
    try:
        setup = setup_from_text(text, overrides)
    except InputError as refused:
        message = str(refused)
    else:
        assert isinstance(setup, Setup)
        assert setup_from_text(setup_to_toml(setup)) == setup
        return
    assert message.encode()
    assert "\n" not in message


@given(st.text())
@settings(deadline=None)
def test_any_text_is_read_or_refused(text: str) -> None:
    accepted_or_refused(text, [])


KEYS = [
    "photo",
    "photo.path",
    "photo.zone",
    "mask",
    "proxy",
    "proxy.kind",
    "proxy.size",
    "proxy.mesh",
    "camera.distance",
    "light",
    "light.direction",
    "light.foot",
    "light.kind",
    "amplitude",
    "fit",
    "fit.metric",
    "fit.evaluations",
    "seed",
    "output",
]
VALUES = st.text() | st.floats().map(repr) | st.integers().map(repr) | st.lists(st.integers() | st.floats()).map(repr)


@given(st.sampled_from(KEYS) | st.text(), VALUES)
@example("photo.path", "\ud800")
@example("mask", "\0")
@example("photo.zone", f"[1, 2, {10**400}, 64]")
@example("proxy.size", f"[1, 2, {10**400}]")
@example("seed", "9" * 5000)
@example("seed", "0x" + "f" * 10_000)
@example("light.direction", "[1e308, 1e308, 1e308]")
@example("light.direction", "[5e-324, 0, 5e-324]")
@example("fit", "[" * 100_000)
@settings(deadline=None)
def test_any_override_is_read_or_refused(key: str, value: str) -> None:
    accepted_or_refused(SMALL, [f"{key}={value}"])


@given(st.binary())
@settings(deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_any_bytes_are_refused(tmp_path: Path, data: bytes) -> None:
    path = tmp_path / "any.toml"
    path.write_bytes(data)
    with pytest.raises(InputError):
        load_setup(path)
