"""The chunks of a library that is being built: a file each, in a folder beside it, so that a stopped build can go on.

A file is written whole or not at all, and begins with the SHA-256 of the rest; one that does not have the length or the hash is
computed again. The folder belongs to one plan and, while a build works in it, to one process.
"""

from __future__ import annotations

import hashlib
import json
import os
import shutil
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path

import numpy as np

from voldetail.errors import InputError
from voldetail.files import readable, write_bytes, write_text
from voldetail.library.building.plan import Plan, Task
from voldetail.library.building.source import Chunk, Source
from voldetail.library.layout import MOST_METADATA
from voldetail.library.measures import MEASURES

HASH = 32  # bytes of a SHA-256


class Staging:
    """The folder in which one plan's chunks are kept.

    Raises InputError when it is made where the folder belongs to another plan, is no such folder, is in use, or cannot be
    written.
    """

    def __init__(self, folder: Path, plan: Plan) -> None:
        self.folder, self.plan = folder, plan
        measure = MEASURES[plan.measure]
        self.length, self.kind = measure.length(), np.dtype(measure.kind).newbyteorder("<")
        self._lock = -1
        said = json.dumps({"plan": plan.definition, "chunk": plan.chunk}, indent=2, sort_keys=True) + "\n"
        try:
            folder.mkdir(exist_ok=True)
            for source in plan.sources:
                (folder / source.name).mkdir(exist_ok=True)
        except OSError as error:
            raise InputError(f"Cannot make the folder {folder}: {error.strerror}; give another output.") from error
        self._lock = _locked(folder / "lock", folder)
        try:
            record = folder / "plan.json"
            if not record.exists():
                if any(path.name != "lock" and not path.is_dir() for path in folder.iterdir()):
                    raise InputError(f"The folder {folder} holds something else; delete it or give another output.")
                write_text(record, said)
            elif readable(record, "plan", MOST_METADATA).read_text(encoding="utf-8", errors="replace") != said:
                raise InputError(
                    f"The folder {folder} holds chunks of another library, begun with other settings; give the same command as "
                    "then, delete the folder, or give another output."
                )
        except BaseException:
            self.close()
            raise

    def missing(self) -> list[Task]:
        """Return the chunks that are not there whole."""
        return [task for task in self.plan.tasks() if self._read(task) is None]

    def write(self, task: Task, chunk: Chunk) -> None:
        """Keep a chunk. Raises InputError where it is not what its source promises, and where the disk is full."""
        data = self._bytes(self.plan.sources[task.source], task, chunk)
        try:
            write_bytes(self._file(task), hashlib.sha256(data).digest() + data)
        except InputError as error:
            reason = getattr(error.__cause__, "strerror", None) or error
            raise InputError(
                f"Cannot write in {self.folder}: {reason}; what is done is kept: free some space and give the same command again."
            ) from error

    def rows(self, place: int) -> _Reader:
        """Return what reads a source's entries in order."""
        return _Reader(self, [task for task in self.plan.tasks() if task.source == place])

    def remove(self) -> None:
        """Delete the folder with all that is in it."""
        self.close()
        shutil.rmtree(self.folder, ignore_errors=True)

    def close(self) -> None:
        """Leave the folder to others."""
        if self._lock >= 0:
            os.close(self._lock)
            self._lock = -1

    def _file(self, task: Task) -> Path:
        return self.folder / self.plan.sources[task.source].name / f"{task.first:08d}.chunk"

    def _read(self, task: Task) -> Chunk | None:
        keys = len(self.plan.sources[task.source].keys)
        numbers = 8 * keys * task.count
        file = self._file(task)
        try:
            if file.stat().st_size != HASH + numbers + self.kind.itemsize * self.length * task.count:
                return None
            data = file.read_bytes()
        except OSError:
            return None
        if hashlib.sha256(data[HASH:]).digest() != data[:HASH]:
            return None
        values = np.frombuffer(data, "<f8", task.count * keys, HASH).reshape(task.count, keys)
        rows = np.frombuffer(data, self.kind, task.count * self.length, HASH + numbers)
        return values, rows.reshape(task.count, self.length)

    def _bytes(self, source: Source, task: Task, chunk: Chunk) -> bytes:
        values, vectors = np.asarray(chunk[0], "<f8"), np.asarray(chunk[1], self.kind)
        wanted = (task.count, len(source.keys)), (task.count, self.length)
        if (values.shape, vectors.shape) != wanted:
            raise InputError(f"{source.name} gave entries of the shapes {values.shape} and {vectors.shape}; {wanted} are needed.")
        good = np.isfinite(values).all(axis=1) & np.isfinite(vectors).all(axis=1)
        if not good.all():
            raise InputError(
                f"Entry {task.first + int(np.argmin(good))} of {source.name} has numbers that are NaN or infinite; "
                "leave out its source."
            )
        return values.tobytes() + vectors.tobytes()


class _Reader:
    """Reads a source's entries from its chunks, each once."""

    def __init__(self, staging: Staging, tasks: Sequence[Task]) -> None:
        self.staging, self.tasks = staging, iter(tasks)
        self.held: list[Chunk] = []

    def next(self, count: int) -> Chunk:
        """Return the next ``count`` entries. Raises InputError where a chunk is damaged."""
        while sum(len(values) for values, _ in self.held) < count:
            task = next(self.tasks)
            found = self.staging._read(task)
            if found is None:
                raise InputError(f"The file {self.staging._file(task)} was damaged meanwhile; give the same command again.")
            self.held.append(found)
        values, vectors = (np.concatenate(parts) for parts in zip(*self.held, strict=True))
        self.held = [(values[count:], vectors[count:])]
        return values[:count], vectors[:count]


def _locked(file: Path, folder: Path) -> int:
    """Return a descriptor that holds the folder until it is closed, also when its process is killed."""
    try:
        descriptor = os.open(file, os.O_CREAT | os.O_RDWR, 0o666)
    except OSError as error:
        raise InputError(f"Cannot write in {folder}: {error.strerror}; give another output.") from error
    with suppress(ImportError):  # not on Windows, which has no such locks
        import fcntl

        try:
            fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            os.close(descriptor)
            raise InputError(f"Another process builds in {folder}; wait for it, or give another output.") from None
        except OSError:
            pass  # some network file systems have none either
    return descriptor
