"""sRGB values as linear ones on Dr.Jit arrays, and their mean where they vary."""

from __future__ import annotations

from typing import Any

import drjit as dr

# IEC 61966-2-1, as in voldetail.image.srgb; here on Dr.Jit arrays and with the second derivative.
_ENCODED_PIECE_END = 0.04045
_SLOPE = 12.92
_OFFSET = 0.055
_GAMMA = 2.4


def decoded(encoded: Any, spread: Any = None) -> Any:
    """Return the linear value of an sRGB one, or its mean where the sRGB value has the variance ``spread``."""
    base = dr.maximum((encoded + _OFFSET) * (1.0 / (1.0 + _OFFSET)), 1e-4)
    power = dr.power(base, _GAMMA)
    if spread is not None:
        power = power + spread * dr.power(base, _GAMMA - 2.0) * (0.5 * _GAMMA * (_GAMMA - 1.0) / (1.0 + _OFFSET) ** 2)
    return dr.select(encoded <= _ENCODED_PIECE_END, dr.maximum(encoded, 0.0) * (1.0 / _SLOPE), power)
