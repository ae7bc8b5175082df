"""The parameters are declared once, and everything that is said about them comes from there."""

import math
from itertools import pairwise

import pytest
from pydantic import BaseModel

from voldetail.detail import (
    MONOTONE_CURVES,
    PARAMETERS,
    START_CURVES,
    Detail,
    MediumParameters,
    NoiseParameters,
    Reflectance,
    ReliefParameters,
    bounds,
    describe_in_words,
    parameter,
    schema,
    summary,
    values_of,
    with_values,
)
from voldetail.detail.words import MEDIUM_HAS_NONE
from voldetail.errors import InputError

GROUPS: dict[str, type[BaseModel]] = {
    "noise": NoiseParameters,
    "relief": ReliefParameters,
    "reflectance": Reflectance,
    "medium": MediumParameters,
}


def test_every_field_is_declared_and_every_declaration_is_a_field() -> None:
    fields = [f"{group}.{name}" for group, model in GROUPS.items() for name in model.model_fields]
    assert fields == [p.key for p in PARAMETERS]


@pytest.mark.parametrize("key", [p.key for p in PARAMETERS])
def test_schema_carries_sentence_unit_and_bounds(key: str) -> None:
    group, name = key.split(".")
    declaration = parameter(key)
    entry = schema()["$defs"][GROUPS[group].__name__]["properties"][name]
    assert entry["description"] == declaration.sentence
    assert entry["description"].endswith(".")
    assert entry["unit"] == (declaration.unit or "none")
    assert entry["default"] == (list(declaration.default) if declaration.count > 1 else declaration.default)
    if declaration.scale == "choice":
        assert entry["enum"] == list(declaration.choices)
        return
    limited = entry["items"] if declaration.count > 1 else entry
    assert (limited["minimum"], limited["maximum"]) == bounds(key)
    if declaration.count > 1:
        assert entry["minItems"] == entry["maxItems"] == declaration.count


def test_schema_describes_every_property_and_names_the_format() -> None:
    made = schema()
    assert made["properties"]["format"]["const"] == "voldetail.detail"
    assert {"format", "version", "noise", "relief", "reflectance"} <= set(made["required"])
    records = [made, *(d for d in made["$defs"].values() if "properties" in d)]
    missing = [name for r in records for name, entry in r["properties"].items() if not entry.get("description")]
    assert missing == []


@pytest.mark.parametrize("key", [p.key for p in PARAMETERS if p.scale not in ("choice", "integer") and p.count == 1])
def test_bounds_are_inclusive_and_beyond_them_is_refused(key: str) -> None:
    low, high = bounds(key)
    for value in (low, high):
        assert values_of(with_values(Detail(), {key: value}))[key] == value
    step = (high - low) * 1e-3
    for value in (low - step, high + step, math.nan, math.inf):
        with pytest.raises(InputError, match=key.replace(".", r"\.")):
            with_values(Detail(), {key: value})


def test_log_parameters_can_be_searched_on_a_log_scale() -> None:
    assert [p.key for p in PARAMETERS if p.scale == "log" and not p.lower > 0] == []


def test_unknown_keys_name_the_nearest() -> None:
    with pytest.raises(InputError, match=r"nearest one is noise\.scale"):
        bounds("noise.scael")
    with pytest.raises(InputError, match="one of solid, surface"):
        bounds("noise.domain")


def test_start_curves() -> None:
    for name, curve in START_CURVES.items():
        assert len(curve) == 11, name
        assert 0 <= min(curve) < max(curve) <= 1, name
        rising = all(a <= b for a, b in pairwise(curve))
        assert rising == (name in MONOTONE_CURVES), name
        assert NoiseParameters(curve=curve).curve == curve
    assert list(START_CURVES)[: len(MONOTONE_CURVES)] == list(MONOTONE_CURVES)
    assert len(set(START_CURVES.values())) == len(START_CURVES)
    # Values worked out by hand at t = -0.6, that is (t + 1) / 2 = 0.2.
    expected = {
        "linear": 0.2,
        "square": 0.04,
        "root": 0.4472136,
        "smoothstep": 0.104,
        "step": 0.0,
        "ramp": 0.0,
        "plateau": 0.4,
        "billow": 0.6,
        "ridge": 0.4,
    }
    assert {name: curve[2] for name, curve in START_CURVES.items()} == pytest.approx(expected, abs=1e-7)


def test_words_cover_all_parameters_in_people_s_units() -> None:
    detail = with_values(Detail(), {"noise.angle": math.pi / 4, "noise.scale": 12.5})
    rows = {label: (value, unit, sentence) for label, value, unit, sentence in describe_in_words(detail)}
    assert len(rows) == len([p for p in PARAMETERS if not p.key.startswith("medium.")])
    cloud = with_values(Detail(), {"medium.thickness": 0.25})
    assert len(describe_in_words(cloud)) == len(PARAMETERS) - len(MEDIUM_HAS_NONE)
    assert "Extinction" in {row[0] for row in describe_in_words(cloud)}
    assert rows["Angle"][:2] == ("45.0", "degrees")
    assert rows["Scale"] == ("12.5", "cells per scene unit", parameter("noise.scale").sentence)


def test_summary_tells_stretch_across_the_dense_axis_and_gloss() -> None:
    dull = summary(Detail())
    assert "matte" in dull
    assert "stretched" not in dull
    values = {"noise.anisotropy": 2.0, "noise.angle": 0.0, "reflectance.specular": 0.4}
    bright = summary(with_values(Detail(), values))
    assert "stretched 2 times along 90 degrees" in bright
    assert "glossy (shininess 30)" in bright
    reverse = summary(with_values(Detail(), {"noise.anisotropy": 0.5, "noise.angle": 0.0}))
    assert "stretched 2 times along 0 degrees" in reverse


def test_plates_are_called_plates() -> None:
    raised = summary(with_values(Detail(), {"noise.cell_height": 1.0}))
    assert "scene units across, broken into plates, raised by" in raised
    assert "plates" in summary(with_values(Detail(), {"noise.cell_tilt": 1.0}))
    # Without cells there is nothing to raise.
    assert "plates" not in summary(with_values(Detail(), {"noise.cell_height": 1.0, "noise.last_neighbour": 50}))
    assert "plates" not in summary(Detail())


def test_stones_are_called_stones() -> None:
    stones = {"noise.joining": "highest", "noise.last_neighbour": 50, "noise.scale": 20.0, "noise.octaves": 1}
    angular = summary(with_values(Detail(), stones | {"noise.facets": 0.9}))
    assert angular.startswith("angular stones about 0.05 scene units across")
    rough = summary(with_values(Detail(), stones | {"noise.octaves": 2}))
    assert rough.startswith("round stones about 0.05 scene units across, roughened by 1 finer octave")
