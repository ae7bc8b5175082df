"""The public names of voldetail.api, functions and records, as directives of autodoc."""

from __future__ import annotations

import inspect
import re

from voldetail import api

_ARRAY = re.compile(
    r"~?(?:numpy\.)?ndarray\[tuple\[~?(?:typing\.)?Any, \.\.\.\], ~?(?:numpy\.)?dtype\[~?(?:numpy\.|typing\.)?(\w+)\]\]"
)

KINDS = ("functions", "records", "errors", "constants")


def interface_page(kind: str) -> str:
    """Return the directives for all public names of a kind."""
    names = [name for name in api.__all__ if kind_of(name) == kind]
    directive = {"functions": "autofunction", "records": "autoclass", "errors": "autoexception", "constants": "autodata"}[kind]
    options = "\n   :members:\n   :exclude-members: model_config" if kind == "records" else ""
    lines = [f".. {directive}:: voldetail.api.{name}{options}\n" for name in names]
    return "```{eval-rst}\n" + "\n".join(lines) + "```\n"


def kind_of(name: str) -> str:
    """Return which of the kinds a public name is."""
    found = getattr(api, name)
    if inspect.isclass(found):
        return "errors" if issubclass(found, Exception) else "records"
    return "functions" if inspect.isroutine(found) else "constants"


def short_arrays(signature: str) -> str:
    """Return a signature in which arrays are written as in the source, NDArray[float32]."""
    return _ARRAY.sub(r"NDArray[\1]", signature)
