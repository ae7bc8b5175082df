"""sRGB encoding and luminance; linear light everywhere else."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

# IEC 61966-2-1: the two pieces of the sRGB transfer curve.
_LINEAR_PIECE_END = 0.0031308
_ENCODED_PIECE_END = 0.04045
_SLOPE = 12.92
_OFFSET = 0.055
_GAMMA = 2.4

REC709 = (0.2126, 0.7152, 0.0722)  # ITU-R BT.709: weights of linear R, G, B in the luminance


def to_srgb(linear: NDArray[Any]) -> NDArray[np.float32]:
    """Encode linear light as sRGB, IEC 61966-2-1; any shape, negative light becomes 0, above 1 is not clipped."""
    x = np.maximum(np.asarray(linear, dtype=np.float32), 0)
    curve = (1 + _OFFSET) * np.power(x, 1 / _GAMMA) - _OFFSET
    return np.where(x <= _LINEAR_PIECE_END, _SLOPE * x, curve).astype(np.float32)


def to_linear(encoded: NDArray[Any]) -> NDArray[np.float32]:
    """Decode sRGB values (0 to 1) to linear light, the inverse of `to_srgb`; any shape, negative becomes 0."""
    x = np.maximum(np.asarray(encoded, dtype=np.float32), 0)
    curve = np.power((x + _OFFSET) / (1 + _OFFSET), _GAMMA)
    return np.where(x <= _ENCODED_PIECE_END, x / _SLOPE, curve).astype(np.float32)


def luminance(linear: NDArray[Any]) -> NDArray[np.float32]:
    """Return the Rec. 709 luminance (H, W) of a linear image (H, W, 3)."""
    return np.asarray(np.asarray(linear, dtype=np.float32) @ np.asarray(REC709, dtype=np.float32))
