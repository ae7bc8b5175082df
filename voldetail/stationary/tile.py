"""From a photo to a tile that repeats without seams and without a pattern (MJHRW17 algorithm 1).

Symbols: e, the exemplar (the photo); f, the tile; S, the measure of stationarity; alpha, how far f's histogram is moved
towards e's in each iteration; sigma, the size of the neighbourhoods that have to look alike.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from voldetail.errors import InputError
from voldetail.stationary.colour import from_lab, to_lab, usable
from voldetail.stationary.levels import Exemplar, Level, checked_size, exemplar, levels
from voldetail.stationary.measure import Measure, check_measure, checked_sigma, stationarity
from voldetail.stationary.patchmatch import centres, differences, enlarged, search
from voldetail.stationary.patchmatch_arrays import PATCH, SEARCH_SIGMA, vote
from voldetail.stationary.patchmatch_source import UNIFORMITY
from voldetail.stationary.patchmatch_vote import carry
from voldetail.stationary.project import match_histogram, project
from voldetail.types import Array

SIZE = 256
"""Side of a tile in pixels if none is given (section 4.1)."""

ALPHA = 0.5
"""Of the first iteration; it falls to 0 in the last, so that patches have the final word. Chosen on two photographs of
the test data (gravel, a metal plate): with 0 the tile's colours stray from the photo's, and 1 costs texture."""


@dataclass(frozen=True)
class Costs:
    """Of a tile: `texture`, eq. 5 as a mean over the tile and over a patch's pixels, in squared CIE L*a*b*; and
    `stationarity`, eq. 1 with its measure and sigma (for a map of sigmas, their median)."""

    texture: float
    stationarity: float


@dataclass(frozen=True)
class TileProgress:
    """How far a tile is: iterations `done` of `planned`, of a pyramid level of `side` pixels; times in seconds; `costs`
    of the present tile where they were asked for."""

    done: int
    planned: int
    side: int
    seconds: float
    seconds_left: float
    costs: Costs | None = None


@dataclass(frozen=True, eq=False)
class Tile:
    """A tile (N, N, 3), linear float32, whose opposite edges meet; `correspondence` (N, N, 2) int32, the row and column
    in the photo of the centre of each pixel's patch; `measure` None: nothing was projected; `interrupted`: stopped
    early, the best so far; `sentence`, what was left out of the photo, or ""."""

    tile: Array
    correspondence: NDArray[np.int32]
    costs: Costs
    measure: Measure | None
    sigma: float
    seed: int
    seconds: float
    interrupted: bool = False
    sentence: str = ""


def stationarize(
    photo: NDArray[Any],
    size: int = SIZE,
    measure: Measure | None = "histogram",
    *,
    sigma: float | NDArray[Any] | None = None,
    alpha: float = ALPHA,
    uniformity: float = UNIFORMITY,
    seed: int = 0,
    mask: NDArray[Any] | None = None,
    with_costs: bool = False,
    on_progress: Callable[[TileProgress], None] | None = None,
) -> Tile:
    """Make a tile of `size` x `size` pixels from a photo, such that it repeats unseen (MJHRW17 algorithm 1).

    `photo` is (H, W, 3) linear, at least as large as the tile; `mask` (H, W), True = use, holes allowed: nothing of
    what it leaves out, nor a NaN, gets into the tile. `measure` says what has to be alike everywhere (see
    `stationarity`), None: nothing, which is plain toroidal PatchMatch. `sigma` is the size of the neighbourhoods that
    have to be alike, in pixels of the tile, default a twelfth of its side; or a map of them (size, size).
    `uniformity` weighs that all of the photo is used alike (eq. 6), `alpha` (0 to 1) that its histogram is kept. The
    same seed gives the same tile, whatever the number of threads. With `with_costs` every progress record has them.
    Ctrl-C after the first pyramid level returns the best so far. Raises InputError for what cannot be used.
    """
    started = time.monotonic()
    pixels, use, left_out = usable(photo, mask)
    size = checked_size(size, use.shape)
    if measure is not None:
        check_measure(measure)
    if not 0 <= alpha <= 1:
        raise InputError(f"alpha {alpha:g} is out of range; it has to be 0 to 1.")
    if not uniformity >= 0:
        raise InputError(f"uniformity {uniformity:g} is out of range; it has to be 0 or more.")
    widths = _sigmas(sigma, size)
    maker = _Maker(pixels, use, levels(size, use.shape), measure, widths, alpha, uniformity, seed)
    interrupted = False
    try:
        for done, level in maker.run():
            if on_progress is not None:
                spent = time.monotonic() - started
                seen = maker.costs() if with_costs else None
                on_progress(TileProgress(done, maker.planned, level.side, spent, spent * maker.left(done), seen))
    except KeyboardInterrupt:
        if maker.finished_levels == 0:
            raise
        interrupted = True
        maker.finish()
    correspondence = centres(maker.field, use.shape[1])
    words = f"{left_out} pixels of the photo that are NaN or infinite were not used." if left_out else ""
    seconds = time.monotonic() - started
    tile = carry(correspondence, pixels)
    costs = maker.final_costs(tile)
    return Tile(tile, correspondence, costs, measure, float(np.median(widths)), seed, seconds, interrupted, words)


def _sigmas(sigma: float | NDArray[Any] | None, size: int) -> float | NDArray[np.float64]:
    """The sigma or map of sigmas in pixels of the tile, checked."""
    if sigma is None or np.ndim(sigma) == 0:
        return checked_sigma(None if sigma is None else float(sigma), (size, size))
    found = np.asarray(sigma, np.float64)
    if found.shape != (size, size):
        raise InputError(f"The map of sigmas has the shape {found.shape}; give one of the tile's, ({size}, {size}).")
    for value in (found.min(), found.max()):  # a NaN is either
        checked_sigma(float(value), (size, size))
    return found


class _Maker:
    """Algorithm 1 with its state: the field and the tile of the present level."""

    def __init__(
        self, photo: Array, use: NDArray[np.bool_], plan: list[Level], measure: Measure | None,
        sigma: float | NDArray[np.float64], alpha: float, uniformity: float, seed: int,
    ) -> None:  # fmt: skip
        self.photo, self.use, self.plan, self.measure, self.sigma = photo, use, plan, measure, sigma
        self.alpha, self.uniformity = alpha, uniformity
        self.rng = np.random.default_rng(seed)
        self.planned = sum(level.iterations for level in plan)
        self.finished_levels = 0
        self.level = plan[0]
        self.example: Exemplar
        self.field: NDArray[np.uint32]
        self.tile: Array

    def run(self) -> Iterator[tuple[int, Level]]:
        """Go through all levels and iterations; yields the number of iterations done, and the level, after each."""
        done = 0
        for level in self.plan:
            self._enter(level)
            for _ in range(level.iterations):
                self._iterate(done)
                done += 1
                yield done, level
            self.finished_levels += 1

    def finish(self) -> None:
        """Bring the present field to the last level without searching on."""
        if self.level is not self.plan[-1]:
            self._enter(self.plan[-1])

    def _enter(self, level: Level) -> None:
        """Start a level: from pixels of the photo at random, or with the field of the level above."""
        example = exemplar(self.photo, self.use, level)
        if self.finished_levels == 0:
            field = example.source.random(self.rng, level.side**2).reshape(level.side, level.side)
            pixels = example.lab[example.use]
            tile = pixels[self.rng.integers(0, len(pixels), field.shape)]
        else:
            field = enlarged(self.field, self.example.source.shape, example.source, level.side)
            tile = vote(field, example.lab, SEARCH_SIGMA)
        self.level, self.example, self.field, self.tile = level, example, field, tile

    def _iterate(self, done: int) -> None:
        level, tile = self.level, self.tile
        tile = match_histogram(tile, self.example.quantiles, self.alpha * (1 - done / max(self.planned - 1, 1)))
        if self.measure is not None:
            tile = project(tile, self.measure, self._sigma(level), level.spacing)
        self.field, _ = search(tile, self.example.source, self.field, rng=self.rng, sweep=done, uniformity=self.uniformity)
        self.tile = vote(self.field, self.example.lab, SEARCH_SIGMA)

    def _sigma(self, level: Level) -> float | NDArray[np.float64]:
        """sigma in pixels of the level."""
        if isinstance(self.sigma, float):
            return max(self.sigma * level.scale, 1.0)
        place = ((np.arange(level.side) + 0.5) / level.scale).astype(np.int64)
        return np.maximum(self.sigma[np.ix_(place, place)] * level.scale, 1.0)

    def left(self, done: int) -> float:
        """Work left against work done; an iteration takes as long as its tile has pixels."""
        work = [level.side**2 for level in self.plan for _ in range(level.iterations)]
        return sum(work[done:]) / sum(work[:done])

    def costs(self) -> Costs:
        """Costs of the present tile, with the present field for eq. 5's most similar patches."""
        return self._costs(differences(self.tile, self.example.source, self.field))

    def final_costs(self, tile: Array) -> Costs:
        """As `costs`, for the tile that is returned, after one more search on it: closer to eq. 5's minimum."""
        self.tile = to_lab(tile)
        _, found = search(self.tile, self.example.source, self.field, rng=self.rng)
        return self._costs(found)

    def _costs(self, found: NDArray[np.float32]) -> Costs:
        texture = float(found.mean(dtype=np.float64)) / PATCH**2
        sigma = float(np.median(self._sigma(self.level)))
        even = stationarity(from_lab(self.tile), measure=self.measure or "histogram", sigma=sigma, toroidal=True)
        return Costs(texture, even.value)
