"""Progress of long work: a live line on a terminal, plain lines every few seconds elsewhere."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from types import TracebackType
from typing import TYPE_CHECKING

from rich.console import Console
from rich.live import Live
from rich.progress_bar import ProgressBar
from rich.table import Table
from rich.text import Text

from voldetail.report.facts import duration

if TYPE_CHECKING:
    from voldetail.fit.session import Progress

LINE_SECONDS = 5.0  # between two lines where there is no terminal
BAR_WIDTH = 24


class ProgressView:
    """Shows Progress records and single steps on a console while it is entered."""

    def __init__(self, console: Console, clock: Callable[[], float] = time.monotonic) -> None:
        self.console, self.clock = console, clock
        self.live = Live(console=console, transient=True, refresh_per_second=4) if console.is_terminal else None
        self.last_line = -math.inf
        self.last_stage = ""

    def __enter__(self) -> ProgressView:
        if self.live:
            self.live.start()
            self.live.update(Text("reading the photo and preparing the scene ..."))
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        if self.live:
            self.live.stop()

    def searching(self, progress: Progress) -> None:
        """Show how far a search is."""
        if self.live:
            self.live.update(_row(progress))
            return
        now = self.clock()
        if progress.stage != self.last_stage or now - self.last_line >= LINE_SECONDS:
            self.last_stage, self.last_line = progress.stage, now
            self.console.print(Text(line(progress)), soft_wrap=True)

    def step(self, what: str) -> None:
        """Show what is being done, where no number tells how far."""
        if self.live:
            self.live.update(Text(what + " ..."))
        else:
            self.console.print(Text(what + " ..."), soft_wrap=True)


def line(progress: Progress) -> str:
    """One plain line of progress."""
    so_far, left = duration(progress.seconds), duration(progress.seconds_left)
    return (
        f"{progress.stage}: {progress.evaluations} of {progress.planned} pictures,"
        f" {best_words(progress.best)}, {so_far} so far, about {left} left"
    )


def best_words(best: float) -> str:
    """The best distance in words; there is none before a picture was compared at full resolution."""
    return f"best M {best:.3g}" if math.isfinite(best) else "M not known yet"


def _row(progress: Progress) -> Table:
    row = Table.grid(padding=(0, 2))
    done = min(progress.evaluations, progress.planned)
    bar = ProgressBar(total=max(progress.planned, 1), completed=done, width=BAR_WIDTH)
    row.add_row(
        Text(progress.stage, style="bold"),
        bar,
        Text(f"{progress.evaluations}/{progress.planned}"),
        Text(best_words(progress.best), style="green"),
        Text(f"about {duration(progress.seconds_left)} left"),
    )
    return row
