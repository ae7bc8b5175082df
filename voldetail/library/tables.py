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
from voldetail.library.vectors import ISOTROPIC, LENGTH, ORIENTATIONS, ORIENTED, scales, weights
from voldetail.metric.gabor import GLOBAL, SCALES

Array = NDArray[np.float32]
Floats = NDArray[np.float64]

BLOCK = 8192
"""Entries worked on at once: 24 MB of the table."""

OUTLINE = ORIENTED + (LENGTH - ORIENTED) // ORIENTATIONS
"""Numbers of an outline: 60."""


@dataclass(frozen=True, eq=False)
class Table:
    """Descriptors (N, 750) float32, with weights w (750,).

    norms: a'W a of each entry by scale, (N, 12), the oriented entries in the first six columns, the isotropic ones in the
    others. outlines: (72, N), an entry a column, its outline and then the same norms of that; so few rows are multiplied
    several times faster than so few columns.
    """

    vectors: Array
    weights: Floats
    norms: Array
    outlines: Array


def table(vectors: ArrayLike, w_global: float = GLOBAL) -> Table:
    """Return a table ready for queries; ``vectors`` (N, 750) is kept, not copied, where it is float32 already.

    w_global: weight of brightness and contrast, see `vectors.weights`. Raises InputError for another shape,
    an empty table, and entries that are not finite.
    """
    rows = np.asarray(vectors, np.float32)
    if rows.ndim != 2 or rows.shape[1] != LENGTH or not len(rows):
        raise InputError(f"The table has the shape {rows.shape}; (entries, {LENGTH}) with one entry or more is needed.")
    w = weights(w_global)
    found = Table(
        rows, w, np.empty((len(rows), 2 * SCALES), np.float32), np.empty((OUTLINE + 2 * SCALES, len(rows)), np.float32),
    )  # fmt: skip
    full, short = by_scale(w), by_scale(w)[outlined()]
    for first in range(0, len(rows), BLOCK):
        here = slice(first, first + BLOCK)
        found.norms[here] = (rows[here] ** 2) @ full
        outlines = outline(rows[here]).T
        found.outlines[:OUTLINE, here] = outlines
        found.outlines[OUTLINE:, here] = short.T @ outlines**2
    if not (np.isfinite(found.norms).all() and np.isfinite(rows[:, :ISOTROPIC]).all()):
        raise InputError("The table has entries that are NaN or infinite; compute them again.")
    return found


def outline(vectors: Array) -> Array:
    """Return what no turn changes of vectors (N, 750), (N, 60): the first 14 entries, and 4 o for each frequency."""
    oriented = vectors[:, ORIENTED:].reshape(-1, ORIENTATIONS)
    means = oriented @ np.full(ORIENTATIONS, ORIENTATIONS**-0.5, np.float32)
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
