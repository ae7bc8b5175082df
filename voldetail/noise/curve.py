"""The curve H that shapes the distribution of the noise (GD10 section 4, below eq. 3)."""

from __future__ import annotations

from typing import Any

import drjit as dr


def evaluate_curve(points: Any, t: Any, count: int) -> Any:
    """Return H(t): piecewise linear through ``count`` equally spaced control points over t in [-1, 1].

    ``points`` is a Dr.Jit float array of ``count`` values in [0, 1]; differentiable in both. GD10 prints
    t / n_H for the position in the table; with t in [-1, 1] the position that reaches every control point is
    (t + 1) (count - 1) / 2, which is what is computed.
    """
    position = dr.clip((t + 1.0) * (0.5 * (count - 1)), 0.0, count - 1.0)
    uint_type = dr.uint32_array_t(type(position))
    index = dr.minimum(uint_type(dr.detach(position)), count - 2)
    fraction = position - type(position)(index)
    low = dr.gather(type(position), points, index)
    high = dr.gather(type(position), points, index + 1)
    return dr.fma(high - low, fraction, low)
