"""The reliefs of the library whose pictures are nearest to a photo under its light, as starts of a fit."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from voldetail.fit.starts import Start
from voldetail.fit.target import Target
from voldetail.metric import describe
from voldetail.metric.rows import distances
from voldetail.scene.setup import Setup
from voldetail.scene.view import view_of
from voldetail.start.exposure import exposed
from voldetail.start.light import Turned, direction_at_zone, turned
from voldetail.start.looks import Look, seen_through

MIRRORS = (False, True)


@dataclass(frozen=True, eq=False)
class Reliefs:
    """Looks with their rows (N, L) under a light from the right at ``elevation`` degrees."""

    elevation: float
    looks: Sequence[Look]
    rows: NDArray[np.floating]


@dataclass(frozen=True)
class Found:
    """A relief near a photo: its number, whether it has to be mirrored, its distance times its kind's handicap."""

    number: int
    mirrored: bool
    distance: float


def nearest_reliefs(target: Target, setup: Setup, reliefs: Reliefs, top: int) -> tuple[tuple[Found, ...], tuple[Start, ...]]:
    """Return the ``top`` reliefs nearest to the photo by the default metric, nearest first, and the starts that they make.

    Raises InputError where the mask leaves too little of the zone at the library's size.
    """
    view = view_of(setup.camera, target.shape, target.zone, setup.photo.resolution)
    azimuth, _ = direction_at_zone(target.lamp, view)
    asked = turned(target, azimuth)
    found = []
    for mirrored in MIRRORS:
        for number, apart in enumerate(_distances(asked.mirrored() if mirrored else asked, reliefs.rows)):
            found.append(Found(number, mirrored, apart * reliefs.looks[number].kind.handicap))
    best = tuple(sorted(found, key=lambda f: f.distance)[:top])
    window = max(view.rows, view.columns) * view.pixel
    return best, tuple(seen_through(reliefs.looks[f.number], window, azimuth, f.mirrored) for f in best)


def _distances(asked: Turned, rows: NDArray[np.floating]) -> NDArray[np.float64]:
    return distances(describe(exposed(asked.picture, asked.mask), asked.mask), rows)
