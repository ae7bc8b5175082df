"""Reading a Setup from a TOML file with overrides, and writing the resolved one."""

from __future__ import annotations

import json
import os
import tomllib
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

from pydantic import ValidationError

from voldetail.detail.record import Record
from voldetail.errors import InputError
from voldetail.records.examples import PREFIX
from voldetail.records.reading import read_small_text
from voldetail.records.refusal import dotted, printable, refusal, shown, worst
from voldetail.setup.light import parse_light
from voldetail.setup.setup import Setup

_PATHS = (("photo", "path"), ("mask",), ("proxy", "mesh"), ("output",))


class Given(NamedTuple):
    """A setting that was given on its own: its key, its value (None: the default), and how a refusal names it."""

    key: tuple[str, ...]
    value: object
    source: str


def load_setup(path: Path | str, overrides: Sequence[str] = (), given: Sequence[Given] = ()) -> Setup:
    """The Setup in the TOML file at `path`, changed by what is `given`, then by `overrides` of the form "key.sub=value".

    Relative paths in the file start at the file's folder, those in overrides at the current one. A value is
    read as TOML or else as text; "key.sub=" with nothing after it brings back the default.
    `light` may be text as on the command line. Raises InputError in one sentence for anything wrong.
    """
    path = Path(path)
    text = read_small_text(path, "setup file")
    return setup_from_text(text, overrides, where=printable(str(path)), folder=path.parent, given=given)


def setup_from_text(
    text: str,
    overrides: Sequence[str] = (),
    *,
    where: str = "The setup",
    folder: Path | None = None,
    given: Sequence[Given] = (),
) -> Setup:
    """The Setup in the TOML `text`, as `load_setup`; relative paths start at `folder` (default: current)."""
    try:
        data = tomllib.loads(text)
    except (ValueError, RecursionError) as error:
        reason = printable(str(error)) if isinstance(error, tomllib.TOMLDecodeError) else "a value is too large or deep"
        raise InputError(f"{where} is not valid TOML: {reason}.") from None
    data = _with_paths(data, folder or Path())
    changed = list(given)
    for override in overrides:
        key, value = _override(override)
        changed.append(Given(key, value, f"{where} with -D {shown(override)}"))
    for one in changed:
        _put(data, one)
    return setup_from(data, where=where, sources={one.key: one.source for one in changed})


def setup_from(data: Mapping[str, Any], where: str = "The setup", sources: Mapping[tuple[str, ...], str] | None = None) -> Setup:
    """The Setup in nested dictionaries; relative paths are relative to the current folder.

    `light` may be text, as for `parse_light`, or a Light. Errors (InputError) start with `where`, or with the
    entry of `sources` for the key that is wrong.
    """
    made = _with_paths(data, Path())
    _read_light(made)
    try:
        # Through JSON, since only there "strict" takes a list for a tuple and still refuses "3" for 3.
        return Setup.model_validate_json(json.dumps(made, default=_plain), strict=True)
    except ValidationError as error:
        loc = worst(error)["loc"]
        near = [text for key, text in (sources or {}).items() if _touch(key, loc)]
        raise InputError(refusal(error, Setup, near[-1] if near else where) + ".") from None
    except (ValueError, RecursionError):
        raise InputError(f"{where} holds a value that is too large or too deeply nested.") from None


def setup_to_toml(setup: Setup) -> str:
    """The TOML text of `setup` with every setting that is not null; `setup_from_text` reads it back equal."""
    data = setup.model_dump(mode="json", exclude_none=True)
    plain = [f"{key} = {_toml(value)}" for key, value in data.items() if not isinstance(value, dict)]
    tables = [
        f"\n[{key}]\n" + "\n".join(f"{k} = {_toml(v)}" for k, v in value.items())
        for key, value in data.items()
        if isinstance(value, dict)
    ]
    return "\n".join([*plain, *tables]) + "\n"


def _plain(value: Any) -> Any:
    """A record (a Light, say) as a table, and what JSON has no word for, such as a TOML date, as text."""
    return value.model_dump(mode="json", exclude_none=True) if isinstance(value, Record) else str(value)


def _touch(key: tuple[str, ...], loc: tuple[int | str, ...]) -> bool:
    return all(a == b for a, b in zip(key, loc, strict=False))


def _toml(value: Any) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        return '"' + "".join(_escaped(c) for c in value) + '"'
    if isinstance(value, list):
        return "[" + ", ".join(map(_toml, value)) + "]"
    return repr(value)  # int, or float with all its digits


def _escaped(character: str) -> str:
    if character in '"\\':
        return "\\" + character
    code = ord(character)
    if 0xD800 <= code <= 0xDFFF:
        raise InputError("A path of the setup has a byte that is not UTF-8 text; rename the file.")
    return f"\\u{code:04x}" if code < 0x20 or code == 0x7F else character


def _override(text: str) -> tuple[tuple[str, ...], Any]:
    """Key and value of "key.sub=value"; the value None stands for "back to the default"."""
    name, equals, value = text.partition("=")
    key = tuple(part.strip() for part in name.split("."))
    if not equals or not all(key):
        raise InputError(f"The override {shown(text)} is not of the form key.sub=value, e.g. photo.resolution=128.")
    value = value.strip()
    if not value:
        return key, None
    try:
        read = tomllib.loads(f"value = {value}")
    except (ValueError, RecursionError):
        return key, value
    made = read["value"]
    # One value only, and a date is text here: there is no setting that is one.
    plain = list(read) == ["value"] and isinstance(made, bool | int | float | str | list | dict)
    return key, made if plain else value


def _put(data: dict[str, Any], given: Given) -> None:
    table, key = data, given.key
    if key[0] == "light" and len(key) > 1:
        _read_light(data)
    for depth, part in enumerate(key[:-1], start=1):
        below = table.setdefault(part, {})
        if not isinstance(below, dict):
            raise InputError(f"{given.source} cannot be used: {dotted(key[:depth])} is a single value.")
        table = below
    if given.value is None:
        table.pop(key[-1], None)
    else:
        table[key[-1]] = given.value


def _read_light(data: dict[str, Any]) -> None:
    """Replace the light's text, if it is text, by its table."""
    if isinstance(data.get("light"), str):
        data["light"] = parse_light(data["light"]).model_dump(mode="json", exclude_none=True)


def _with_paths(data: Mapping[str, Any], folder: Path) -> dict[str, Any]:
    """A copy of `data` in which relative paths are made absolute from `folder`."""
    made = {key: dict(value) if isinstance(value, Mapping) else value for key, value in data.items()}
    for *tables, name in _PATHS:
        table = made.get(tables[0]) if tables else made
        value = table.get(name) if isinstance(table, dict) else None
        text = os.fspath(value) if isinstance(value, str | Path) else ""
        if table is not None and text and not text.startswith(PREFIX):
            table[name] = os.path.abspath(folder / text)
    return made
