"""A table of descriptors, with what a query needs of each entry worked out beforehand.

    D^2(a, b) = a'W a + b'W b - 2 a'(W b),      W = diag(w^2)                          (GKHF14 equation 6, see `compare`)

a'W a is summed here, scale by scale, since a small picture has no entries of the coarsest scales. Beside it each entry has an
outline of 60 numbers: with o the mean of a frequency's 16 orientations, the same in any turn, and u the rest of the entry,

    D^2(a, b) >= sum_u w^2 (u - u')^2 + 16 sum_o w^2 (o - o')^2           (a sum of squares is at least n squares of its mean)

so that most entries can be told to be too far from a twelfth of their numbers.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from voldetail.errors import InputError
from voldetail.library.pieces import Columns, Rows
from voldetail.library.vectors import ISOTROPIC, LENGTH, ORIENTATIONS, ORIENTED, scales, weights
from voldetail.metric.gabor import GLOBAL, SCALES
from voldetail.types import Array, Floats

BLOCK = 8192
"""Entries worked on at once: 24 MB of the table."""

OUTLINE = ORIENTED + (LENGTH - ORIENTED) // ORIENTATIONS
"""Numbers of an outline: 60."""

OUTLINED_ROWS = OUTLINE + 2 * SCALES
"""With the norms below it: 72."""

TOGETHER = 16
"""Rows in one product: so few that OpenBLAS leaves it to the calling thread, as in `metric.filters`. The last digits of sums
then do not hang on how many threads there are, and a library is the same byte for byte wherever it is finished."""


@dataclass(frozen=True, eq=False)
class Table:
    """Descriptors (N, 750) float32, with weights w (750,).

    norms: a'W a of each entry by scale, (N, 12), the oriented entries in the first six columns, the isotropic ones in the
    others. outlines: (72, N), an entry a column, its outline and then the same norms of that; so few rows are multiplied
    several times faster than so few columns. A library's are in the pieces that its files are (see `pieces`).
    """

    vectors: Array | Rows[np.float32]
    weights: Floats
    norms: Array | Rows[np.float32]
    outlines: Array | Columns


def table(vectors: ArrayLike, w_global: float = GLOBAL) -> Table:
    """Return a table ready for queries; ``vectors`` (N, 750) is kept, not copied, where it is float32 already.

    w_global: weight of brightness and contrast, see `vectors.weights`. Raises InputError for another shape,
    an empty table, and entries that are not finite.
    """
    rows = np.asarray(vectors, np.float32)
    if rows.ndim != 2 or rows.shape[1] != LENGTH or not len(rows):
        raise InputError(f"The table has the shape {rows.shape}; (entries, {LENGTH}) with one entry or more is needed.")
    w = weights(w_global)
    norms, outlines = np.empty((len(rows), 2 * SCALES), np.float32), np.empty((OUTLINED_ROWS, len(rows)), np.float32)
    for first in range(0, len(rows), BLOCK):
        here = slice(first, first + BLOCK)
        norms[here], outlines[:, here] = worked_out(rows[here], w)
    if not (np.isfinite(norms).all() and np.isfinite(rows[:, :ISOTROPIC]).all()):
        raise InputError("The table has entries that are NaN or infinite; compute them again.")
    return Table(rows, w, norms, outlines)


def worked_out(vectors: Array, w: Floats) -> tuple[Array, Array]:
    """Return the norms (N, 12) and outlines (72, N) of vectors (N, 750), see `Table`."""
    full = by_scale(w)
    short = outline(vectors)
    outlines = np.empty((OUTLINED_ROWS, len(vectors)), np.float32)
    outlines[:OUTLINE], outlines[OUTLINE:] = short.T, _squared_times(short, full[outlined()]).T
    return _squared_times(vectors, full), outlines


def outline(vectors: Array) -> Array:
    """Return what no turn changes of vectors (N, 750), (N, 60): the first 14 entries, and 4 o for each frequency."""
    oriented = vectors[:, ORIENTED:].reshape(len(vectors), -1, ORIENTATIONS)
    means = oriented @ np.full((ORIENTATIONS, 1), ORIENTATIONS**-0.5, np.float32)
    return np.concatenate([vectors[:, :ORIENTED], means.reshape(len(vectors), -1)], axis=1)


def outlined() -> NDArray[np.intp]:
    """Return the places (60,) in a vector whose weights the outline's numbers have."""
    return np.r_[0:ORIENTED, ORIENTED:LENGTH:ORIENTATIONS]


def by_scale(w: Floats) -> Array:
    """Return w^2 sorted into columns (750, 12), see `Table.norms`; the two of the map itself are in none."""
    found = np.zeros((LENGTH, 2 * SCALES), np.float32)
    of = scales()
    for place in range(ISOTROPIC, LENGTH):
        found[place, of[place] + (0 if place >= ORIENTED else SCALES)] = w[place] ** 2
    return found


def _squared_times(rows: Array, matrix: Array) -> Array:
    """Return rows^2 @ matrix, (N, columns), the same to the last bit for any number of threads."""
    squares = np.zeros((-(-len(rows) // TOGETHER) * TOGETHER, rows.shape[1]), np.float32)
    np.multiply(rows, rows, out=squares[: len(rows)])
    products = np.matmul(squares.reshape(-1, TOGETHER, rows.shape[1]), matrix)
    return products.reshape(-1, matrix.shape[1])[: len(rows)]
