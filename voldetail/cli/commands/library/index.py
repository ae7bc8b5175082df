"""`voldetail library index`: what makes queries of millions of entries quick."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from voldetail.cli.console import result
from voldetail.cli.library_words import make_index


def index(library: Annotated[Path, typer.Argument(metavar="LIB", help="A library, as library build makes it.")]) -> None:
    """Make a library's index: of millions of entries, a query then compares those that are likely, and may miss some."""
    file, words = make_index(library)
    result({"file": str(file)}, words)
