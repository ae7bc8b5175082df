"""The relief library's source: reliefs under one light, so that a library is built light by light as they are needed."""

from __future__ import annotations

import hashlib
import json
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np

from voldetail.detail import Detail
from voldetail.fit.warmstart.exposure import BEYOND, SHARES, TONES
from voldetail.fit.warmstart.pictures import AMBIENT, DIFFUSE, SUBSAMPLES, vectors
from voldetail.fit.warmstart.reliefs import FINE, MOST, SIDE, WINDOW, library_relief
from voldetail.library.building.source import Chunk
from voldetail.library.measures import MeasureName

ELEVATIONS = tuple(range(10, 91, 10))
"""Degrees above the plane of the lights that there are libraries for: a photo's light is within five of one."""

ENTRIES = 4000
"""Reliefs for each light: with half as many, grass had no near one, and twice as many were no nearer (grass, brick and slab)."""

PICTURES_VERSION = 1
"""Counts changes of the pictures that no number in a source's definition tells."""

SAMPLED = 64
"""Reliefs whose numbers stand for all in a source's definition: what decides reliefs is spread over the fit's ranges."""


@dataclass(frozen=True)
class ReliefSource:
    """Reliefs rendered under a light from the right at ``elevation`` degrees; see `reliefs` and `pictures`."""

    elevation: int
    seed: int = 0

    @property
    def name(self) -> str:
        """Relief and its light's elevation."""
        return f"relief {self.elevation}"

    @property
    def keys(self) -> tuple[str, ...]:
        """Some of a detail's numbers, by which a relief is recognised; the relief itself follows from its number."""
        return tuple(_numbers(library_relief(0, self.seed).detail()))

    @property
    def measure(self) -> MeasureName:
        """Reliefs'."""
        return "reliefs"

    @property
    def most(self) -> int:
        """How many reliefs there are at most."""
        return MOST

    @property
    def definition(self) -> dict[str, Any]:
        """The light, what the pictures are made with, and a hash of the first reliefs."""
        return {
            "kind": "relief", "elevation": self.elevation, "side": SIDE, "window": WINDOW, "fine": FINE, "subsamples": SUBSAMPLES,
            "ambient": AMBIENT, "diffuse": DIFFUSE, "tones": [list(SHARES), list(TONES), BEYOND],
            "looks": _hash_of_first(self.seed), "version": PICTURES_VERSION,
        }  # fmt: skip

    @property
    def parallel(self) -> bool:
        """False: the renderer uses all cores."""
        return False

    def chunk(self, first: int, count: int) -> Chunk:
        """Return reliefs first to first + count - 1."""
        reliefs = [library_relief(k, self.seed) for k in range(first, first + count)]
        values = np.array([list(_numbers(one.detail()).values()) for one in reliefs], np.float64)
        return values, np.stack(list(vectors(reliefs, float(self.elevation))))


def _numbers(detail: Detail) -> dict[str, float]:
    noise = detail.noise
    return {
        "first_neighbour": float(noise.first_neighbour), "last_neighbour": float(noise.last_neighbour),
        "octaves": float(noise.octaves), "scale": noise.scale, "anisotropy": noise.anisotropy, "angle": noise.angle,
        "amplitude": detail.relief.amplitude,
    }  # fmt: skip


@lru_cache(maxsize=4)
def _hash_of_first(seed: int) -> str:
    details = [library_relief(k, seed).detail().model_dump(mode="json", exclude={"provenance"}) for k in range(SAMPLED)]
    # Nine digits: the last ones of a power or a sine may be another processor's.
    plain = json.dumps(details, sort_keys=True, default=str)
    rounded = json.dumps(json.loads(plain, parse_float=lambda text: f"{float(text):.9g}"), sort_keys=True)
    return hashlib.sha256(rounded.encode()).hexdigest()
