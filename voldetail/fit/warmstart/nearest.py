"""The reliefs of the library whose pictures are nearest to a photo under its light, as starts of a fit."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from voldetail.fit.warmstart.exposure import exposed
from voldetail.fit.warmstart.light import Turned, direction_at_zone, turned
from voldetail.fit.warmstart.reliefs import look, seen_through
from voldetail.fit.warmstart.start import Start
from voldetail.library.groups import Series
from voldetail.metric import describe
from voldetail.metric.vector import distances
from voldetail.results import Target
from voldetail.setup.setup import Setup
from voldetail.setup.view import view_of

MIRRORS = (False, True)


@dataclass(frozen=True)
class Found:
    """A relief near a photo: its number, whether it has to be mirrored, its distance times its kind's penalty."""

    number: int
    mirrored: bool
    distance: float


def nearest_reliefs(target: Target, setup: Setup, reliefs: Series, top: int) -> tuple[tuple[Found, ...], tuple[Start, ...]]:
    """Return the ``top`` reliefs nearest to the photo by the default metric, nearest first, and the starts that they make.

    Raises InputError where the mask leaves too little of the zone at the library's size.
    """
    view = view_of(setup.camera, target.shape, target.zone, setup.photo.resolution)
    azimuth, _ = direction_at_zone(target.lamp, view)
    asked = turned(target, azimuth)
    looks, rows = [look(k, reliefs.seed) for k in range(len(reliefs.rows))], reliefs.rows[:]
    penalties = np.array([one.kind.penalty for one in looks])
    # One row for each side of the light; the same order on every machine where two are equal.
    apart = np.stack([_distances(asked.mirrored() if mirrored else asked, rows) * penalties for mirrored in MIRRORS])
    order = np.argsort(apart.ravel(), kind="stable")[:top]
    best = tuple(Found(int(k) % len(looks), MIRRORS[int(k) // len(looks)], float(apart.ravel()[k])) for k in order)
    window = max(view.rows, view.columns) * view.pixel
    return best, tuple(seen_through(looks[f.number], window, azimuth, f.mirrored) for f in best)


def _distances(asked: Turned, rows: NDArray[np.floating]) -> NDArray[np.float64]:
    return distances(describe(exposed(asked.picture, asked.mask), asked.mask), rows)
