"""The two consoles: results go to standard output, progress and remarks to the error stream."""

from __future__ import annotations

import sys

from rich.console import Console

PIPED_WIDTH = 120  # columns of a table that goes to a file


def output() -> Console:
    """The console for results; made at each use, since tests and callers exchange the streams."""
    return _console(stderr=False)


def remarks() -> Console:
    """The console for progress and remarks."""
    return _console(stderr=True)


def _console(stderr: bool) -> Console:
    stream = sys.stderr if stderr else sys.stdout
    width = None if stream.isatty() else PIPED_WIDTH
    return Console(file=stream, width=width, highlight=False, soft_wrap=False, emoji=False)
