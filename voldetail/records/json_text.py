"""Versioned JSON that people can read: what the files of this package have in common."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Callable, Mapping
from typing import Any

from voldetail.errors import InputError
from voldetail.records.refusal import shown

SIGNIFICANT_DIGITS = 7  # a float32 has seven: the noise and the renderer work in float32

Migration = Callable[[dict[str, Any]], dict[str, Any]]
_NUMBERS = re.compile(r'\[\n\s*([^\[\]{}"]*?)\n\s*\]')


def json_text(data: Any) -> str:
    """The text of `data`, numbers to 7 significant digits, a list of numbers on one line; ValueError for NaN and infinities."""
    text = json.dumps(_rounded(data), indent=2, ensure_ascii=False, allow_nan=False)
    # A string cannot match: JSON writes its line breaks as \n.
    return _NUMBERS.sub(lambda m: "[" + re.sub(r",\n\s*", ", ", m.group(1)) + "]", text) + "\n"


def parsed(text: str, where: str, what: str) -> dict[str, Any]:
    """The table in the JSON `text`; errors (InputError) start with `where`, and say that it is no `what`."""

    def once(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
        table: dict[str, Any] = {}
        for key, value in pairs:
            if key in table:
                raise InputError(f"{where} has the key {shown(key)} twice; leave one.")
            table[key] = value
        return table

    def finite(number: str) -> float:
        value = float(number)
        if not math.isfinite(value):
            raise InputError(f"{where} holds {shown(number)}, which is not a finite number.")
        return value

    try:
        data = json.loads(text, object_pairs_hook=once, parse_float=finite, parse_constant=finite)
    except json.JSONDecodeError as error:
        at = f"line {error.lineno}, column {error.colno}"
        raise InputError(f"{where} is not valid JSON: {error.msg} in {at}.") from None
    except (ValueError, RecursionError):
        raise InputError(f"{where} holds a value that is too large or too deeply nested.") from None
    if not isinstance(data, dict):
        raise InputError(f"{where} is not a {what}: it holds {shown(data)} and not a table.")
    return data


def of_format(data: dict[str, Any], name: str, where: str, what: str) -> None:
    """Raise InputError unless the table's "format" is `name`."""
    if data.get("format") != name:
        found = shown(data.get("format"))
        raise InputError(f'{where} is not a {what}: its "format" is {found}, not "{name}".')


def migrated(data: dict[str, Any], newest: int, migrations: Mapping[int, Migration], where: str) -> dict[str, Any]:
    """`data` brought to version `newest`, entry n of `migrations` from version n to n + 1; its "format" is kept.

    Raises InputError, which starts with `where`, for a version that is missing, too old or too new.
    """
    version = data.get("version")
    if not isinstance(version, int) or isinstance(version, bool):
        raise InputError(f'{where} has no usable "version": {shown(version)}; allowed: 1 to {newest}.')
    if version > newest:
        raise InputError(
            f"{where} has version {shown(version)}, made by a newer voldetail: update (this one reads up to version {newest})."
        )
    kind = data.get("format")
    for step in range(version, newest):
        if step not in migrations:
            raise InputError(
                f"{where} has version {shown(version)}, which this voldetail cannot read;"
                f" it reads {min([*migrations, newest])} to {newest}."
            )
        data = {**migrations[step](data), "version": step + 1}
    return {**data, "format": kind}


def _rounded(value: Any) -> Any:
    if isinstance(value, float):
        return float(f"{value:.{SIGNIFICANT_DIGITS}g}")
    if isinstance(value, dict):
        return {k: _rounded(v) for k, v in value.items()}
    if isinstance(value, (list, tuple)):
        return [_rounded(v) for v in value]
    return value
