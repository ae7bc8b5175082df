"""One sentence for the user out of a failed check of a pydantic record."""

from __future__ import annotations

import types
from typing import Annotated, Any, Literal, Union, get_args, get_origin

from pydantic import BaseModel, ValidationError
from pydantic.fields import FieldInfo
from pydantic_core import ErrorDetails

from voldetail.records.nearest import nearest

LONGEST_SHOWN = 60  # characters of a refused value; the sentence has to stay readable

_NOUNS = ((bool, "true or false"), (int, "a whole number"), (float, "a number"))
_OUT_OF_RANGE = {"greater_than", "greater_than_equal", "less_than", "less_than_equal"}
_WRONG_LENGTH = {"too_short", "too_long", "string_too_short", "string_too_long", "string_pattern_mismatch"}


def shown(value: Any) -> str:
    """A short printable form of any value."""
    try:
        text = repr(value)
    except (ValueError, RecursionError):  # an int of over 4300 digits has no decimal form
        text = "a value too long to show"
    return printable(text if len(text) <= LONGEST_SHOWN else text[: LONGEST_SHOWN - 3] + "...")


def printable(text: str) -> str:
    """`text` without line breaks and without characters that a terminal cannot take."""
    return "".join(c if c.isprintable() else c.encode("unicode_escape").decode() for c in text)


def dotted(loc: tuple[int | str, ...]) -> str:
    """A pydantic location as a key: ("noise", "curve", 3) is "noise.curve[3]"."""
    text = ""
    for part in loc:
        text += f"[{part}]" if isinstance(part, int) else (f".{part}" if text else part)
    short = text if len(text) <= LONGEST_SHOWN else text[: LONGEST_SHOWN - 3] + "..."
    return printable(short)


def record_in(annotation: Any) -> type[BaseModel] | None:
    """The record that a field holds (also where it may be None, or a list of them), or None where it holds something else."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return annotation
    if get_origin(annotation) in (Union, types.UnionType):
        return next((m for m in map(record_in, get_args(annotation)) if m), None)
    if get_origin(annotation) is tuple:
        return record_in(get_args(annotation)[0])
    return None


def _find(model: type[BaseModel], loc: tuple[int | str, ...]) -> tuple[type[BaseModel] | None, FieldInfo | None]:
    """The record in which the last name of `loc` was looked up, and its field; None where there is none."""
    here: type[BaseModel] | None = model
    owner, field = here, None
    for part in loc:
        if isinstance(part, int):
            continue  # one of several of the kind that the field holds
        if here is None:
            break
        owner, field = here, here.model_fields.get(part)
        here = record_in(field.annotation) if field else None
    return owner, field


def _allowed(field: FieldInfo | None) -> str:
    """What a field takes, in words; empty where nothing is known."""
    if field is None:
        return ""
    extra = field.json_schema_extra if isinstance(field.json_schema_extra, dict) else {}
    if "allowed" in extra:
        return str(extra["allowed"])
    inner = [a for a in get_args(field.annotation) if a is not type(None)]
    kind = inner[0] if inner and get_origin(field.annotation) is not Literal else field.annotation
    if get_origin(kind) is Literal:
        return "one of " + ", ".join(map(str, get_args(kind)))
    unit = f" {extra['unit']}" if "unit" in extra else ""
    limits = list(field.metadata)
    if get_origin(kind) is Annotated:  # of each number in a list
        kind, *own = get_args(kind)
        limits = [m for one in own for m in getattr(one, "metadata", [one])]
    limit = {name: getattr(m, name) for m in limits for name in ("ge", "gt", "le", "lt") if hasattr(m, name)}
    words = {"gt": "over {:.12g}", "ge": "at least {:.12g}", "lt": "under {:.12g}", "le": "at most {:.12g}"}
    span = " and ".join(words[name].format(limit[name]) for name in words if name in limit)
    noun = next((words for of, words in _NOUNS if kind is of), "")
    if not noun:
        return "a table of settings" if record_in(kind) else "text"
    return " ".join(filter(None, [noun, span])) + unit


def worst(error: ValidationError) -> ErrorDetails:
    """The one thing wrong that is reported: an unknown key before others, since it explains a missing one."""
    found = error.errors(include_url=False)
    return next((e for e in found if e["type"] == "extra_forbidden"), found[0])


def refusal(error: ValidationError, model: type[BaseModel], where: str) -> str:
    """The sentence for the first thing wrong in `error`: where, which key, its value, what is allowed.

    `where` names the file or the argument. An unknown key or word comes with the nearest known one.
    """
    first, count = worst(error), error.error_count()
    loc, kind, key = first["loc"], first["type"], dotted(first["loc"])
    owner, field = _find(model, loc)
    more = f" (and {count - 1} more)" if count > 1 else ""
    allowed = _allowed(field)
    tail = (f"; allowed: {allowed}" if allowed else "") + more
    if kind == "extra_forbidden" and owner is not None:
        near = nearest(str(loc[-1]), list(owner.model_fields))
        return f"{where}: there is no setting {key}; {near}{more}"
    if kind == "missing":
        return f"{where}: {key} is missing{tail}"
    if kind in ("value_error", "assertion_error"):
        at = f"{key}: " if key else ""
        return f"{where}: {at}{printable(str(first['ctx']['error']))}{more}"
    value = shown(first["input"])
    if kind == "finite_number":
        return f"{where}: {key} = {value} is not a finite number{tail}"
    if kind == "literal_error" and isinstance(first["input"], str) and field is not None:
        return f"{where}: {key} = {value} is not known{tail}"
    if kind in _OUT_OF_RANGE:
        return f"{where}: {key} = {value} is out of range{tail}"
    if kind in _WRONG_LENGTH:
        return f"{where}: {key} = {value} has the wrong length or form{tail}"
    return f"{where}: {key or 'the whole'} = {value} is of the wrong kind{tail}"
