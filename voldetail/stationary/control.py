"""How stationary a tile is, as a choice: a palette of sigmas, spaced evenly for the eye (MJHRW17 section 4.4).

Symbols: sigma_j, the sizes of neighbourhood that were tried; d_j, how much the tiles of sigma_j and sigma_j+1 differ.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.stats import wasserstein_distance

from voldetail.errors import InputError
from voldetail.stationary.colour import to_lab
from voldetail.stationary.tile import SIZE, Tile, TileProgress, stationarize

LEVELS = 5
MOST_LEVELS = 20

NARROWEST, WIDEST = 1 / 32, 1 / 2
"""Ends of a palette, of the tile's side: below, a neighbourhood is a few pixels and its histogram chance; above, it is
the whole tile and asks for nothing."""


@dataclass(frozen=True, eq=False)
class Palette:
    """Tiles of growing sigma, and `distances`, how much each differs from the next; `sigmas` in pixels of the tile;
    `interrupted`: not all that were asked for."""

    sigmas: tuple[float, ...]
    tiles: tuple[Tile, ...]
    distances: tuple[float, ...]
    interrupted: bool = False


def palette(
    photo: NDArray[Any],
    size: int = SIZE,
    *,
    levels: int = LEVELS,
    sigmas: Sequence[float] | None = None,
    even: bool = True,
    on_progress: Callable[[int, int, TileProgress], None] | None = None,
    **options: Any,
) -> Palette:
    """Make tiles of several sigmas with the same seed, from the most stationary to the least (MJHRW17 section 4.4).

    `sigmas` in pixels; default: `levels` of them (2 to 20) from 1/32 to 1/2 of `size`, in equal ratios. With `even`
    they are then moved so that `distance` is about the same from each tile to the next, and the tiles made anew. Further
    `options` are those of `stationarize`. `on_progress` gets the number of the tile, how many there are, and how far it
    is. After Ctrl-C the palette ends with the tiles there are. Raises InputError as `stationarize`.
    """
    if not 2 <= levels <= MOST_LEVELS:
        raise InputError(f"{levels} levels are out of range; give 2 to {MOST_LEVELS}.")
    chosen = tuple(sigmas) if sigmas is not None else spread(size, levels)
    rounds = 2 if even else 1

    def tell(number: int, progress: TileProgress) -> None:
        if on_progress is not None:
            on_progress(number, rounds * len(chosen), progress)

    series = _series(photo, size, chosen, tell, options)
    if not even or series.interrupted:
        return series
    evener = even_sigmas(chosen, series.distances, len(chosen))
    try:
        return _series(photo, size, evener, lambda number, progress: tell(len(chosen) + number, progress), options)
    except KeyboardInterrupt:  # before there was one of the new tiles
        return replace(series, interrupted=True)


def _series(
    photo: NDArray[Any], size: int, sigmas: Sequence[float], tell: Callable[[int, TileProgress], None], options: dict[str, Any]
) -> Palette:
    """One tile of each sigma; after Ctrl-C those that there are, if any."""
    tiles: list[Tile] = []
    interrupted = False
    for number, sigma in enumerate(sigmas):
        try:
            tile = stationarize(photo, size, sigma=sigma, on_progress=lambda progress: tell(number, progress), **options)
        except KeyboardInterrupt:
            if not tiles:
                raise
            interrupted = True
            break
        tiles.append(tile)
        if tile.interrupted:
            interrupted = True
            break
    distances = tuple(distance(a.tile, b.tile) for a, b in pairwise(tiles))
    return Palette(tuple(sigmas[: len(tiles)]), tuple(tiles), distances, interrupted)


def spread(size: int, levels: int) -> tuple[float, ...]:
    """`levels` sigmas in pixels for a tile of `size`, in equal ratios from NARROWEST to WIDEST."""
    return tuple(float(s) for s in np.geomspace(max(size * NARROWEST, 1.0), size * WIDEST, levels))


def distance(a: NDArray[Any], b: NDArray[Any]) -> float:
    """Difference in appearance d of two tiles (N, N, 3), linear: the earth mover's distance of their histograms, summed
    over the channels of CIE L*a*b* and in its unit. It does not mind where things lie."""
    first, second = to_lab(a).reshape(-1, 3), to_lab(b).reshape(-1, 3)
    return float(sum(wasserstein_distance(first[:, c], second[:, c]) for c in range(3)))


def even_sigmas(sigmas: Sequence[float], distances: Sequence[float], count: int) -> tuple[float, ...]:
    """`count` sigmas between the first and the last with the same distance from each to the next, by inverting the sum
    of `distances` along log sigma; equal ratios where all distances are 0."""
    travelled = np.concatenate([[0.0], np.cumsum(distances)])
    log = np.log(np.asarray(sigmas, np.float64))
    if travelled[-1] <= 0:
        return tuple(float(s) for s in np.geomspace(sigmas[0], sigmas[-1], count))
    # Steps of length zero have no inverse; the slightest slope gives them one.
    rising = travelled + 1e-9 * travelled[-1] * np.arange(len(travelled))
    return tuple(float(s) for s in np.exp(np.interp(np.linspace(0, rising[-1], count), rising, log)))


def ramp(size: int, left: float, right: float) -> NDArray[np.float64]:
    """A map of sigmas (size, size) for `stationarize`, from `left` to `right` in equal ratios (MJHRW17 figure 10)."""
    across = np.geomspace(left, right, size)
    return np.broadcast_to(across, (size, size)).copy()
