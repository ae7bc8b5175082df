"""Everything in a library read and held against what it says of itself; minutes for millions of entries."""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from voldetail.errors import InputError
from voldetail.library.groups import Group
from voldetail.library.layout import step_of
from voldetail.library.pieces import Columns
from voldetail.library.store import Library
from voldetail.library.tables import worked_out

ROUNDING = 1e-4
"""Relative difference of norms and outlines that another machine's sums may have."""


def check(library: Library, on_entries: Callable[[int], None] = lambda entries: None) -> None:
    """Read all of a library; on_entries is told how many entries are done.

    Raises InputError for the first entries that have NaN, norms or outlines that are not their own, and for values and vectors
    that are not those that were written.
    """
    done = 0
    for name, record in library.header.sources.items():
        where = f"The library {library.header.path}, source {name}"
        group, content, step = library.groups.get(name), hashlib.sha256(), step_of(record.entries)
        values, vectors = _values_and_vectors(library, name)
        for first in range(0, record.entries, step):
            here = slice(first, min(first + step, record.entries))
            numbers, rows = values[here], vectors[here]
            if not (np.isfinite(numbers).all() and np.isfinite(rows).all()):
                raise InputError(f"{where}, entries {first} to {here.stop - 1}: numbers are NaN or infinite; build it again.")
            if group is not None:
                _check_worked_out(group, here, rows, where)
            content.update(numbers.tobytes() + rows.tobytes())
            done += here.stop - first
            on_entries(done)
        if content.hexdigest() != record.sha256:
            raise InputError(f"{where}: its entries are not those that were written; build it again.")


def _values_and_vectors(library: Library, name: str) -> tuple[Any, Any]:
    if name in library.groups:
        return library.groups[name].values, library.groups[name].table.vectors
    return library.series[name].values, library.series[name].vectors


def _check_worked_out(group: Group, here: slice, vectors: NDArray[np.float32], where: str) -> None:
    """Raise InputError unless the norms and outlines of some entries are theirs."""
    outlines = group.table.outlines
    assert isinstance(outlines, Columns)
    with np.errstate(over="ignore", invalid="ignore"):  # of vectors that are damaged
        expected = worked_out(vectors, group.table.weights)
    for found, wanted in ((group.table.norms[here], expected[0]), (outlines.piece(here.start // outlines.step), expected[1])):
        most = float(np.abs(wanted).max(initial=0.0, where=np.isfinite(wanted)))
        if not np.allclose(found, wanted, ROUNDING, ROUNDING * most):
            raise InputError(
                f"{where}, entries {here.start} to {here.stop - 1}: norms or outlines are not theirs; build it again."
            )
