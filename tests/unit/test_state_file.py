"""The state of a fit on disk: comes back bit by bit, and is refused for anything else."""

import json
import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from voldetail.errors import InputError
from voldetail.fit.candidates import Candidate
from voldetail.fit.session import State
from voldetail.fit.space import Kind, Space
from voldetail.fit.state_file import load_state, save_state
from voldetail.setup.file import setup_from
from voldetail.setup.setup import Setup

SHA = "0123456789abcdef" * 4


def a_setup(**more: Any) -> Setup:
    return setup_from({"photo": {"path": "skimage:gravel"}, "light": "135,45", **more})


def a_state(setup: Setup, seed: int = 0) -> State:
    random = np.random.default_rng(seed)
    space = Space(setup.domain, (1.0, 2.0), 2.0, setup.amplitude)
    pool = []
    for kind in (Kind(1, 2, "gaussian", 2, np.bool_(True)), Kind(2, 3, "exponential", 1, False, "ridge")):  # type: ignore[arg-type]
        vector = random.random(len(space.names(kind))) * 1.2
        root = random.standard_normal((len(vector), len(vector)))
        covariance = root @ root.T + np.eye(len(vector))
        pool.append(Candidate(kind, vector, float(random.random()), 0.1, int(random.integers(100)), covariance))
    pool.append(Candidate(pool[0].kind, pool[0].vector, math.inf))
    return State(2, tuple(pool), 321, 12.345678901234567, ((10, 3.5), (20, 1 / 3)))


def same(a: State, b: State) -> bool:
    return (a.stage, a.evaluations, a.seconds, a.trace) == (
        b.stage,
        b.evaluations,
        b.seconds,
        b.trace,
    ) and all(
        (x.kind, x.value, x.spread, x.spent) == (y.kind, y.value, y.spread, y.spent)
        and np.array_equal(x.vector, y.vector)
        and (x.covariance is y.covariance is None or np.array_equal(x.covariance, y.covariance))  # type: ignore[arg-type]
        for x, y in zip(a.pool, b.pool, strict=True)
    )


def test_kinds_are_written_by_their_first_names(tmp_path: Path) -> None:
    setup, path = a_setup(), tmp_path / "state.json"
    save_state(path, a_state(setup), setup, SHA)
    assert "grains" in json.loads(path.read_text())["pool"][0]["kind"]


@pytest.mark.parametrize("seed", range(5))
def test_comes_back_bit_by_bit(tmp_path: Path, seed: int) -> None:
    setup, path = a_setup(), tmp_path / "state.json"
    save_state(path, a_state(setup, seed), setup, SHA)
    assert same(load_state(path, setup, SHA), a_state(setup, seed))
    assert list(tmp_path.iterdir()) == [path]


def test_an_empty_pool_is_a_state(tmp_path: Path) -> None:
    setup, path = a_setup(), tmp_path / "state.json"
    save_state(path, State(0, (), 0, 0.0), setup, SHA)
    assert load_state(path, setup, SHA) == State(0, (), 0, 0.0)


def test_the_budget_and_the_places_may_change(tmp_path: Path) -> None:
    setup, path = a_setup(), tmp_path / "state.json"
    save_state(path, a_state(setup), setup, SHA)
    other = a_setup(fit={"evaluations": 9000, "time_limit": 3.0}, output="elsewhere")
    assert load_state(path, other, SHA).evaluations == 321


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"light": "136,45"}, "light.direction"),
        ({"seed": 1}, "seed = 0, and now it is 1"),
        ({"fit": {"solver": "paper"}}, "fit.solver = 'default'"),
        ({"amplitude": 0.1}, "amplitude = None"),
        ({"proxy": {"kind": "sphere"}}, "proxy.kind"),
        ({"photo": {"path": "skimage:gravel", "zone": [0, 0, 64, 64]}}, "photo.zone"),
    ],
)
def test_refused_for_another_setup(tmp_path: Path, change: dict[str, Any], says: str) -> None:
    setup, path = a_setup(), tmp_path / "state.json"
    save_state(path, a_state(setup), setup, SHA)
    with pytest.raises(InputError, match="without --resume") as refused:
        load_state(path, a_setup(**change), SHA)
    assert says in str(refused.value)


def test_refused_for_other_files(tmp_path: Path) -> None:
    path, mask = tmp_path / "state.json", tmp_path / "mask.png"
    mask.write_bytes(b"one")
    setup = a_setup(mask=str(mask))
    save_state(path, a_state(setup), setup, SHA)
    load_state(path, setup, SHA)
    with pytest.raises(InputError, match="another photo"):
        load_state(path, setup, "f" * 64)
    mask.write_bytes(b"two")
    with pytest.raises(InputError, match="another mask"):
        load_state(path, setup, SHA)


def _put(*keys: Any, value: Any) -> Callable[[dict[str, Any]], None]:
    def change(data: Any) -> None:
        for key in keys[:-1]:
            data = data[key]
        data[keys[-1]] = value

    return change


@pytest.mark.parametrize(
    "change",
    [
        _put("format", value="voldetail.detail"),
        _put("version", value=2),
        _put("version", value="1"),
        _put("stage", value=-1),
        _put("stage", value=1.5),
        _put("evaluations", value=True),
        _put("surprise", value=1),
        _put("pool", 0, "vector", value=[0.5]),
        _put("pool", 0, "vector", 0, value="0.5"),
        _put("pool", 0, "vector", 0, value=1e300),
        _put("pool", 0, "kind", "first", value=40),
        _put("pool", 0, "kind", "octaves", value=1000),
        _put("pool", 0, "kind", "octaves", value=True),
        _put("pool", 0, "kind", "envelope", value="boxcar"),
        _put("pool", 0, "kind", "fold", value="crumple"),
        _put("pool", 0, "kind", "surprise", value=1),
        _put("pool", 0, "spread", value=0),
        _put("pool", 0, "covariance", value=[[1.0]]),
        _put("pool", 0, "covariance", 0, 0, value=-1.0),
        _put("pool", 0, "covariance", 0, 1, value=1e5),
        _put("pool", 0, "covariance", 0, 0, value=None),
        _put("pool", value={}),
        _put("trace", value=[[1]]),
        _put("belongs", "photo", value="short"),
        _put("belongs", "voldetail", value="0.0.1"),
    ],
)
def test_tampered_files_are_refused(tmp_path: Path, change: Callable[[dict[str, Any]], None]) -> None:
    setup, path = a_setup(), tmp_path / "state.json"
    save_state(path, a_state(setup), setup, SHA)
    data = json.loads(path.read_text())
    change(data)
    path.write_text(json.dumps(data))
    with pytest.raises(InputError) as refused:
        load_state(path, setup, SHA)
    assert "\n" not in str(refused.value)


@pytest.mark.parametrize("text", ["", "{", "[]", "null", "NaN", "[" * 100_000, "9" * 5000, " " * 2**21])
def test_what_is_no_state_is_refused(tmp_path: Path, text: str) -> None:
    path = tmp_path / "state.json"
    path.write_text(text)
    with pytest.raises(InputError):
        load_state(path, a_setup(), SHA)


def test_a_missing_state_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="does not exist"):
        load_state(tmp_path / "state.json", a_setup(), SHA)


@settings(max_examples=60, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(data=st.data())
def test_damage_is_refused_or_harmless(tmp_path: Path, data: st.DataObject) -> None:
    setup, path = a_setup(), tmp_path / "state.json"
    save_state(path, a_state(setup), setup, SHA)
    content = bytearray(path.read_bytes())
    for _ in range(data.draw(st.integers(1, 4))):
        content[data.draw(st.integers(0, len(content) - 1))] = data.draw(st.integers(0, 255))
    path.write_bytes(bytes(content[: data.draw(st.integers(1, len(content)))]))
    try:
        found = load_state(path, setup, SHA)
    except InputError:
        return
    space = Space(setup.domain, (1.0, 2.0), 2.0, setup.amplitude)
    assert all(np.isfinite(c.vector).all() and space.decode(c.kind, c.vector) for c in found.pool)
