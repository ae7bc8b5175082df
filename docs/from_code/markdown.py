"""Small pieces of Markdown."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence

_SPECIAL = re.compile(r"([\\|*_<>\[\]{}$`#~])")
_OPTION = re.compile(r"(?<![\w'-])(--?[A-Za-z][\w-]*)")


def plain(text: str) -> str:
    """Return ``text`` on one line as Markdown that shows it as it stands; options such as --light become code."""
    parts = _OPTION.split(" ".join(text.split()))
    return "".join(f"`{part}`" if i % 2 else _SPECIAL.sub(r"\\\1", part) for i, part in enumerate(parts))


def code(text: str) -> str:
    """Return ``text`` as code, in a cell of a table too."""
    return f"`{text.replace('|', chr(92) + '|')}`" if text else ""


def table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """Return a table; cells are Markdown already."""
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join("| " + " | ".join(cells) + " |" for cells in lines) + "\n"
