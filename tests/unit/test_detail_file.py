"""The detail file: round trips, versions, and refusals in one sentence."""

import json
import math
from pathlib import Path
from typing import Any

import pytest

from voldetail.detail import (
    ALLOWED_NEIGHBOURS,
    PAPER_NEIGHBOURS,
    Detail,
    Provenance,
    detail_from,
    detail_from_text,
    detail_to_text,
    load_detail,
    rounded,
    save_detail,
    with_values,
)
from voldetail.detail.file import MIGRATIONS
from voldetail.detail.record import DETAIL_VERSION
from voldetail.errors import InputError
from voldetail.records.reading import LARGEST_FILE

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


def test_save_and_load_through_a_file(tmp_path: Path) -> None:
    path = tmp_path / "wall.json"
    detail = rounded(Detail(name="wall", seed=7, provenance=PROVENANCE))
    save_detail(path, detail)
    assert load_detail(path) == detail
    assert load_detail(str(path)) == detail
    before = path.read_bytes()
    save_detail(path, load_detail(path))
    assert path.read_bytes() == before
    assert [p.name for p in tmp_path.iterdir()] == ["wall.json"]


def test_file_is_readable_by_people() -> None:
    text = detail_to_text(Detail(provenance=PROVENANCE))
    lines = text.splitlines()
    assert '    "curve": [0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0]' in lines
    assert '    "seconds": 41.23457,' in lines
    assert json.loads(text)["provenance"]["settings"] == PROVENANCE.settings
    assert text.endswith("}\n")


def test_pi_survives_rounding() -> None:
    detail = with_values(Detail(), {"noise.angle": math.pi, "noise.stripe_spread": math.pi})
    assert rounded(detail).noise.angle == 3.141593


def test_neighbours() -> None:
    assert set(PAPER_NEIGHBOURS) <= set(ALLOWED_NEIGHBOURS)
    for k, k2 in ALLOWED_NEIGHBOURS:
        assert 1 <= k <= k2
        assert k2 <= 3 or (k, k2) == (1, 50)
    for pair in ((3, 2), (2, 50), (1, 4), (50, 50)):
        with pytest.raises(InputError, match="neighbours"):
            with_values(Detail(), {"noise.first_neighbour": pair[0], "noise.last_neighbour": pair[1]})


def test_records_are_frozen() -> None:
    with pytest.raises(ValueError, match="frozen"):
        Detail().noise.scale = 3.0


def changed(key: str, value: Any) -> str:
    data = json.loads(detail_to_text(Detail(provenance=PROVENANCE)))
    *groups, last = key.split(".")
    table = data
    for group in groups:
        table = table[group]
    if value is KeyError:
        del table[last]
    else:
        table[last] = value
    return json.dumps(data)


@pytest.mark.parametrize(
    ("key", "value", "says"),
    [
        ("noise.scale", 900, "noise.scale = 900 is out of range; allowed: 0.2 to 400 cells per scene unit"),
        ("noise.scale", "9", "noise.scale = '9' is of the wrong kind"),
        ("noise.scale", None, "noise.scale = None is of the wrong kind"),
        ("noise.scale", KeyError, "noise.scale is missing; allowed: 0.2 to 400"),
        ("noise.scal", 9, "no setting noise.scal; the nearest one is scale"),
        ("noise.octaves", 2.5, "noise.octaves = 2.5 is of the wrong kind; allowed: a whole number, 1 to 8"),
        ("noise.octaves", True, "noise.octaves = True is of the wrong kind"),
        ("noise.curve", [0.5] * 10, "noise.curve"),
        ("noise.curve", [0.5] * 10 + [1.5], "noise.curve[10] = 1.5 is out of range"),
        ("noise.domain", "soild", "noise.domain = 'soild' is not known; allowed: one of solid, surface"),
        ("reflectance.tint", [1, 0, 0], "luminance is 0.2126"),
        ("reflectance.shininess", 0, "allowed: 1 to 1000"),
        ("noise", 3, "noise = 3 is of the wrong kind"),
        ("relief", KeyError, "relief is missing"),
        ("relief.amplitude", -0.1, "allowed: 0 to 1 scene units"),
        ("paint", 1, "no setting paint"),
        ("seed", -1, "seed = -1 is out of range"),
        ("seed", 2**32, "out of range"),
        ("provenance.created", "yesterday", "not an ISO 8601 date"),
        ("provenance.photo_sha256", "abc", "provenance.photo_sha256"),
        ("provenance.zone", [1, 2], "provenance.zone[2] is missing; allowed: four whole numbers"),
        ("version", 2, "version 2, made by a newer voldetail: update"),
        ("version", 0, "version 0, which this voldetail cannot read"),
        ("version", -1, "version -1, which this voldetail cannot read"),
        ("version", "1", 'no usable "version"'),
        ("version", True, 'no usable "version"'),
        ("version", KeyError, 'no usable "version"'),
        ("format", "other", "not a detail file"),
        ("format", KeyError, "not a detail file"),
    ],
)
def test_refusals_name_file_key_value_and_what_is_allowed(key: str, value: Any, says: str) -> None:
    with pytest.raises(InputError) as refused:
        detail_from_text(changed(key, value), where="wall.json")
    message = str(refused.value)
    assert message.startswith("wall.json")
    assert says in message
    assert "\n" not in message


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("", "not valid JSON"),
        ("{", "not valid JSON"),
        ("[1, 2]", "not a table"),
        ("{" + '"a": 1, "a": 2}', "key 'a' twice"),
        ('{"a": NaN}', "'nan'"),
        ('{"a": -Infinity}', "not a finite number"),
        ('{"a": 1e999}', "not a finite number"),
        ('{"a": ' + "9" * 5000 + "}", "too large"),
        ("[" * 200_000, "too deeply nested"),
    ],
)
def test_broken_json(text: str, says: str) -> None:
    with pytest.raises(InputError) as refused:
        detail_from_text(text, where="wall.json")
    assert says.lower() in str(refused.value).lower()


def test_infinity_in_a_setting_is_not_written(tmp_path: Path) -> None:
    bad = Detail(provenance=PROVENANCE.model_copy(update={"settings": {"limit": math.inf}}))
    with pytest.raises(InputError, match="not finite"):
        save_detail(tmp_path / "wall.json", bad)
    assert list(tmp_path.iterdir()) == []


def test_files_that_cannot_be_read(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="does not exist"):
        load_detail(tmp_path / "none.json")
    with pytest.raises(InputError, match="folder"):
        load_detail(tmp_path)
    with pytest.raises(InputError, match="detail file"):
        load_detail("a\0b")
    large = tmp_path / "large.json"
    large.write_text(detail_to_text(Detail()) + " " * LARGEST_FILE)
    with pytest.raises(InputError, match="MB"):
        load_detail(large)
    binary = tmp_path / "binary.json"
    binary.write_bytes(b"\xff\xfe\x00")
    with pytest.raises(InputError, match="not UTF-8"):
        load_detail(binary)
    marked = tmp_path / "marked.json"
    marked.write_text("\ufeff" + detail_to_text(Detail()), encoding="utf-8")
    assert load_detail(marked) == Detail()


def test_an_older_version_is_migrated_step_by_step(monkeypatch: pytest.MonkeyPatch) -> None:
    def from_zero(data: dict[str, Any]) -> dict[str, Any]:
        data["noise"]["scale"] = data["noise"].pop("frequency")
        return data

    old = json.loads(detail_to_text(Detail()))
    old["version"] = 0
    old["noise"]["frequency"] = old["noise"].pop("scale") * 2
    monkeypatch.setitem(MIGRATIONS, 0, from_zero)
    migrated = detail_from_text(json.dumps(old))
    assert migrated.noise.scale == 20
    assert migrated.version == DETAIL_VERSION == 1


def test_a_migration_does_not_skip_a_missing_step(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(MIGRATIONS, -2, dict)
    with pytest.raises(InputError, match="cannot read"):
        detail_from_text(changed("version", -2))


def test_python_callers_get_the_same_refusal() -> None:
    with pytest.raises(InputError, match=r"The detail: noise\.scale = 900 is out of range"):
        detail_from({"noise": {"scale": 900}})
    with pytest.raises(InputError, match=r"nearest one is relief\.amplitude"):
        with_values(Detail(), {"relief.amplitud": 0.1})


@pytest.mark.parametrize("key", ["noise.cell_height", "noise.cell_tilt", "noise.bevel"])
def test_a_file_from_before_plates_is_one_without(key: str) -> None:
    detail = Detail(seed=3)
    text = json.loads(detail_to_text(detail))
    del text["noise"][key.split(".")[1]]
    assert detail_from_text(json.dumps(text)) == detail


def test_a_file_without_mode_and_medium_is_a_displacement() -> None:
    data = json.loads(detail_to_text(Detail()))
    assert "medium" not in data
    del data["mode"]
    assert detail_from_text(json.dumps(data)) == Detail()


def test_a_medium_comes_back_and_is_whole_or_refused() -> None:
    cloud = with_values(Detail(seed=4), {"medium.extinction": 12.5, "medium.asymmetry": 0.8})
    assert cloud.mode == "volume"
    data = json.loads(detail_to_text(cloud))
    assert detail_from_text(json.dumps(data)) == cloud
    del data["medium"]["albedo"]
    with pytest.raises(InputError, match=r"medium\.albedo is missing; allowed: 0 to 1"):
        detail_from_text(json.dumps(data))


@pytest.mark.parametrize(
    ("values", "words"),
    [
        ({"mode": "displacement"}, 'a medium needs the mode "volume"'),
        ({"noise": {"domain": "surface"}}, 'set noise.domain to "solid"'),
        ({"reflectance": {"speckle": 0.2}}, "set reflectance.speckle to 0"),
        ({"reflectance": {"specular": 0.02}}, "set reflectance.specular to 0"),
        ({"medium": {"extinction": 0.0}}, r"medium\.extinction = 0.0 is out of range"),
    ],
)
def test_what_a_volume_cannot_be_is_refused_in_a_sentence(values: dict[str, Any], words: str) -> None:
    data = json.loads(detail_to_text(with_values(Detail(), {"medium.extinction": 12.5})))
    for key, value in values.items():
        data[key] = data[key] | value if isinstance(value, dict) else value
    with pytest.raises(InputError, match=words):
        detail_from_text(json.dumps(data))
