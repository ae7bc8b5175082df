"""A matrix that lies in several pieces, such as the files of a library, read where a query needs it and no further.

A piece is handed out each time it is asked for and not kept: mapping a file takes microseconds, and a library of millions has
more files than a process may hold open.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any, Generic, TypeVar

import numpy as np
from numpy.typing import NDArray

Kind = TypeVar("Kind", np.float16, np.float32, np.float64)


@dataclass(frozen=True, eq=False)
class Rows(Generic[Kind]):
    """A matrix in pieces of ``step`` rows, the last one perhaps of fewer.

    shape: (rows, columns) of the whole. piece(k) returns rows k * step and on. Rows are taken as from an array: by a number, a
    slice without steps, or an array of numbers from 0 in any order.
    """

    shape: tuple[int, int]
    step: int
    dtype: type[Kind]
    piece: Callable[[int], NDArray[Kind]]

    def __len__(self) -> int:
        return self.shape[0]

    def __getitem__(self, numbers: Any) -> NDArray[Kind]:
        if isinstance(numbers, slice):
            return self[np.arange(*numbers.indices(len(self)))]
        chosen = np.asarray(numbers, np.intp)
        if chosen.size and not (chosen.min() >= 0 and chosen.max() < len(self)):
            raise IndexError(f"rows {chosen.min()} to {chosen.max()} of {len(self)} are asked for")
        if chosen.ndim == 0:
            return np.array(self.piece(int(chosen) // self.step)[int(chosen) % self.step])
        values = np.empty((len(chosen), self.shape[1]), self.dtype)
        if (np.diff(chosen) < 0).any():
            order = np.argsort(chosen, kind="stable")
            values[order] = self[chosen[order]]
            return values
        first = 0
        while first < len(chosen):
            k = int(chosen[first]) // self.step
            last = int(np.searchsorted(chosen, (k + 1) * self.step))
            np.take(self.piece(k), chosen[first:last] - k * self.step, axis=0, out=values[first:last], mode="clip")
            first = last
        return values

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> NDArray[Any]:
        return self[:] if dtype is None else self[:].astype(dtype)


@dataclass(frozen=True, eq=False)
class Columns:
    """A matrix (rows, columns) float32 in pieces of ``step`` columns, the last one perhaps of fewer."""

    shape: tuple[int, int]
    step: int
    piece: Callable[[int], NDArray[np.float32]]

    def pieces(self) -> Iterator[NDArray[np.float32]]:
        """Yield the pieces in order."""
        for first in range(0, self.shape[1], self.step):
            yield self.piece(first // self.step)


def pieces_of(matrix: NDArray[np.float32] | Columns) -> Iterator[NDArray[np.float32]]:
    """Yield the pieces of a matrix, side by side; an array is one."""
    if isinstance(matrix, Columns):
        yield from matrix.pieces()
    else:
        yield matrix
