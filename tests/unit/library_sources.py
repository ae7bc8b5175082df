"""Sources of entries that cost nothing, and some that go wrong, in a module that other processes can import."""

import os
import signal
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from voldetail.errors import InputError
from voldetail.library.building.source import Chunk
from voldetail.library.measures import MeasureName


@dataclass(frozen=True)
class Counted:
    """Random entries by their numbers. trouble: what happens at entry ``at``; a file marks that it has happened ``times``."""

    name: str = "counted"
    keys: tuple[str, ...] = ("number", "share")
    seed: int = 0
    measure: MeasureName = "structures"
    parallel: bool = True
    seconds: float = 0.0
    trouble: str = ""
    at: int = 0
    times: int = 1
    marks: Path | None = None

    @property
    def definition(self) -> dict[str, Any]:
        return {"kind": "counted"}

    def chunk(self, first: int, count: int) -> Chunk:
        if self.marks is not None and first <= self.at < first + count and self._once():
            if self.trouble == "die":
                os.kill(os.getpid(), signal.SIGKILL)
            if self.trouble == "stop":
                raise KeyboardInterrupt
            if self.trouble == "refuse":
                raise InputError("There is no such entry.")
            if self.trouble == "fail":
                raise ZeroDivisionError("by nothing")
        time.sleep(self.seconds * count)
        drawn = [np.random.Generator(np.random.PCG64([self.seed, k])).random(750) for k in range(first, first + count)]
        vectors = np.asarray(drawn, np.float32)
        if self.trouble == "nan" and first <= self.at < first + count:
            vectors[self.at - first, 20] = np.nan
        values = np.arange(first, first + count)[:, None] + np.array([0.0, 0.5])
        if self.trouble == "zeros":
            values, vectors = 0 * values, 0 * vectors
        return values[:, : len(self.keys)], vectors

    def _once(self) -> bool:
        assert self.marks is not None
        there = len(list(self.marks.glob("mark*")))
        if there < self.times:
            (self.marks / f"mark{there}").touch()
        return there < self.times


def files_of(folder: Path) -> dict[str, bytes]:
    """Every file of a library with its content."""
    return {path.relative_to(folder).as_posix(): path.read_bytes() for path in sorted(folder.rglob("*")) if path.is_file()}
