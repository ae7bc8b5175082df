"""How well one photo tells the relief's amplitude: the heights whose pictures are nearly as near to it as the fit's.

Shading trades height against light and albedo: twice the height under a light twice as steep, with more sky, may look much
the same. So the fitted detail is looked at with other amplitudes, and under a light a little lower and higher than
the one given, and its reflectance is solved anew each time. Its other numbers stay, so the interval is a lower bound of
what is not known.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from voldetail.detail import Detail, bounds
from voldetail.fit.objective import Objective
from voldetail.results.interval import AmplitudeInterval
from voldetail.setup.lamp import Lamp
from voldetail.setup.light import angles_of, direction_of

FACTORS = tuple(2.0 ** (step / 2) for step in range(-4, 5))
"""Of the fitted amplitude, a quarter to four times: more than any photo leaves open that has a shadow in it."""

ELEVATIONS = (-10.0, 0.0, 10.0)
"""Degrees that the light may be lower or higher than it was said to be; a careful guess from a photo is about as good."""

TOLERANCE = 1.1
"""Factor on the lowest distance up to which a picture still counts as near."""


def amplitude_interval(objective: Objective, detail: Detail, seeds: Sequence[int]) -> AmplitudeInterval:
    """Return the AmplitudeInterval of a fitted ``detail``, by pictures under each of the noise ``seeds``.

    Nine pictures for each of them and each of up to three elevations of the light.
    """
    highest = bounds("relief.amplitude")[1]
    factors = [f for f in FACTORS if f * detail.relief.amplitude <= highest] or [1.0]
    lamps = list(_lamps(objective.target.lamp))
    means = np.stack([_scores(_under(objective, lamp), detail, factors, seeds).mean(axis=1) for lamp in lamps])
    given = means[lamps.index(objective.target.lamp)]
    amplitudes = np.array(factors) * detail.relief.amplitude
    low, high = _ends(amplitudes, given)
    ends_any = [_ends(amplitudes, row, float(given.min())) for row in means]
    # The fitted one belongs to it whatever other seeds say: a short search may end beside the lowest.
    low, high = min(low, detail.relief.amplitude), max(high, detail.relief.amplitude)
    return AmplitudeInterval(
        low,
        high,
        min(low, *(end[0] for end in ends_any)),
        max(high, *(end[1] for end in ends_any)),
        tuple(amplitudes.tolist()),
        tuple(given.tolist()),
        tuple(means.min(axis=0).tolist()),
    )


def _lamps(lamp: Lamp) -> Iterator[Lamp]:
    if lamp.near:
        yield lamp
        return
    azimuth, elevation = angles_of(lamp.source)
    for step in ELEVATIONS:
        turned = min(max(elevation + step, 1.0), 90.0)
        yield lamp if step == 0.0 else replace(lamp, direction=direction_of(azimuth, turned))


def _under(objective: Objective, lamp: Lamp) -> Objective:
    # A new one for the given light too: these pictures are no part of the search's evaluations.
    return Objective(
        replace(objective.target, lamp=lamp),
        objective.surface,
        specular=objective.specular,
        subsamples=objective.subsamples,
        reduced=objective.reduced,
    )


def _scores(objective: Objective, detail: Detail, factors: Sequence[float], seeds: Sequence[int]) -> NDArray[np.float64]:
    """Scores (factors, seeds)."""
    amplitude = detail.relief.amplitude
    higher = [
        detail.model_copy(update={"relief": detail.relief.model_copy(update={"amplitude": amplitude * factor})})
        for factor in factors
    ]
    return np.array([[e.score for e in objective.evaluate_all(higher, seed)] for seed in seeds]).T


def near(places: NDArray[np.float64], distances: NDArray[np.float64], best: float = math.inf) -> tuple[float, float]:
    """Return the places about the lowest of ``distances`` between which all are near it, by straight lines between them.

    ``best`` is the lowest distance elsewhere (under another light); what is nowhere near that gives an empty interval.
    """
    lowest = int(np.argmin(distances))
    allowed = TOLERANCE * min(best, float(distances[lowest]))
    if distances[lowest] > allowed:
        return math.inf, -math.inf

    def crossing(step: int) -> float:
        at = lowest
        while 0 <= at + step < len(places) and distances[at + step] <= allowed:
            at += step
        if not 0 <= at + step < len(places):
            return float(places[at])
        share = (allowed - distances[at]) / (distances[at + step] - distances[at])
        return float(places[at] + share * (places[at + step] - places[at]))

    return crossing(-1), crossing(1)


def _ends(amplitudes: NDArray[np.float64], distances: NDArray[np.float64], best: float = math.inf) -> tuple[float, float]:
    low, high = near(np.log(amplitudes), distances, best)
    return (math.exp(low), math.exp(high)) if low <= high else (low, high)
