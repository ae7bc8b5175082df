"""How far the building of a library is, in words."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from voldetail.cli.progress import ProgressView
    from voldetail.library.building.build import BuildProgress


def teller(view: ProgressView, last: list[BuildProgress], what: str = "") -> Callable[[BuildProgress], None]:
    """Return what shows how far a build is, always on a terminal, else now and then, and leaves the newest in ``last``.

    what: words before the stage.
    """
    from voldetail.cli.progress import LINE_SECONDS
    from voldetail.report.facts import duration

    told = view.clock()

    def tell(progress: BuildProgress) -> None:
        nonlocal told
        first = not last
        last[:] = [progress]
        if first and progress.done:
            view.step(f"going on after {progress.done} of {progress.total} entries")
        if view.live is None and view.clock() - told < LINE_SECONDS:
            return
        told = view.clock()
        left = progress.seconds_left
        time_left = f", about {duration(left)} left" if left is not None else ""
        view.step(f"{what}{progress.stage}: {progress.done} of {progress.total} entries{time_left}")

    return tell
