"""Chunks computed by processes of this machine.

Each is started afresh and not forked, since a renderer does not survive that, and computes with one thread. What it has computed
goes back through a pipe. One that dies is replaced and its chunk computed by another.
"""

from __future__ import annotations

import os
import signal
from collections import Counter, deque
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from multiprocessing import get_context, resource_tracker
from multiprocessing.connection import Connection, wait
from multiprocessing.process import BaseProcess
from typing import Any

from voldetail.errors import InputError, VoldetailError
from voldetail.library.building.plan import Task
from voldetail.library.building.source import Chunk, Source

MOST_DEATHS = 3
"""Processes that may die of one chunk: a fourth would too."""

SECONDS_TO_END = 1.0
"""That a process whose pipe is closed has to tell how it ended."""

ONE_THREAD = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "VECLIB_MAXIMUM_THREADS"), "1")


def in_this_process(sources: Sequence[Source], tasks: Sequence[Task]) -> Iterator[tuple[Task, Chunk]]:
    """Yield each task with its chunk, computed here, in order."""
    for task in tasks:
        yield task, sources[task.source].chunk(task.first, task.count)


def in_processes(sources: Sequence[Source], tasks: Sequence[Task], count: int) -> Iterator[tuple[Task, Chunk]]:
    """Yield each task with its chunk, computed by ``count`` processes, as they come.

    The processes end when the iterator is closed. Raises InputError when three in a row died of the same chunk, and what a source
    raises.
    """
    left, deaths = deque(tasks), Counter[Task]()
    workers: list[_Worker] = []
    try:
        while left or any(worker.task for worker in workers):
            while left and len(workers) < count:
                workers.append(_started(sources))
            for worker in workers:
                if worker.task is None and left:
                    worker.give(left.popleft())
            ready = wait([worker.pipe for worker in workers if worker.task])
            for worker in [worker for worker in workers if worker.pipe in ready]:
                task = worker.task
                assert task is not None
                answer = worker.answer()
                if answer is not None:
                    yield task, answer
                    continue
                workers.remove(worker)
                worker.process.join(SECONDS_TO_END)
                worker.stop()
                deaths[task] += 1
                if deaths[task] >= MOST_DEATHS:
                    raise InputError(
                        f"{deaths[task]} processes ended while they computed entries {task.first} to "
                        f"{task.first + task.count - 1} of {sources[task.source].name} (the last one with {worker.ending}); what "
                        "is done is kept: free memory or give fewer --workers, and give the same command again."
                    )
                left.appendleft(task)
    finally:
        for worker in workers:
            worker.stop()


@dataclass
class _Worker:
    """A process, our end of the pipe to it, and what it is computing."""

    process: BaseProcess
    pipe: Connection
    task: Task | None = None

    def give(self, task: Task) -> None:
        self.task = task
        with suppress(OSError):  # a process that has died is seen when its answer is waited for
            self.pipe.send(task)

    def answer(self) -> Chunk | None:
        """What it computed, None where it died. Raises what its source raised."""
        try:
            chunk: Any = self.pipe.recv()
        except (EOFError, OSError):
            return None
        self.task = None
        if isinstance(chunk, BaseException):
            raise chunk
        return chunk

    def stop(self) -> None:
        self.process.kill()
        self.process.join()
        self.pipe.close()

    @property
    def ending(self) -> str:
        code = self.process.exitcode or 0
        return f"signal {-code}" if code < 0 else f"exit code {code}"


def _started(sources: Sequence[Source]) -> _Worker:
    context = get_context("spawn")
    ours, theirs = context.Pipe()
    process = context.Process(target=_work, args=(theirs, tuple(sources)), daemon=True)
    resource_tracker.ensure_running()  # or starting it would let Ctrl-C through again
    with _one_thread(), _without_interrupts():
        process.start()
    theirs.close()  # or its end would not be seen
    return _Worker(process, ours)


def _work(pipe: Connection, sources: tuple[Source, ...]) -> None:
    """What a process does until nobody is at the other end of its pipe."""
    with suppress(EOFError, OSError):
        while True:
            task: Task = pipe.recv()
            try:
                answer: Any = sources[task.source].chunk(task.first, task.count)
            except (VoldetailError, MemoryError) as error:
                answer = error
            except Exception as error:
                what = f"{sources[task.source].name}, entries from {task.first} on"
                answer = RuntimeError(f"{what}: {type(error).__name__}: {error}")
            pipe.send(answer)


@contextmanager
def _one_thread() -> Iterator[None]:
    """What libraries of numbers read when a process starts."""
    before = {name: os.environ.get(name) for name in ONE_THREAD}
    os.environ.update(ONE_THREAD)
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                del os.environ[name]
            else:
                os.environ[name] = value


@contextmanager
def _without_interrupts() -> Iterator[None]:
    """Ctrl-C waits, and a process started meanwhile never gets it: the one who started it ends it."""
    if not hasattr(signal, "pthread_sigmask"):  # Windows
        yield
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)
