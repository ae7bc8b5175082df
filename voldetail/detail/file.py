"""The detail file: versioned JSON that people can read and edit."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from voldetail.detail.parameters import GROUPS, PARAMETERS, parameter
from voldetail.detail.record import DETAIL_VERSION, Detail
from voldetail.errors import InputError
from voldetail.files import write_text
from voldetail.records.json_text import Migration, json_text, migrated, of_format, parsed
from voldetail.records.reading import read_small_text
from voldetail.records.refusal import printable, refusal

FORMAT = "voldetail.detail"
_OPTIONAL = "medium"
"""The group that a detail may be without."""

MIGRATIONS: dict[int, Migration] = {}
"""Entry n brings the parsed file of version n to version n + 1; version 1 is the first: none yet."""


def load_detail(path: Path | str) -> Detail:
    """The detail in the JSON file at `path`; older versions are migrated.

    Raises InputError if the file is missing, too large, not JSON or of a newer version, or if it has
    an unknown key, a missing parameter or a value out of range.
    """
    path = Path(path)
    return detail_from_text(read_small_text(path, "detail file"), where=printable(str(path)))


def save_detail(path: Path | str, detail: Detail) -> None:
    """Write `detail` as JSON, numbers to 7 significant digits; the file appears whole or not at all."""
    write_text(Path(path), detail_to_text(detail))


def detail_to_text(detail: Detail) -> str:
    """The text of the detail file; raises InputError if `provenance.settings` holds what JSON cannot."""
    data = {"format": FORMAT, **detail.model_dump(mode="json")}
    for group in ("medium", "colour"):
        if data[group] is None:
            del data[group]  # most details have none, and a reader is not to wonder about it
    for kind in ("texture", "structure"):
        if "colour" in data and data["colour"][kind] is None:
            del data["colour"][kind]
    try:
        return json_text(data)
    except ValueError:
        raise InputError("provenance.settings holds a number that is not finite; leave it out.") from None


def rounded(detail: Detail) -> Detail:
    """`detail` as a file will hold it: a fit that ends with this one can be replayed exactly."""
    return detail_from_text(detail_to_text(detail), where="The detail")


def detail_from_text(text: str, where: str = "The detail") -> Detail:
    """The detail in the JSON `text`; errors (InputError) start with `where`."""
    data = parsed(text, where, "detail file")
    of_format(data, FORMAT, where, "detail file")
    data = migrated(data, DETAIL_VERSION, MIGRATIONS, where)
    del data["format"]
    _refuse_missing(data, where)
    try:
        # Through JSON again, since only there "strict" takes a list for a tuple and still refuses "3" for 3.
        return Detail.model_validate_json(json.dumps(data), strict=True)
    except ValidationError as error:
        raise InputError(refusal(error, Detail, where) + ".") from None
    except (ValueError, RecursionError):
        raise InputError(f"{where} holds a value that is too large or too deeply nested.") from None


def _refuse_missing(data: dict[str, Any], where: str) -> None:
    """Refuse a file that leaves a parameter out, unless it is a later one: the record's defaults are for Python callers."""
    for group in GROUPS:
        if group == _OPTIONAL and data.get(group) is None:
            continue
        names = [p.key.split(".")[1] for p in PARAMETERS if p.key.startswith(group + ".")]
        if group not in data:
            raise InputError(f"{where}: {group} is missing; a detail file has {', '.join(g for g in GROUPS if g != _OPTIONAL)}.")
        given = data[group]
        if not isinstance(given, dict) or set(given) - set(names):
            continue  # of the wrong kind, or with a misspelt key: the record's own refusal tells more
        for name in names:
            if name not in given and not parameter(f"{group}.{name}").later:
                allowed = parameter(f"{group}.{name}").allowed
                raise InputError(f"{where}: {group}.{name} is missing; allowed: {allowed}.")


def schema() -> dict[str, Any]:
    """The JSON schema of the detail file, with a sentence and a unit for each parameter."""
    text = Detail.model_json_schema(mode="serialization")
    form = {"const": FORMAT, "type": "string", "description": "Tells that this is a detail file."}
    text["properties"] = {"format": form, **text["properties"]}
    text["required"] = ["format", "version", *(g for g in GROUPS if g != _OPTIONAL)]
    later = {p.key for p in PARAMETERS if p.later}
    for group, record in GROUPS.items():
        # Defaults are for Python, not for files.
        names = [name for name in record.model_fields if f"{group}.{name}" not in later]
        text["$defs"][record.__name__]["required"] = names
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", **text}
