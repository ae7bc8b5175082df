"""Starting candidates: what is tried before anything is refined."""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.stats import qmc

from voldetail.detail import MONOTONE_CURVES, PAPER_NEIGHBOURS, PARAMETERS, START_CURVES
from voldetail.fit.profiles import shape_of
from voldetail.fit.ranges import MEDIUM_OCTAVES, OCTAVES
from voldetail.fit.space import MEDIUM_NAMES, Kind, Space, Vector


@dataclass(frozen=True)
class Candidate:
    """A point of the space with what is known of it: its value, the spread still to search, evaluations spent on it.

    covariance: what a search from it learnt about which numbers go together, (n, n), or None.
    """

    kind: Kind
    vector: Vector
    value: float = math.inf
    spread: float = 0.2
    spent: int = 0
    covariance: Vector | None = None


CHARACTERS = (
    (False, "none", False, False, False),
    (True, "none", False, False, False),
    (False, "ridge", False, False, False),
    (False, "billow", False, False, False),
    (False, "none", True, False, False),
    (True, "none", True, False, False),
    (False, "none", False, True, False),
    (False, "none", True, False, True),
)
"""Stripes, fold of H, borders, stones and plates that go together; each is a relief of its own sort, and their products only
multiply choices. The first two are GD10's."""


DIMENSIONS = 14
"""Of the sequence: a number of the noise names the one that it takes (`Parameter.cover`), which families without it may share."""


def sampled(space: Space, count: int, seed: int, anisotropy: tuple[float, float], extended: bool = True) -> list[Candidate]:
    """Return ``count`` candidates that cover choices and numbers evenly (a scrambled Sobol sequence).

    ``anisotropy`` is (factor, angle) of the photo's own spectrum; half of the candidates start from it and half from
    round cells, since the light alone makes any relief look stretched across it. ``extended`` allows what goes beyond
    GD10: folded H, borders, stones, plates and pigment.
    """
    families = [
        (ranks, character)
        for ranks, character in itertools.product(PAPER_NEIGHBOURS, CHARACTERS if extended else CHARACTERS[:2])
        if not (character[2] and ranks != (1, 2))
        and not (character[3] and ranks != (1, 50))
        and not (space.medium and any(character[2:]))  # a cloud has no stones, no plates and no paving
    ]
    generator = qmc.Sobol(d=DIMENSIONS, scramble=True, seed=np.random.default_rng(seed))
    points = generator.random_base2(math.ceil(math.log2(max(count, 2))))[:count]
    out = []
    for index, point in enumerate(points):
        (first, last), (striped, fold, bordered, stones, plates) = families[index % len(families)]
        fewest, most = MEDIUM_OCTAVES if space.medium else OCTAVES
        octaves = fewest + int(point[9] * (most - fewest + 1))
        kind = Kind(
            first,
            last,
            "gaussian" if point[8] < 0.5 else "exponential",
            octaves,
            striped,
            fold,
            bordered,
            extended and space.pigmented and point[10] < 0.5,
            stones,
            plates,
        )
        # Half of them as stretched as the photo, half round.
        turned = (index // len(families)) % 2 == 0
        out.append(Candidate(kind, space.encode(kind, _numbers_at(space, point, anisotropy if turned else None))))
    return out


def _numbers_at(space: Space, point: NDArray[np.float64], anisotropy: tuple[float, float] | None) -> dict[str, float]:
    """Return the numbers at a ``point`` of the sequence; those of ``anisotropy``, if given, are not the sequence's."""
    low, high = space.scale
    rough_low, rough_high = space.roughness
    shape = START_CURVES[MONOTONE_CURVES[int(point[3] * len(MONOTONE_CURVES)) % len(MONOTONE_CURVES)]]
    values = {
        "noise.scale": low * (high / low) ** float(point[0]),
        "roughness": rough_low * (rough_high / rough_low) ** float(point[1]),
        "noise.anisotropy": 1.0 / anisotropy[0] if anisotropy else 1.0,
        "stone_stretch": 1.0,
        "noise.angle": anisotropy[1] if anisotropy else math.pi * float(point[2]),
        "stone_height": 0.5 + 0.6 * float(point[1]),
        "noise.gain": 1.0,
        "plate_gain": 0.1 + 0.4 * float(point[9]),
        "plate_dust": 0.15 * float(point[6]),
        "stone_gain": 0.05 * 8.0 ** float(point[9]),
        "reflectance.speckle_scale": space.finest * 0.5 ** float(point[12]),
        "noise.stripe_spread": math.pi * (1.0 if point[6] < 0.5 else float(point[7])),
    } | {p.key: p.cover.at(float(point[p.cover.dimension])) for p in PARAMETERS if p.cover is not None}
    values |= {f"shape.{i}": float(v) for i, v in enumerate(shape_of(shape))}
    if space.medium:
        # The places of the sequence that pigment and stones, which a medium has not, would take.
        values |= {name: space.at(name, float(point[10 + i])) for i, name in enumerate(MEDIUM_NAMES)}
    return values


PAPER_FREQUENCIES = (0.0, 2.0, 4.0)
PAPER_LACUNARITIES = (1.5, 2.0, 4.0)
PAPER_OCTAVES = (1, 2, 3, 4)
PAPER_SCALES = 5
PAPER_ROUGHNESS = (0.2, 0.6)


def paper_grid(space: Space, anisotropy: tuple[float, float]) -> list[Candidate]:
    """Return GD10's coarse samples: its sets of (k, k'), m, phi and n, the starting curves, and a few scales.

    The envelope is eq. 2's, theta is pi where there are stripes (as in figure 5), the anisotropy that of the spectrum.
    """
    factor, angle = anisotropy
    low, high = space.scale
    out = []
    for (first, last), phi, m, n, curve, step, rough in itertools.product(
        PAPER_NEIGHBOURS,
        PAPER_FREQUENCIES,
        PAPER_LACUNARITIES,
        PAPER_OCTAVES,
        MONOTONE_CURVES,
        range(PAPER_SCALES),
        PAPER_ROUGHNESS if space.amplitude is None else (0.0,),
    ):
        if n == 1 and m != PAPER_LACUNARITIES[0]:
            continue  # with one harmonic m has no effect
        kind = Kind(first, last, "exponential", n, phi > 0)
        values = {
            "noise.scale": low * (high / low) ** ((step + 0.5) / PAPER_SCALES),
            "roughness": max(rough, 1e-3),
            "noise.anisotropy": 1.0 / factor,
            "noise.angle": angle,
            "noise.lacunarity": m,
            "noise.stripe_frequency": phi,
            "noise.stripe_spread": math.pi,
        } | {f"shape.{i}": float(v) for i, v in enumerate(shape_of(START_CURVES[curve]))}
        out.append(Candidate(kind, space.encode(kind, values)))
    return out


def best_distinct(candidates: list[Candidate], count: int) -> list[Candidate]:
    """Return the ``count`` best candidates of different families: ranks, stripes, fold, borders, stones, plates; best first."""
    chosen: list[Candidate] = []
    seen = set()
    for candidate in sorted(candidates, key=lambda c: c.value):
        key = replace(candidate.kind, octaves=1, envelope="", pigment=False)
        if key not in seen:
            seen.add(key)
            chosen.append(candidate)
        if len(chosen) == count:
            break
    return chosen
