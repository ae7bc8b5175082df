"""A running fit on disk: State to and from JSON, so that an interrupted fit can go on.

Nothing is unpickled or evaluated. The file names the inputs that it belongs to by their content (not by their
path, so that a folder can be moved), and is refused for any other.
"""

from __future__ import annotations

import json
import math
from dataclasses import fields
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import Field, JsonValue, ValidationError

from voldetail import __version__
from voldetail.detail.provenance import Record, Sha256
from voldetail.errors import InputError
from voldetail.files import sha256, write_text
from voldetail.fit.candidates import Candidate
from voldetail.fit.profiles import FOLDS
from voldetail.fit.session import State
from voldetail.fit.space import Kind, Space, Vector
from voldetail.records.reading import read_small_text
from voldetail.records.refusal import printable, refusal, shown
from voldetail.setup.setup import Setup

FORMAT = "voldetail.state"
STATE_VERSION: Literal[1] = 1

MOST_CANDIDATES = 10_000  # the paper's whole grid has some thousands
MOST_NUMBERS = 64  # of a candidate; eleven are searched today

# Not part of what a state belongs to: where files lie (their content is), and how long the search may go on.
_FREE = {
    "photo": {"path"},
    "mask": True,
    "proxy": {"mesh"},
    "output": True,
    "fit": {"evaluations", "time_limit"},
}

_Count = Annotated[int, Field(ge=0, le=10**9)]
_Unit = Annotated[float, Field(ge=-1e6, le=1e6)]  # searched in [0, 1], but angles wrap and may have gone round


_Entry = Annotated[float, Field(ge=-1e6, le=1e6)]


_PLAIN: dict[str, type] = {"int": int, "str": str, "bool": bool}  # NumPy's own kinds of number are not JSON


_IN_FILE = {"bordered": "grains"}
"""Fields of a Kind that the file has by another name, their first one."""


class _CandidateRecord(Record):
    kind: dict[str, bool | int | str]
    vector: Annotated[tuple[_Unit, ...], Field(max_length=MOST_NUMBERS)]
    value: float | None  # null: not evaluated yet
    spread: Annotated[float, Field(gt=0, le=10)]
    covariance: tuple[tuple[_Entry, ...], ...] | None = None
    spent: _Count


class _Belongs(Record):
    """What a state belongs to; each is compared on reading."""

    voldetail: str
    photo: Sha256
    mask: Sha256 | None
    mesh: Sha256 | None
    setup: dict[str, JsonValue]


class _StateRecord(Record):
    format: Literal["voldetail.state"]
    version: Literal[1]
    belongs: _Belongs
    stage: Annotated[int, Field(ge=0, le=100)]
    evaluations: _Count
    seconds: Annotated[float, Field(ge=0)]
    pool: Annotated[tuple[_CandidateRecord, ...], Field(max_length=MOST_CANDIDATES)]
    trace: tuple[tuple[_Count, float], ...]
    started: bool = False


def save_state(path: Path, state: State, setup: Setup, photo_sha256: str) -> None:
    """Write ``state`` of a fit of ``setup`` to the JSON file ``path``, whole or not at all.

    ``photo_sha256`` is that of the photo file. Raises InputError where nothing can be written.
    """
    pool = [
        {
            "kind": {_IN_FILE.get(f.name, f.name): _PLAIN[str(f.type)](getattr(c.kind, f.name)) for f in fields(Kind)},
            "vector": np.asarray(c.vector, dtype=float).tolist(),
            "value": float(c.value) if math.isfinite(c.value) else None,
            "spread": float(c.spread),
            "covariance": None if c.covariance is None else np.asarray(c.covariance, dtype=float).tolist(),
            "spent": int(c.spent),
        }
        for c in state.pool
    ]
    data = {
        "format": FORMAT,
        "version": STATE_VERSION,
        "belongs": _belongs(setup, photo_sha256),
        "stage": int(state.stage),
        "evaluations": int(state.evaluations),
        "seconds": float(state.seconds),
        "pool": pool,
        "trace": [[int(count), float(best)] for count, best in state.trace],
        "started": state.started,
    }
    # Python writes each float with the digits that bring back the same bits.
    write_text(path, json.dumps(data, allow_nan=False) + "\n")


def load_state(path: Path, setup: Setup, photo_sha256: str) -> State:
    """Return the State in ``path`` if it belongs to ``setup`` and the photo of ``photo_sha256``.

    Raises InputError if the file is missing, too large, not such a file, of another version, inconsistent, or
    if it belongs to another photo, mask, mesh or setup; the budget of evaluations and time may differ.
    """
    where = printable(str(path))
    text = read_small_text(path, "state file")
    try:
        data = json.loads(text, parse_constant=_no_constant)
    except (ValueError, RecursionError):
        raise InputError(f"{where} is not valid JSON; start again without --resume.") from None
    if not isinstance(data, dict) or data.get("format") != FORMAT:
        raise InputError(f"{where} is not the state of a fit; start again without --resume.")
    if data.get("version") != STATE_VERSION:
        raise InputError(f"{where} was written by another version of voldetail; start again without --resume.")
    try:
        record = _StateRecord.model_validate_json(text, strict=True)
    except ValidationError as error:
        raise InputError(refusal(error, _StateRecord, where) + "; start again without --resume.") from None
    _refuse_other(record.belongs, setup, photo_sha256, where)
    pool = tuple(_candidate(c, setup, where) for c in record.pool)
    trace = tuple((count, best) for count, best in record.trace)
    return State(record.stage, pool, record.evaluations, record.seconds, trace, record.started)


def _belongs(setup: Setup, photo_sha256: str) -> dict[str, Any]:
    return {
        "voldetail": __version__,
        "photo": photo_sha256,
        "mask": sha256(setup.mask) if setup.mask else None,
        "mesh": sha256(setup.proxy.mesh) if setup.proxy.mesh else None,
        "setup": setup.model_dump(mode="json", exclude=_FREE),  # type: ignore[arg-type]
    }


def _refuse_other(belongs: _Belongs, setup: Setup, photo_sha256: str, where: str) -> None:
    """Say what differs between the inputs of a state and the present ones."""
    wanted = _belongs(setup, photo_sha256)
    end = "; give the same as then, or start again without --resume."
    for name in ("photo", "mask", "mesh"):
        if getattr(belongs, name) != wanted[name]:
            raise InputError(f"{where} belongs to a fit with another {name}{end}")
    # Through JSON, where a tuple is a list.
    then, now = _flat(belongs.setup), _flat(json.loads(json.dumps(wanted["setup"])))
    for key in sorted(then.keys() | now.keys()):
        if then.get(key) != now.get(key):
            raise InputError(
                f"{where} belongs to a fit with {printable(key)} = {shown(then.get(key))}, and now it is"
                f" {shown(now.get(key))}{end}"
            )
    if belongs.voldetail != wanted["voldetail"]:
        raise InputError(
            f"{where} was written by voldetail {printable(belongs.voldetail)[:20]}, and the search of this"
            f" {__version__} may differ; start again without --resume."
        )


def _flat(table: dict[str, Any], prefix: str = "") -> dict[str, Any]:
    flat: dict[str, Any] = {}
    for key, value in table.items():
        flat |= _flat(value, f"{prefix}{key}.") if isinstance(value, dict) else {prefix + key: value}
    return flat


def _candidate(record: _CandidateRecord, setup: Setup, where: str) -> Candidate:
    # Strings, since annotations are not evaluated; "bool" is no "int" here.
    names = {_IN_FILE.get(field.name, field.name): field for field in fields(Kind)}
    types = {name: field.type for name, field in names.items()}
    vector = np.array(record.vector, dtype=np.float64)
    try:
        if {name: type(value).__name__ for name, value in record.kind.items()} != types:
            raise ValueError(record.kind)
        kind = Kind(**{names[name].name: value for name, value in record.kind.items()})  # type: ignore[arg-type]
        if kind.fold not in FOLDS:
            raise ValueError(kind.fold)
        # A detail that can be made is one that can be searched. The bounds do not matter here, only that no
        # octave is too fine for the space and so left out before it is checked.
        plain = setup.fit.solver == "paper"
        space = Space(setup.domain, (1.0, 2.0), 1e30, setup.amplitude, plain=plain, mode=setup.mode, medium=setup.medium)
        space.decode(kind, vector)
        covariance = _covariance(record, len(vector))
    except (ValueError, TypeError, OverflowError):
        raise InputError(f"{where} holds a candidate that this setup cannot have; start again without --resume.") from None
    return Candidate(kind, vector, math.inf if record.value is None else record.value, record.spread, record.spent, covariance)


def _covariance(record: _CandidateRecord, count: int) -> Vector | None:
    """Return the covariance of the steps, (count, count); ValueError where it is none."""
    if record.covariance is None:
        return None
    covariance = np.array(record.covariance, dtype=np.float64)
    if covariance.shape != (count, count) or not np.allclose(covariance, covariance.T, rtol=1e-6):
        raise ValueError(covariance.shape)
    if np.linalg.eigvalsh(covariance)[0] <= 0:
        raise ValueError("not positive")
    return covariance


def _no_constant(name: str) -> float:
    raise ValueError(name)
