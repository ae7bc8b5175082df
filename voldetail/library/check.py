"""Everything in a library read and held against what it says of itself; minutes for millions of entries."""

from __future__ import annotations

import hashlib
from collections.abc import Callable

import numpy as np

from voldetail.errors import InputError
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
    for name, group in library.groups.items():
        record = library.header.sources[name]
        where = f"The library {library.header.path}, source {name}"
        assert isinstance(group.table.outlines, Columns)
        content, step = hashlib.sha256(), step_of(record.entries)
        for first, outlines in zip(range(0, record.entries, step), group.table.outlines.pieces(), strict=True):
            here = slice(first, min(first + step, record.entries))
            values, vectors, norms = group.values[here], group.table.vectors[here], group.table.norms[here]
            if not (np.isfinite(values).all() and np.isfinite(vectors).all()):
                raise InputError(f"{where}, entries {first} to {here.stop - 1}: numbers are NaN or infinite; build it again.")
            with np.errstate(over="ignore", invalid="ignore"):  # of vectors that are damaged
                expected = worked_out(vectors, group.table.weights)
            for found, wanted in ((norms, expected[0]), (outlines, expected[1])):
                most = float(np.abs(wanted).max(initial=0.0, where=np.isfinite(wanted)))
                if not np.allclose(found, wanted, ROUNDING, ROUNDING * most):
                    raise InputError(
                        f"{where}, entries {first} to {here.stop - 1}: norms or outlines are not theirs; build it again."
                    )
            content.update(values.tobytes() + vectors.tobytes())
            done += here.stop - first
            on_entries(done)
        if content.hexdigest() != record.sha256:
            raise InputError(f"{where}: its entries are not those that were written; build it again.")
