"""Chunks computed by the workers of a Dask scheduler.

They send back what they have computed, so no disk is shared. A chunk whose worker goes away is computed by another: the scheduler
sees to that.
"""

from __future__ import annotations

import logging
import re
import threading
from asyncio import CancelledError as AsyncCancelledError
from collections.abc import Iterator, Sequence
from concurrent.futures import CancelledError
from contextlib import contextmanager
from typing import Any

from voldetail.errors import InputError
from voldetail.library.building.plan import Task
from voldetail.library.building.source import Chunk, Source
from voldetail.library.vectors import definition, digest
from voldetail.records.refusal import shown

ADDRESS = r"((tcp|tls|ws|wss|ucx)://)?[^\s/]+:\d{1,5}"
"""What Dask calls one: a client that is given something else prints more than one sentence."""

CONNECT_SECONDS = 10.0
WORKER_SECONDS = 60.0
"""That are waited for the first worker."""

POLL_SECONDS = 1.0
"""Between two looks at whether the scheduler is there, where no chunk comes."""

SAME = "install this version on every machine of the cluster and start it again."

IN_FLIGHT = 2
"""Chunks given out for each thread of the workers: one that is computed and one that waits."""

_ALONE = threading.Lock()


def on_cluster(sources: Sequence[Source], tasks: Sequence[Task], address: str) -> Iterator[tuple[Task, Chunk]]:
    """Yield each task with its chunk as the workers of the scheduler at ``address`` have computed it.

    Raises InputError where Dask is not installed, the scheduler cannot be reached or goes away, it has no workers, or they have
    another voldetail, and what a source raises.
    """
    try:
        import distributed
    except ImportError:
        raise InputError(
            "--scheduler needs Dask, which is not installed; install it with: pip install 'voldetail[cluster]'."
        ) from None
    if not re.fullmatch(ADDRESS, address):
        raise InputError(
            f"The scheduler {shown(address)} is no address; give what dask scheduler prints, e.g. tcp://192.168.0.5:8786."
        )
    again = "what is done is kept, give the same command again when it is back."
    with _quiet():
        try:
            client = distributed.Client(address, timeout=CONNECT_SECONDS, set_as_default=False)
        except (OSError, ValueError, TypeError) as error:
            reason = " ".join(str(error).split()) or type(error).__name__
            raise InputError(
                f"The scheduler {address} cannot be reached ({reason}); give the address that dask scheduler prints."
            ) from error
        try:
            try:
                client.wait_for_workers(1, timeout=WORKER_SECONDS)
            except TimeoutError:
                raise InputError(f"The scheduler {address} has no workers; start some with: dask worker {address}.") from None
            yield from _gathered(distributed, client, sources, tasks)
        except (CancelledError, AsyncCancelledError, OSError) as error:
            raise InputError(f"The scheduler {address} went away; {again}") from error
        except distributed.KilledWorker as error:
            raise InputError(
                f"Several workers of {address} ended while they computed the same entries; give them more memory. What is done "
                "is kept, give the same command again."
            ) from error
        except (ImportError, RuntimeError) as error:
            if isinstance(error, RuntimeError) and "deserialization" not in str(error):
                raise
            raise InputError(f"The scheduler {address} or its workers lack voldetail; {SAME}") from error
        finally:
            client.close(timeout=2)


def _gathered(distributed: Any, client: Any, sources: Sequence[Source], tasks: Sequence[Task]) -> Iterator[tuple[Task, Chunk]]:
    left: list[Task] = list(reversed(tasks))
    running: dict[Any, Task] = {}
    while left or running:
        if client.status != "running":  # all that was given out is lost, even where it connects again
            raise CancelledError
        most = IN_FLIGHT * max(1, sum(client.nthreads().values()))
        while left and len(running) < most:
            task = left.pop()
            running[client.submit(_chunk, sources[task.source], task.first, task.count, pure=False)] = task
        try:
            with client.as_current():
                done = distributed.wait(list(running), timeout=POLL_SECONDS, return_when="FIRST_COMPLETED").done
        except TimeoutError:
            continue
        for future in done:
            task = running[future]
            theirs, values, vectors = future.result()
            if theirs != _ours(sources[task.source]):
                raise InputError(f"The workers of the scheduler have another voldetail; {SAME}")
            del running[future]
            yield task, (values, vectors)


def _chunk(source: Source, first: int, count: int) -> tuple[str, Any, Any]:
    """What a worker does: the entries, and what it takes their definition for."""
    if source.parallel:
        return _ours(source), *source.chunk(first, count)
    with _ALONE:  # its other threads have to wait
        return _ours(source), *source.chunk(first, count)


def _ours(source: Source) -> str:
    return digest([definition(), dict(source.definition)])


@contextmanager
def _quiet() -> Iterator[None]:
    """Dask tells of lost connections in many lines; one sentence is ours to say."""
    loggers = [logging.getLogger(name) for name in ("distributed", "distributed.client", "distributed.core", "tornado")]
    levels = [logger.level for logger in loggers]
    for logger in loggers:
        logger.setLevel(logging.CRITICAL + 1)
    try:
        yield
    finally:
        for logger, level in zip(loggers, levels, strict=True):
            logger.setLevel(level)
