"""Building a library: chunks computed by many, kept as they come, and made one library at the end.

A build that was stopped, killed or ran out of disk goes on where it was, and however it was built, the same plan gives the same
files, byte for byte.
"""

from __future__ import annotations

import os
import shutil
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from voldetail.errors import InputError
from voldetail.library.building.finish import finish
from voldetail.library.building.plan import Plan, Task
from voldetail.library.building.processes import in_processes, in_this_process
from voldetail.library.building.source import Chunk, Source
from voldetail.library.building.staging import Staging
from voldetail.library.store import is_library
from voldetail.metric.gabor import GLOBAL


@dataclass(frozen=True)
class BuildProgress:
    """How far a build is: entries there, of how many, those computed in this run, its seconds, and entries a second."""

    stage: Literal["computing", "finishing"]
    done: int
    total: int
    computed: int
    seconds: float
    rate: float | None

    @property
    def seconds_left(self) -> float | None:
        """About how long the missing entries take; None where there is nothing to judge by."""
        return (self.total - self.done) / self.rate if self.rate and self.stage == "computing" else None


def build(
    sources: Sequence[Source],
    counts: int | Sequence[int],
    path: str | Path,
    *,
    workers: int | None = None,
    scheduler: str | None = None,
    chunk: int | None = None,
    w_global: float = GLOBAL,
    force: bool = False,
    on_progress: Callable[[BuildProgress], None] = lambda progress: None,
) -> Path:
    """Build the library ``path`` from so many entries of each source, and return its path.

    workers: processes of this machine, default as many as there are cores. scheduler: address of a Dask scheduler whose workers
    compute instead. chunk: entries computed at a time, default by count. force: a library that is there already is replaced.
    What is computed is kept in the folder PATH.part until the library is whole; a later call with the same arguments goes on.
    Raises InputError where ``path`` cannot be written or is there, the plan is not possible, the folder beside it holds
    another plan's chunks, the disk is full, processes die of the same chunk, or the scheduler cannot be reached or goes away.
    """
    path = Path(path)
    each = (counts,) * len(sources) if isinstance(counts, int) else tuple(counts)
    plan = Plan(tuple(sources), each, chunk, w_global)
    check_output(path, force)
    if workers is not None and workers < 1:
        raise InputError(f"{workers} processes cannot compute; at least 1 is needed.")
    clock = _Clock()
    with ExitStack() as at_end:
        staging = Staging(part_of(path), plan)
        at_end.callback(staging.close)
        missing = staging.missing()
        there = done = plan.entries - sum(task.count for task in missing)

        def tell(stage: Literal["computing", "finishing"], entries: int) -> None:
            on_progress(BuildProgress(stage, entries, plan.entries, done - there, *clock.read(done - there)))

        tell("computing", done)
        results = _computed(plan.sources, missing, workers or os.cpu_count() or 1, scheduler)
        at_end.callback(results.close)  # type: ignore[attr-defined]
        for task, found in results:
            staging.write(task, found)
            done += task.count
            tell("computing", done)
        finished = staging.folder / "finished"
        finish(staging, finished, lambda entries: tell("finishing", entries))
        _put(finished, path, staging.folder / "replaced", force)
        staging.remove()
    return path


def part_of(path: Path) -> Path:
    """Return the folder that keeps what is computed of the library ``path`` until it is whole."""
    return path.with_name(path.name + ".part")


def check_output(path: Path, force: bool) -> None:
    """Raise InputError unless a library can be written at ``path``: nothing else than, with ``force``, a library is there."""
    if not path.name:
        raise InputError(f"Cannot write {path}: it has no name; give the name of a folder that is not there yet.")
    if path.is_symlink() or path.exists():
        if not force:
            raise InputError(f"Cannot write {path}: it is there already; give another, or --force to replace the library.")
        if path.is_symlink() or not is_library(path):
            raise InputError(f"Cannot replace {path}: it is no library of voldetail's; give another output.")
    if not path.parent.is_dir():
        raise InputError(f"Cannot write {path}: there is no folder {path.parent}; make it or give another.")
    if not os.access(path.parent, os.W_OK | os.X_OK):
        raise InputError(f"Cannot write {path}: the folder {path.parent} is not writable; give another.")


def _computed(
    sources: Sequence[Source], tasks: Sequence[Task], workers: int, scheduler: str | None
) -> Iterator[tuple[Task, Chunk]]:
    if scheduler is not None:
        if tasks:
            from voldetail.library.building.cluster import on_cluster

            yield from on_cluster(sources, tasks, scheduler)
        return
    shared = [task for task in tasks if sources[task.source].parallel]
    count = min(workers, len(shared))
    yield from in_processes(sources, shared, count) if count > 1 else in_this_process(sources, shared)
    yield from in_this_process(sources, [task for task in tasks if not sources[task.source].parallel])


def _put(finished: Path, path: Path, aside: Path, force: bool) -> None:
    """Give a finished library its name; the one that had it goes."""
    try:
        shutil.rmtree(aside, ignore_errors=True)
        if force and path.exists():
            os.replace(path, aside)
        os.rename(finished, path)
    except OSError as error:
        raise InputError(
            f"Cannot give the library its name {path}: {error.strerror}; what is done is kept, give the same command again."
        ) from error


class _Clock:
    """Seconds since a build began, and its speed, for which starting the processes does not count."""

    def __init__(self) -> None:
        self.start = time.monotonic()
        self.first: tuple[float, int] | None = None

    def read(self, computed: int) -> tuple[float, float | None]:
        """Return the seconds and, where something is computed, entries a second."""
        now = time.monotonic()
        if computed and self.first is None:
            self.first = (now, computed)
        since, before = self.first or (self.start, 0)
        if computed == before:
            since, before = self.start, 0
        return now - self.start, (computed - before) / max(now - since, 1e-9) if computed else None
