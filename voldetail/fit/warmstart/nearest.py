"""The reliefs of the library whose pictures are nearest to a photo under its light, as starts of a fit."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from voldetail.fit.warmstart.exposure import exposed
from voldetail.fit.warmstart.light import Turned, direction_at_zone, turned
from voldetail.fit.warmstart.reliefs import library_relief, seen_through
from voldetail.fit.warmstart.start import Start
from voldetail.library.groups import Series
from voldetail.metric import describe
from voldetail.metric.vector import distances
from voldetail.results import Target
from voldetail.setup.setup import Setup
from voldetail.setup.view import view_of

MIRRORS = (False, True)


@dataclass(frozen=True)
class NearRelief:
    """A relief near a photo: its number, whether it has to be mirrored, its distance times its kind's penalty."""

    number: int
    mirrored: bool
    distance: float


def nearest_reliefs(target: Target, setup: Setup, series: Series, top: int) -> tuple[tuple[NearRelief, ...], tuple[Start, ...]]:
    """Return the ``top`` reliefs nearest to the photo by the default metric, nearest first, and the starts that they make.

    Raises InputError where the mask leaves too little of the zone at the library's size.
    """
    view = view_of(setup.camera, target.shape, target.zone, setup.photo.resolution)
    azimuth, _ = direction_at_zone(target.lamp, view)
    asked = turned(target, azimuth)
    reliefs, vectors = [library_relief(k, series.seed) for k in range(len(series.vectors))], series.vectors[:]
    penalties = np.array([one.kind.penalty for one in reliefs])
    # One row of distances for each side of the light; the same order on every machine where two are equal.
    apart = np.stack([_distances(asked.mirrored() if mirrored else asked, vectors) * penalties for mirrored in MIRRORS])
    order = np.argsort(apart.ravel(), kind="stable")[:top]
    best = tuple(NearRelief(int(k) % len(reliefs), MIRRORS[int(k) // len(reliefs)], float(apart.ravel()[k])) for k in order)
    window = max(view.rows, view.columns) * view.pixel
    return best, tuple(seen_through(reliefs[f.number], window, azimuth, f.mirrored) for f in best)


def _distances(asked: Turned, vectors: NDArray[np.floating]) -> NDArray[np.float64]:
    return distances(describe(exposed(asked.picture, asked.mask), asked.mask), vectors)
