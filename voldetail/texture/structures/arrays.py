"""The few functions that the structures need, for NumPy arrays and for Dr.Jit's alike."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from typing import Any

import drjit as dr
import numpy as np

Function = Callable[..., Any]


@dataclass(frozen=True)
class Functions:
    """Functions of one kind of array; `select(condition, a, b)`, `whole` a float array as unsigned integers that wrap,
    `real` unsigned integers as floats, `words` a seed as an array of one unsigned integer."""

    floor: Function
    sqrt: Function
    sin: Function
    cos: Function
    atan2: Function
    exp: Function
    tanh: Function
    minimum: Function
    maximum: Function
    select: Function
    whole: Function
    real: Function
    words: Function


NUMPY = Functions(
    np.floor, np.sqrt, np.sin, np.cos, np.arctan2, np.exp, np.tanh, np.minimum, np.maximum, np.where,
    whole=lambda x: x.astype(np.int32).view(np.uint32),
    real=lambda x: x.astype(np.float32),
    words=lambda seed: np.array([seed & 0xFFFFFFFF], np.uint32),
)  # fmt: skip


def functions(x: Any) -> Functions:
    """Return the functions for arrays such as ``x``: float32, NumPy's or Dr.Jit's."""
    kind: Any = type(x)
    return NUMPY if isinstance(x, np.ndarray) else _drjit(kind)


@cache
def _drjit(kind: Any) -> Functions:
    signed, unsigned = dr.int32_array_t(kind), dr.uint32_array_t(kind)
    return Functions(
        dr.floor, dr.sqrt, dr.sin, dr.cos, dr.atan2, dr.exp, dr.tanh, dr.minimum, dr.maximum, dr.select,
        whole=lambda x: dr.reinterpret_array(unsigned, signed(x)),
        real=kind,
        words=lambda seed: unsigned(seed & 0xFFFFFFFF),
    )  # fmt: skip


def clip(x: Any, lower: float, upper: float) -> Any:
    """Return ``x`` held between two numbers."""
    f = functions(x)
    return f.minimum(f.maximum(x, lower), upper)


def ramp(x: Any) -> Any:
    """Return 0 for ``x`` under 0, 1 for it over 1, and the cubic 3x^2 - 2x^3 between."""
    t = clip(x, 0.0, 1.0)
    return t * t * (3.0 - 2.0 * t)
