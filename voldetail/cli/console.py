"""The two consoles: results go to standard output, progress and remarks to the error stream."""

from __future__ import annotations

import json
import sys
from collections.abc import Mapping
from dataclasses import dataclass
from io import StringIO

from rich.console import Console

PIPED_WIDTH = 120  # columns of a table that goes to a file

Json = Mapping[str, object]


@dataclass
class Manner:
    """How a command speaks. quiet: results and errors alone. verbose: what is decided and how long it took as well. as_json: the
    result as one JSON text and nothing else on standard output. threads: for rendering, 0 for all."""

    quiet: bool = False
    verbose: bool = False
    as_json: bool = False
    threads: int = 0


MANNER = Manner()
"""Of the command that runs; `main` sets it anew for each."""


def output() -> Console:
    """The console for results in words; made at each use, since tests and callers exchange the streams."""
    return _silent() if MANNER.as_json else _console(stderr=False)


def remarks() -> Console:
    """The console for progress and remarks."""
    return _silent() if MANNER.quiet else _console(stderr=True)


def result(record: Json, *lines: str) -> None:
    """Give a result: ``lines`` in words, or ``record`` where JSON is asked for."""
    if MANNER.as_json:
        print(json.dumps(record, indent=2, ensure_ascii=False))
    for line in lines:
        output().print(line, markup=False, soft_wrap=True)


def remark(sentence: str) -> None:
    """Say what the user should know, unless nothing is to be said."""
    remarks().print(sentence, markup=False, soft_wrap=True)


def explain(sentence: str) -> None:
    """Say what was decided, where the user wants to know it."""
    if MANNER.verbose:
        remark(sentence)


def _console(stderr: bool) -> Console:
    stream = sys.stderr if stderr else sys.stdout
    width = None if stream.isatty() else PIPED_WIDTH
    return Console(file=stream, width=width, highlight=False, soft_wrap=False, emoji=False)


def _silent() -> Console:
    return Console(file=StringIO(), width=PIPED_WIDTH, highlight=False)
