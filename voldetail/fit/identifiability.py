"""Which numbers of a medium one photo tells: those whose change the pictures show.

Each is changed alone, and the reflectance and the background are solved anew each time, as for the relief's amplitude
(fit.interval). A number that may be anything is not told; two that trade against each other (extinction and amplitude,
asymmetry and the light's strength) are told less well than this says, since the other one stays.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from voldetail.detail import Detail, bounds, parameter, values_of, with_values
from voldetail.fit.interval import FACTORS, near
from voldetail.fit.objective import Objective
from voldetail.results.identifiability import Identifiability

ASYMMETRIES = (-0.4, -0.2, 0.0, 0.2, 0.4, 0.6, 0.75, 0.9)
ALBEDOS = (0.2, 0.5, 0.7, 0.85, 0.95, 0.99, 1.0)
"""What is tried where a factor means nothing."""

NUMBERS = ("relief.amplitude", "medium.thickness", "medium.exponent", "medium.extinction", "medium.asymmetry", "medium.albedo")


def medium_identifiability(objective: Objective, detail: Detail, seeds: Sequence[int]) -> tuple[Identifiability, ...]:
    """Return what the photo of ``objective`` tells of each number of the medium ``detail``, by pictures under ``seeds``."""
    other = Objective(objective.target, objective.surface, specular=False, reduced=objective.reduced)
    return tuple(_identifiability(other, detail, key, seeds) for key in NUMBERS)


def _identifiability(objective: Objective, detail: Detail, key: str, seeds: Sequence[int]) -> Identifiability:
    value = float(values_of(detail)[key])
    low, high = bounds(key)
    # Factors are equally far apart on a logarithmic scale.
    logarithmic = parameter(key).scale == "log" or key == "relief.amplitude"
    fixed = {"medium.asymmetry": ASYMMETRIES, "medium.albedo": ALBEDOS}
    tried = sorted({value, *fixed.get(key, tuple(value * factor for factor in FACTORS))})
    tried = [v for v in tried if low <= v <= high]
    changed = [with_values(detail, {key: v}) for v in tried]
    scores = np.array([[e.score for e in objective.evaluate_all(changed, seed)] for seed in seeds]).mean(axis=0)
    places = np.log(tried) if logarithmic else np.array(tried)
    ends = near(places, scores)
    if logarithmic:
        ends = float(np.exp(ends[0])), float(np.exp(ends[1]))
    # Rounding of the logarithm is not to open or close an end.
    least, most = tried[0], tried[-1]
    first, last = (least if ends[0] <= least * (1 + 1e-9) else ends[0]), (most if ends[1] >= most * (1 - 1e-9) else ends[1])
    return Identifiability(key, value, min(first, value), max(last, value), least, most)
