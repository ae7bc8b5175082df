"""Whether what is seen is shading at all: relief changes fastest along the light.

Of a relief that is alike in all directions and shaded as in recover.linear, the mean square of the derivative of d along the
light is three times that across it, J_along = 3 J_across, since E[(a . w)^4] = 3 E[(a . w)^2 (b . w)^2] over directions of w.
Of paint both are equal, and of relief lit from elsewhere across is more. So

    e = (J_along - J_across) / (J_along + J_across)

is 1/2 for shading under the light that was given, 0 for paint, and negative where the light comes from a right angle to that.
Ripples and grain change it too: it is evidence and no proof.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from voldetail.recover.light_map import LightMap

OF_RELIEF = 0.5
"""e of an isotropic relief under the light that was given."""

NONE_SEEN, CONTRADICTED = 0.06, -0.15
"""e below which no relief shows, and below which the light is likely another. Looked at on the scans, bare and painted, at the
light that was given and turned by 90 degrees."""

LEAST_DETAIL = 0.01
"""Root mean square of d below which there is nothing to see: of 8 bits, about two steps."""

LEAST_SIDEWAYS = 0.1
"""|l_xy| below which a light comes from the front and has no side."""


@dataclass(frozen=True)
class Evidence:
    """ratio: e, None where the light has no side. confidence: 0 to 1. notes: sentences for the user, none where nothing is to be
    said."""

    ratio: float | None
    confidence: float
    notes: tuple[str, ...] = ()


def evidence(detail: NDArray[np.float32], weight: NDArray[np.float32], light: LightMap) -> Evidence:
    """Return how much of ``detail`` (H, W) looks like shading under ``light``; ``weight`` (H, W) says what was read."""
    read = weight > 0
    if not read.any() or float(np.sqrt(np.mean(detail[read] ** 2))) < LEAST_DETAIL:
        return Evidence(0.0, 0.0, ("No relief is seen: the photo is even.",))
    down, right = (np.asarray(g, np.float32) for g in np.gradient(detail))
    lx, ly = light.direction[..., 0], light.direction[..., 1]
    across = np.hypot(lx, ly)
    sided = read & (across > LEAST_SIDEWAYS)
    if sided.sum() < 64:
        return Evidence(None, 0.25, ("The light comes from the front: relief shows by its steepness alone, and not which way.",))
    ax, ay = lx[sided] / across[sided], ly[sided] / across[sided]
    gx, gy = right[sided], -down[sided]
    along, beside = float(np.mean((ax * gx + ay * gy) ** 2)), float(np.mean((ay * gx - ax * gy) ** 2))
    ratio = (along - beside) / max(along + beside, 1e-12)
    notes: tuple[str, ...] = ()
    if ratio < CONTRADICTED:
        notes = (
            "The light contradicts the photo: its patterns change faster across that light than along it; check the azimuth.",
        )
    elif ratio < NONE_SEEN:
        notes = ("Little relief is seen: patterns change as fast across the light as along it, as those of paint do.",)
    return Evidence(ratio, float(np.clip(ratio / OF_RELIEF, 0.0, 1.0)), notes)
