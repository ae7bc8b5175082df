"""Whatever a detail file holds, it is read or refused in one sentence; what is saved reads back the same."""

import json
from contextlib import suppress
from pathlib import Path
from typing import Any

import pytest
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st

from voldetail.detail import (
    ALLOWED_NEIGHBOURS,
    PARAMETERS,
    Detail,
    MediumParameters,
    NoiseFloor,
    Provenance,
    detail_from_text,
    detail_to_text,
    load_detail,
    rounded,
    values_of,
    with_values,
)
from voldetail.errors import InputError

PROVENANCE = Provenance(
    voldetail="0.1.0",
    created="2024-05-31",
    photo="wall.jpg",
    photo_sha256="0" * 64,
    zone=(10, 20, 192, 192),
    resolution=192,
    light="70,50",
    proxy="plane",
    solver="default",
    metric="combined",
    evaluations=300,
    seconds=41.23456789,
    distance=0.0723456789,
    mitsuba="3.9.1",
    drjit="1.5.0",
    numpy="2.4.6",
    settings={
        "seeds": 2,
        "bracket": "[\n 1,\n 2\n]",
        "grid": [1.5, 2.0],
        "note": "[ 1, 2 ]",
        "deep": {"a": None},
    },
)


@st.composite
def details(draw: st.DrawFn) -> Detail:
    values: dict[str, Any] = {}
    for p in PARAMETERS:
        number = st.floats(p.lower, p.upper)
        if p.key in ("noise.curve", "noise.weights"):
            values[p.key] = draw(st.tuples(*[number] * p.count))
        elif p.key == "reflectance.tint":
            r, g, b = draw(st.tuples(*[st.floats(0.01, 1)] * 3))
            luminance = 0.2126 * r + 0.7152 * g + 0.0722 * b
            values[p.key] = (r / luminance, g / luminance, b / luminance)
        elif p.scale == "choice":
            values[p.key] = draw(st.sampled_from(p.choices))
        elif p.key == "noise.octaves":
            values[p.key] = draw(st.integers(1, 8))
        elif p.scale != "integer":
            values[p.key] = draw(number)
    pair = draw(st.sampled_from([(1, 50)] if values["noise.joining"] == "highest" else ALLOWED_NEIGHBOURS))
    values["noise.first_neighbour"], values["noise.last_neighbour"] = pair
    mode = draw(st.sampled_from(["displacement", "solid", "medium"]))
    if mode != "displacement":
        values["noise.domain"] = "solid"
    if mode == "medium":
        values |= {f"reflectance.{name}": 0.0 for name in ("specular", "height_albedo", "cell_albedo", "speckle")}
    else:
        values = {key: value for key, value in values.items() if not key.startswith("medium.")}
    made = with_values(Detail(mode="displacement" if mode == "displacement" else "volume"), values)
    extra = {
        "seed": draw(st.integers(0, 2**32 - 1)),
        "name": draw(st.text(st.characters(exclude_categories=["Cs"]), min_size=1, max_size=20)),
        "provenance": draw(st.sampled_from([None, PROVENANCE])),
        "noise_floor": NoiseFloor(other_seed=draw(st.none() | st.floats(0, 1e6))),
    }
    return made.model_copy(update=extra)


@given(details())
@settings(deadline=None, max_examples=60)
def test_round_trip_is_stable_byte_for_byte(detail: Detail) -> None:
    text = detail_to_text(detail)
    loaded = detail_from_text(text)
    assert detail_to_text(loaded) == text
    assert rounded(detail) == loaded
    for key, value in values_of(detail).items():
        if isinstance(value, float):
            assert values_of(loaded)[key] == pytest.approx(value, rel=5.1e-7, abs=1e-300)
        elif not isinstance(value, tuple):
            assert values_of(loaded)[key] == value


def changed(key: str, value: Any) -> str:
    # A medium only where one is changed: with it, other numbers are refused.
    medium = MediumParameters() if key.startswith("medium") else None
    mode = "displacement" if medium is None else "volume"
    data = json.loads(detail_to_text(Detail(provenance=PROVENANCE, mode=mode, medium=medium)))
    *groups, last = key.split(".")
    table = data
    for group in groups:
        table = table[group]
    table[last] = value
    return json.dumps(data)


JSON_VALUES = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(),
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.text(max_size=8), inner, max_size=4),
    max_leaves=12,
)
KEYS = [p.key for p in PARAMETERS] + ["version", "seed", "name", "mode", "noise", "medium", "provenance", "provenance.zone"]


def accepted_or_refused(text: str) -> None:
    try:
        detail = detail_from_text(text)
    except InputError as refused:
        message = str(refused)
    else:
        message = repr(detail)
    assert message.encode()  # whatever was in the file, it can be printed
    assert "\n" not in message


@given(st.text())
@example('{"\\ud800": 1}')
def test_any_text_is_read_or_refused(text: str) -> None:
    accepted_or_refused(text)


@given(st.sampled_from(KEYS), JSON_VALUES)
@example("name", "\ud800")
@example("seed", 10**400)
@example("noise.scale", 10**400)
@example("provenance.zone", [10**400] * 4)
@settings(deadline=None)
def test_any_value_is_read_or_refused(key: str, value: Any) -> None:
    accepted_or_refused(changed(key, value))


@given(st.binary())
@settings(deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_any_bytes_are_read_or_refused(tmp_path: Path, data: bytes) -> None:
    path = tmp_path / "any.json"
    path.write_bytes(data)
    with pytest.raises(InputError):
        load_detail(path)


@given(st.integers(0, 10_000), st.integers(0, 255))
@settings(deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_a_damaged_file_is_read_or_refused(tmp_path: Path, at: int, byte: int) -> None:
    data = bytearray(detail_to_text(Detail(provenance=PROVENANCE)).encode())
    data[at % len(data)] = byte
    path = tmp_path / "damaged.json"
    path.write_bytes(data)
    message = ""
    with suppress(UnicodeDecodeError):
        accepted_or_refused(path.read_text("utf-8-sig"))
    try:
        load_detail(path)
    except InputError as refused:
        message = str(refused)
    assert "\n" not in message
