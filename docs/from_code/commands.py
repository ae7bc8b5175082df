"""Each command as it declares itself: its use, its sentences, its arguments and options with bounds and defaults."""

from __future__ import annotations

from collections.abc import Iterator
from importlib import import_module
from typing import Any, get_type_hints

from pydantic.fields import FieldInfo
from typer.main import get_command

from from_code.markdown import code, plain, table
from from_code.records import allowed
from voldetail.cli import commands
from voldetail.cli.app import app
from voldetail.cli.settings import SETTINGS, field_of

_TYPES = {"str": "TEXT", "int": "NUMBER", "float": "NUMBER", "Path": "FILE"}
_OLDER_TYPES = {"text": "str", "integer": "int", "integer range": "int", "float range": "float", "path": "Path"}
OTHER_OPTIONS = "Options"


def names(command: Any = None, before: str = "") -> Iterator[str]:
    """Yield every command's words, e.g. "fit" and "texture fit"."""
    group: Any = command or get_command(app)
    for name, below in group.commands.items():
        if hasattr(below, "commands"):
            yield from names(below, f"{before}{name} ")
        elif not below.hidden:
            yield before + name


def command_page(words: str) -> str:
    """Return the Markdown of the command that ``words`` name; "" is voldetail itself with the options of all commands."""
    found: Any = get_command(app)
    for word in words.split():
        found = found.commands[word]
    settings = _settings(words)
    given = [p for p in found.params if not getattr(p, "hidden", False)]
    arguments = [p for p in given if p.param_type_name == "argument"]
    options = [p for p in given if p.param_type_name == "option"]
    needed = [f"{p.opts[-1]} {_value(p)}" for p in options if p.required]
    use = " ".join(["voldetail", *words.split(), *map(_argument, arguments), *needed, "[OPTIONS]"])
    pieces = [f"```text\n{use}\n```\n"]
    pieces += [plain(part) + "\n" for part in (found.help or "").split("\n\n")]
    if arguments:
        pieces.append(table(["argument", "meaning"], [(code(_argument(p)), plain(p.help or "")) for p in arguments]))
    for panel in dict.fromkeys(_panel(p) for p in options):
        rows = [(_names(p), _allowed(p, settings.get(p.name)), plain(p.help or "")) for p in options if _panel(p) == panel]
        pieces.append(table([panel, "values", "meaning"], rows))
    return "\n".join(pieces)


def _panel(option: Any) -> str:
    return getattr(option, "rich_help_panel", None) or OTHER_OPTIONS


def _argument(argument: Any) -> str:
    name = argument.metavar or argument.name.upper()
    return name if argument.nargs == 1 else f"{name.removesuffix('...')}..."


def _names(option: Any) -> str:
    long_first = sorted(option.opts, key=len, reverse=True)
    return " or ".join(map(code, [*long_first, *option.secondary_opts]))


def _kind(option: Any) -> str:
    """Return the name of the type of value, which typer keeps in one place since it has parameters of its own."""
    descriptor = getattr(option, "type_descriptor", None)
    if descriptor is not None:
        return str(getattr(descriptor.annotation, "__name__", descriptor.annotation))
    return _OLDER_TYPES.get(option.type.name, str(option.type.name))


def _value(option: Any) -> str:
    return str(option.metavar or _TYPES.get(_kind(option), _kind(option).upper()))


def _settings(words: str) -> dict[str, FieldInfo]:
    """Return the record's fields that options of a command stand for as they are, by the names of its parameters."""
    if not words:
        return {}
    module = import_module(".".join([commands.__name__, *words.split()]))
    hints = get_type_hints(getattr(module, words.split()[-1]), include_extras=True)
    keys = {name: SETTINGS.get(id(one)) for name, hint in hints.items() for one in getattr(hint, "__metadata__", ())}
    return {name: field_of(found[1]) for name, found in keys.items() if found is not None and found[2] is None}


def _allowed(option: Any, setting: FieldInfo | None) -> str:
    """Return what an option takes: its value's name and bounds, and its default; of a setting, what its record says."""
    if option.is_flag:
        return ""
    if setting is not None:
        words = allowed(setting)
        plainly = code(_value(option)) if words == "text" else plain(words)
        has_one = not setting.is_required() and isinstance(setting.default, str | int | float)
        return f"{plainly}, default {code(str(setting.default))}" if has_one else plainly
    words = code(_value(option)) + _bounds(option)
    if option.multiple:
        words += ", repeatable"
    if option.required:
        words += ", needed"
    elif option.default not in (None, [], ()):
        words += f", default {code(str(option.default))}"
    return words


def _bounds(option: Any) -> str:
    limits = option if hasattr(option, "min") else option.type
    least, most = getattr(limits, "min", None), getattr(limits, "max", None)
    if least is None and most is None:
        return ""
    if least is None or most is None:
        return f" from {least:.12g}" if most is None else f" to {most:.12g}"
    return f" {least:.12g} to {most:.12g}"
