"""The nearest of a table of descriptors, over all turns and both orders of tones (GKHF14 sections 4 and 5).

    D^2(a, b) = sum_i w_i^2 d_i^2,      d_i^2 = (m_i - m_i')^2 + (s_i - s_i')^2                       (equation 6)

(d_i the 2-Wasserstein distance of two Gaussians, Dowson & Landau 1982.) In means and deviations multiplied by their weights D
is Euclidean, so one product of the table with a few turned copies of the query compares it with all entries. A turn moves
oriented entries only, a swap of tones the others only: D^2 is a sum of a part for each, and the best of both is found apart.

The search is exact: entries are compared in full unless their outlines (see `tables`) tell that they are farther than as many
others as are asked for.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from voldetail.errors import InputError
from voldetail.library.pieces import pieces_of
from voldetail.library.tables import BLOCK, Array, Floats, Table, by_scale, outline, outlined
from voldetail.library.vectors import ISOTROPIC, LENGTH, ORIENTATIONS, ORIENTED, scales, swapped, turned, weights
from voldetail.metric.gabor import GLOBAL

FIRST_LOOK = 2048
"""Entries with the nearest outlines, compared in full to learn how near the nearest are."""

RERANKED = 4
"""Times as many candidates as are asked for are compared again in double precision: sums in single precision are wrong in the
seventh digit of a'W a, which matters between near neighbours only."""

COLUMNS = 1024
"""Outlines in one product: so few that they stay in the processor's cache and that OpenBLAS keeps to the calling thread. In one
thread five times as fast as all at once; on a busy machine, pieces just too large for one take a hundred times as long."""

SLACK = 1e-3
"""Added to the bound on D^2 for the same reason: a hundred times what random tables showed."""


@dataclass(frozen=True)
class Match:
    """An entry near a query: its number in the table, D, radians by which its picture has to be turned counter-clockwise, and
    whether the tones have to be swapped."""

    entry: int
    distance: float
    rotation: float
    swapped: bool


def distance(a: ArrayLike, b: ArrayLike, w_global: float = GLOBAL) -> float:
    """Return D of equation 6 between two vectors (750,); entries that are NaN in either are left out."""
    gaps = np.asarray(a, np.float64) - np.asarray(b, np.float64)
    return float(np.sqrt(np.nansum((weights(w_global) * gaps) ** 2)))


def nearest(
    table: Table,
    query: ArrayLike,
    top: int = 8,
    *,
    rotations: bool = True,
    swap: bool = True,
    among: NDArray[np.intp] | None = None,
) -> tuple[Match, ...]:
    """Return the ``top`` entries nearest to ``query`` (750,), nearest first, each in its best turn and order of tones.

    rotations: False compares pictures as they lie; swap: False keeps the tones. among: numbers of the entries that are compared,
    all by default. Scales that are NaN in the query are left out. Of equal distances the earlier entry is first. Raises
    InputError for a query of another shape or with entries that are not finite where a scale is not missing as a whole, and a
    top under 1.
    """
    asked = np.asarray(query, np.float32)
    check_query(asked, top)
    missing = np.isnan(asked)
    question = _Question(table, np.where(missing, np.float32(0.0), asked), missing, rotations, swap)
    if among is None:
        likely = _candidates(question, min(top * RERANKED, len(table.vectors)))
    else:
        likely = _best(among, question.squares(among), top * RERANKED)
    matches = [question.exact(int(entry)) for entry in likely]
    return tuple(sorted(matches, key=lambda match: (match.distance, match.entry))[:top])


def check_query(asked: Array, top: int) -> None:
    """Raise InputError for what `nearest` refuses."""
    if asked.shape != (LENGTH,):
        raise InputError(f"The query has the shape {asked.shape}; ({LENGTH},) is needed.")
    if top < 1:
        raise InputError(f"{top} entries are asked for; at least one is needed.")
    missing = np.isnan(asked)
    whole = np.isin(scales(), np.setdiff1d(scales(), scales()[~missing]))
    if np.isinf(asked).any() or (missing & ~whole).any() or missing[:ISOTROPIC].any():
        raise InputError("The query has entries that are NaN or infinite; describe the picture again.")


def _candidates(question: _Question, kept: int) -> NDArray[np.intp]:
    """Numbers of the ``kept`` nearest entries, by single precision."""
    bounds = question.bounds()
    count = max(FIRST_LOOK, kept)
    first = np.arange(len(bounds)) if count >= len(bounds) else np.sort(np.argpartition(bounds, count)[:count])
    found = question.squares(first)
    farthest = np.partition(found, kept - 1)[kept - 1]
    bounds[first] = np.inf
    others = np.flatnonzero(bounds <= farthest + SLACK)
    blocks = [question.squares(others[k : k + BLOCK]) for k in range(0, len(others), BLOCK)]
    numbers, squares = np.concatenate([first, others]), np.concatenate([found, *blocks])
    return _best(numbers, squares, kept)


def _best(numbers: NDArray[np.intp], squares: Array, kept: int) -> NDArray[np.intp]:
    """The numbers of the ``kept`` smallest squares."""
    return numbers if len(numbers) <= kept else numbers[np.argpartition(squares, kept - 1)[:kept]]


class _Question:
    """A query in all its turns and orders of tones, multiplied out against one table."""

    def __init__(self, table: Table, known: Array, missing: NDArray[np.bool_], rotations: bool, swap: bool) -> None:
        self.table = table
        self.w2 = np.where(missing, 0.0, table.weights) ** 2
        # The query turned back stands for the entry turned on.
        self.turns = np.stack([turned(known, -step) for step in range(ORIENTATIONS if rotations else 1)])
        self.orders = np.stack([known, swapped(known)] if swap else [known])
        self.counted = np.asarray((by_scale(np.sqrt(self.w2)) > 0).any(axis=0), np.float32)
        oriented, others = self.turns.copy(), self.orders.copy()
        oriented[:, :ORIENTED] = 0.0
        others[:, ORIENTED:] = others[:, :ISOTROPIC] = 0.0
        self.products, self.constants = _multiplied(np.concatenate([oriented, others]), self.w2)
        short = outline(np.where(np.arange(LENGTH) < ISOTROPIC, np.float32(0.0), self.orders))
        short_products, self.short_constants = _multiplied(short, self.w2[outlined()])
        norms = np.repeat(self.counted[:, None], len(short), axis=1)
        self.short_products: Array = np.ascontiguousarray(np.vstack([short_products, norms]).T)

    def bounds(self) -> Array:
        """What D^2 of each entry is at least, (N,)."""
        lower_bounds = []
        for outlines in pieces_of(self.table.outlines):
            of_orders = np.empty((len(self.orders), outlines.shape[1]), np.float32)
            for first in range(0, outlines.shape[1], COLUMNS):
                here = slice(first, first + COLUMNS)
                np.matmul(self.short_products, outlines[:, here], out=of_orders[:, here])
            of_orders += self.short_constants[:, None]
            lower_bounds.append(self._lightness(outlines[0], outlines[1], of_orders))
        return lower_bounds[0] if len(lower_bounds) == 1 else np.concatenate(lower_bounds)

    def squares(self, entries: NDArray[np.intp]) -> Array:
        """D^2 of some entries in their best turn and order."""
        block = self.table.vectors[entries]
        products = block @ self.products + self.constants
        turns = len(self.turns)
        best = products[:, :turns].min(axis=1) + self._lightness(block[:, 0], block[:, 1], products[:, turns:].T)
        return np.asarray(best + self.table.norms[entries] @ self.counted, np.float32)

    def _lightness(self, mean: Array, deviation: Array, of_orders: Array) -> Array:
        """The best order of tones, and contrast. These may weigh so much that only their differences, squared, keep
        enough digits."""
        w = self.w2[:ISOTROPIC].astype(np.float32)
        gaps = [w[0] * (mean - order[0]) ** 2 + of_orders[k] for k, order in enumerate(self.orders)]
        best = gaps[0] if len(gaps) == 1 else np.minimum(gaps[0], gaps[1])
        return np.asarray(best + w[1] * (deviation - self.orders[0, 1]) ** 2, np.float32)

    def exact(self, entry: int) -> Match:
        """An entry compared in double precision."""
        a = self.table.vectors[entry].astype(np.float64)
        of_turns = ((a - self.turns) ** 2 * self.w2)[:, ORIENTED:].sum(axis=1)
        of_orders = ((a - self.orders) ** 2 * self.w2)[:, :ORIENTED].sum(axis=1)
        turn, order = int(np.argmin(of_turns)), int(np.argmin(of_orders))
        return Match(entry, float(np.sqrt(of_turns[turn] + of_orders[order])), turn * np.pi / ORIENTATIONS, bool(order))


def _multiplied(rows: Array, w2: Floats) -> tuple[Array, Array]:
    """Return what entries are multiplied by, -2 W b (entries, rows), and b'W b (rows,)."""
    products = np.ascontiguousarray((-2.0 * w2 * rows).T, np.float32)
    return products, np.asarray((w2 * rows.astype(np.float64) ** 2).sum(axis=1), np.float32)
