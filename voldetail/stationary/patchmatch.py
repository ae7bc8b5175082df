"""Toroidal PatchMatch: for each patch of a tile the most similar one of a source (MJHRW17 section 4.2; Barnes et al. 2009).

Every pixel of the tile, its edges included, has a patch; neighbourhoods and neighbours wrap around. All pixels look at
the same candidates in one step (the neighbour's match, or a random one near the present match), so that a step is one
data-parallel kernel.
"""

from __future__ import annotations

from typing import Any

import drjit as dr
import numpy as np
from drjit.llvm import Float, UInt32
from numpy.typing import NDArray
from scipy import ndimage

from voldetail.stationary.patchmatch_arrays import RADIUS, packed, pixel_numbers, squared_difference, wrapped
from voldetail.stationary.patchmatch_source import NEVER, Source

Field = NDArray[np.uint32]

DIRECTIONS = ((0, 1), (0, -1), (1, 0), (-1, 0))
JUMPS = (1, 4, 2, 8)
"""Distances over which good matches are passed on besides 1, in turn: a serial scan carries a match across the whole
tile in one sweep, and a parallel step only as far as it looks."""

COUNT_EVERY = 2
"""Candidates looked at between two counts of how often each patch is used. Counted once a sweep, all pixels would flee
one patch and crowd the next, and the use never become even; a count costs as much as one or two candidates."""

SHRINK = 0.5
"""Each random search looks this much nearer than the one before (alpha of Barnes et al. 2009, section 3.2)."""


def search(
    tile: NDArray[Any],
    source: Source,
    field: Field,
    *,
    rng: np.random.Generator,
    sweep: int = 0,
    uniformity: float = 0.0,
    reach: float | None = None,
) -> tuple[Field, NDArray[np.float32]]:
    """One sweep of propagation and random search; returns the field and the patches' differences, both (N, M).

    `tile` (N, M, C) is compared with `source`; `field` names the present patches by their first pixels (none may be
    outside the mask). Costs are sums over a patch of squared differences, plus `uniformity` (0: none) for patches used
    more often than others. `sweep` counts the calls: it picks the jumps. `reach` is the widest random step in pixels,
    default the whole source.
    """
    matcher = _Matcher(tile, source, field, uniformity)
    height, width = field.shape
    for jump in (1, JUMPS[sweep % len(JUMPS)]) if JUMPS[sweep % len(JUMPS)] > 1 else (1,):
        for dy, dx in DIRECTIONS:
            row, column = np.divmod(np.roll(matcher.field(), (jump * dy, jump * dx), axis=(0, 1)), source.shape[1])
            matcher.offer(source.inside(row.astype(np.int64) + jump * dy, column.astype(np.int64) + jump * dx))
    matcher.offer(source.random(rng, height * width).reshape(height, width))
    distance = min(reach or np.inf, max(source.shape)) * SHRINK
    while distance >= 1:
        row, column = np.divmod(matcher.field().astype(np.int64), source.shape[1])
        dy, dx = np.rint(distance * rng.uniform(-1, 1, (2, height, width))).astype(np.int64)
        matcher.offer(source.inside(row + dy, column + dx))
        distance *= SHRINK
    return matcher.field(), matcher.difference()


def differences(tile: NDArray[Any], source: Source, field: Field) -> NDArray[np.float32]:
    """Sum of squared differences (N, M) between each patch of the tile and the one that `field` names."""
    return _Matcher(tile, source, field, 0.0).difference()


class _Matcher:
    """The best match so far of every pixel."""

    def __init__(self, tile: NDArray[Any], source: Source, field: Field, uniformity: float) -> None:
        self.shape = field.shape
        height, width = field.shape
        self.source = source
        self.tile, self.stride = packed(wrapped(tile)), dr.opaque(UInt32, width + 2 * RADIUS)
        self.at = pixel_numbers(height, width, width + 2 * RADIUS)
        self.uniformity, self.looked_at = uniformity, 0
        self.penalty = source.penalty(field, uniformity)
        self.best = field.ravel().copy()
        self.cost = self._difference(self.at, self.best, np.full(field.size, NEVER, np.float32))

    def _difference(self, at: Field, patch: Field, limit: NDArray[np.float32]) -> NDArray[np.float32]:
        where, which, most = UInt32(at), UInt32(patch), Float(limit)
        dr.make_opaque(self.tile, where, which, most)
        source = self.source
        return np.array(squared_difference(self.tile, self.stride, where, source.picture, source.width, which, most))

    def offer(self, candidates: Field) -> None:
        """Take each pixel's candidate where it is better."""
        if self.uniformity and self.looked_at and self.looked_at % COUNT_EVERY == 0:
            self.penalty = self.source.penalty(self.best, self.uniformity)
        self.looked_at += 1
        patch = candidates.ravel()
        # What a candidate may differ by, given what it costs for being used often.
        limit = self.cost + self.penalty[self.best] - self.penalty[patch]
        # Neighbours that agree offer what a pixel has already: most of them, once matches cover whole regions.
        asked = np.flatnonzero((patch != self.best) & (limit > 0))
        if len(asked) == 0:
            return
        found = self._difference(self.at[asked], patch[asked], limit[asked])
        better = found < limit[asked]
        taken = asked[better]
        self.best[taken], self.cost[taken] = patch[taken], found[better]

    def field(self) -> Field:
        return self.best.reshape(self.shape).copy()

    def difference(self) -> NDArray[np.float32]:
        return self.cost.reshape(self.shape)


def centres(field: Field, source_width: int) -> NDArray[np.int32]:
    """The source pixel (row, column) at the centre of every pixel's patch: (N, M, 2)."""
    row, column = np.divmod(field.astype(np.int64), source_width)
    return np.stack([row + RADIUS, column + RADIUS], axis=-1).astype(np.int32)


def from_centres(correspondence: NDArray[Any], source_width: int) -> Field:
    """The inverse of `centres`."""
    first = np.asarray(correspondence, np.int64) - RADIUS
    return np.asarray(first[..., 0] * source_width + first[..., 1], np.uint32)


def enlarged(field: Field, old: tuple[int, int], new: Source, side: int) -> Field:
    """A field of a smaller tile and source (of shape `old`) as one of `side` x `side` pixels for the source `new`.

    Each pixel takes the match of the pixel it came from, moved by as much as it moved itself. Where that is in a hole
    of the mask, the nearest patch that is not.
    """
    small = field.shape[0]
    scale = side / small
    place = (np.arange(side) + 0.5) / scale - 0.5
    nearest = np.rint(place).astype(np.int64)
    row, column = np.divmod(field[np.ix_(nearest % small, nearest % small)].astype(np.int64), old[1])
    # Centres scale with the picture; the first pixels follow from them.
    y = (row + RADIUS + (place - nearest)[:, None] + 0.5) * (new.shape[0] / old[0]) - 0.5 - RADIUS
    x = (column + RADIUS + (place - nearest)[None, :] + 0.5) * (new.shape[1] / old[1]) - 0.5 - RADIUS
    return allowed(new.inside(np.rint(y).astype(np.int64), np.rint(x).astype(np.int64)), new)


def allowed(field: Field, source: Source) -> Field:
    """The field with every patch that the mask forbids replaced by the nearest that it allows."""
    if source.free.all():
        return field
    rows, columns = ndimage.distance_transform_edt(~source.free, return_distances=False, return_indices=True)
    nearest = (rows * source.shape[1] + columns).ravel()
    return np.asarray(nearest[field], np.uint32)
