"""Options that stand for a setting of the scene: its help, and where it goes, are those of the record's own field.

A setting is declared once, as a field of Setup or of a part of it. `setting("fit.evaluations")` makes the option of it; the
option's value goes to the record under that key and is checked there, and a refusal names the option.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from typing import Any, get_type_hints

import typer
from pydantic import BaseModel
from pydantic.fields import FieldInfo
from typer.models import OptionInfo

from voldetail.records.refusal import printable
from voldetail.setup.file import Given
from voldetail.setup.setup import Setup

Convert = Callable[[str], Mapping[str, object]]
"""From an option's text to settings by key, where it is not itself the one value."""

SETTINGS: dict[int, tuple[OptionInfo, str, Convert | None]] = {}
"""Each option that `setting` made, with its key, by its identity: kept here, so that no other object takes that."""


def field_of(key: str) -> FieldInfo:
    """Return the field of the record that ``key`` ("photo.resolution") names; KeyError for none."""
    record: type[BaseModel] = Setup
    *parts, name = key.split(".")
    for part in parts:
        below = record.model_fields[part].annotation
        if not (isinstance(below, type) and issubclass(below, BaseModel)):
            raise KeyError(key)
        record = below
    return record.model_fields[name]


def setting(key: str, *names: str, panel: str, words: str = "", convert: Convert | None = None) -> Any:
    """Return the typer option for the setting ``key``.

    names: where they are not the parameter's own. words: added to the field's sentence, for how it is typed. convert: from what
    is typed to settings, where that is not the value itself.
    """
    sentence = (field_of(key).description or "").rstrip(".")
    made: OptionInfo = typer.Option(*names, help=f"{sentence}{f': {words}' if words else ''}.", rich_help_panel=panel)
    SETTINGS[id(made)] = made, key, convert
    return made


def given(command: Callable[..., None], values: Mapping[str, object]) -> Iterator[Given]:
    """Yield what the user gave of the settings of ``command``, by the ``values`` of its parameters (None: not given)."""
    for name, hint in get_type_hints(command, include_extras=True).items():
        found = next((SETTINGS[id(one)] for one in getattr(hint, "__metadata__", ()) if id(one) in SETTINGS), None)
        value = values.get(name)
        if found is None or value is None:
            continue
        option, key, convert = found
        typed = next((word for word in option.param_decls or () if word.startswith("--")), f"--{name.replace('_', '-')}")
        source = f"{typed.split('/')[0]} {printable(str(value))}"
        for place, one in (convert(str(value)) if convert else {key: value}).items():
            yield Given(tuple(place.split(".")), one, source)
