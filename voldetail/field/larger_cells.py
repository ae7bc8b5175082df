"""The one way in which cells become larger until what they cost is allowed: memory, or the time of a fit."""

from __future__ import annotations

import math
from collections.abc import Callable

UNKNOWN_STEP = 1.25
"""Factor on the edge where it is only known that the cost is too high, and not how high."""

FURTHEST = 1e6
"""Scene units: an edge beyond which nothing is gained by larger cells."""


def affordable_edge(edge: float, cost: Callable[[float], float], *, least_step: float, trust: float) -> float:
    """Return ``edge``, or the first larger one whose cost is at most 1; infinity where none is.

    ``cost`` of an edge is over what is allowed, infinite where it is not known. Cells go with the third power of the edge, which
    therefore grows by ``trust`` times the third root of the cost, and by ``least_step`` at least.
    """
    while edge < FURTHEST:
        share = cost(edge)
        if share <= 1.0:
            return edge
        edge *= UNKNOWN_STEP if math.isinf(share) else max(least_step, trust * share ** (1 / 3))
    return math.inf
