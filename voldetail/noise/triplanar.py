"""A noise of the plane on a surface without parameters: three coordinate planes blended by the normal, variance kept.

Symbols
    n     the surface's normal
    w_i   n_i^4, the weight of the plane at right angles to axis i: n_i^2 would leave a mixture nearly everywhere
    N_i   the noise in that plane, each of a seed of its own
    N     sum_i w_i N_i / sqrt(sum_i w_i^2)

Plain averages of noises lose contrast where they overlap; independent ones whose weights' squares sum to one keep the variance,
and Gaussian ones their law (Heitz and Neyret, High-performance by-example noise, 2018, for blended tiles). A surface as a whole
has the plane's spectrum only where one plane outweighs the others; between, patterns of different directions overlap. Opposite
sides of an object see a plane from its two sides: on one of them a slanting pattern slants the other way.
"""

from __future__ import annotations

from typing import Any

import drjit as dr

from voldetail.noise.lobes import LobeTable, lobe_noise

PLANE_SALT = 0x9E3779B9
"""Step of the seed from plane to plane; any odd number does, the hash mixes it."""

PLANES = ((2, 1), (0, 2), (0, 1))
"""Axes of each plane's x and y, for the plane at right angles to axis 0, 1, 2: y stays up on the four walls."""


def triplanar(
    points: tuple[Any, Any, Any], normal: tuple[Any, Any, Any], lobes: LobeTable, seed: Any, footprint: Any | None = None
) -> tuple[Any, Any]:
    """Return (N, the variance that is left), float arrays, at ``points`` in texels with the ``normal`` of the surface there.

    The normal need not have length one; a zero normal counts as (0, 0, 1). ``seed`` and ``footprint`` as in `lobe_noise`.
    """
    weights = plane_weights(normal)
    scale = 1.0 / dr.sqrt(sum(dr.square(w) for w in weights))
    total, left = 0.0, 0.0
    for plane, (weight, (first, second)) in enumerate(zip(weights, PLANES, strict=True)):
        own = seed + (plane * PLANE_SALT & 0xFFFFFFFF)
        value, remaining = lobe_noise((points[first], points[second]), lobes, own, footprint)
        total = dr.fma(weight * scale, value, total)
        left = dr.fma(dr.square(weight * scale), remaining, left)
    return total, left


def plane_weights(normal: tuple[Any, Any, Any]) -> list[Any]:
    """Return w_i for the planes at right angles to axis 0, 1, 2, the largest of them 1.

    The normal need not have length one; a zero normal counts as (0, 0, 1).
    """
    size = dr.maximum(dr.maximum(dr.abs(normal[0]), dr.abs(normal[1])), dr.abs(normal[2]))
    flat = size == 0.0
    # Divided by the largest part first: the fourth power of a short normal would underflow.
    parts = [a / dr.select(flat, 1.0, size) for a in normal[:2]]
    parts.append(dr.select(flat, 1.0, normal[2] / dr.select(flat, 1.0, size)))
    return [dr.square(dr.square(a)) for a in parts]
