"""Mean and deviation of one octave: what eta of GD10 eq. 3 is made of."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import lru_cache
from typing import Any

import drjit as dr
import numpy as np

from voldetail.noise.gabor import NoiseSettings, single_octave

MOMENT_SAMPLES = 4096
MOMENT_SALT = 0x9E3779B9
MOMENT_BLOCK = 16.0
"""Side in cells of the block over which the positions are spread."""

GOLDEN = {2: 1.32471795724474602596, 3: 1.22074408460575947536}
"""Generalised golden ratio per dimension; its negative powers step the Kronecker sequence of positions."""

STEP = 1e-2
"""Step of the central difference for the slope of the moments; their error is about (2 pi STEP)^2 / 6."""


def moments(settings: NoiseSettings, float_type: Any, *numbers: float) -> tuple[float, float]:
    """Return (mean, deviation) of one octave of noise, over fixed low-discrepancy positions and a fixed salt.

    They depend on what is discrete and on ``numbers`` (those of `single_octave`) only, not on the detail's seed.
    `math.fsum` rounds once, so the result does not depend on the order of summation.
    """
    return _moments(replace(settings, octaves=1), float_type, numbers)


def differentiable_moments(settings: NoiseSettings, float_type: Any, *numbers: Any) -> tuple[Any, Any]:
    """Return `moments` as arrays that carry the gradient with respect to ``numbers``."""
    values = tuple(_first(number) for number in numbers)
    mean, deviation = moments(settings, float_type, *values)
    # dr.opaque: the moments change with the numbers and must not become code.
    mean, deviation = dr.opaque(float_type, mean), dr.opaque(float_type, deviation)
    for axis, argument in enumerate(numbers):
        if isinstance(argument, float_type) and dr.grad_enabled(argument):
            # Both moments are smooth in all real numbers, so no end of a range needs a one-sided step.
            below, above = (
                moments(settings, float_type, *(v + sign * STEP * (i == axis) for i, v in enumerate(values)))
                for sign in (-1.0, 1.0)
            )
            offset = argument - dr.detach(argument)
            mean = mean + offset * ((above[0] - below[0]) / (2.0 * STEP))
            deviation = deviation + offset * ((above[1] - below[1]) / (2.0 * STEP))
    return mean, deviation


def _first(value: Any) -> float:
    return float(value) if isinstance(value, int | float) else float(dr.detach(value)[0])


@lru_cache(maxsize=4096)
def _moments(settings: NoiseSettings, float_type: Any, numbers: tuple[float, ...]) -> tuple[float, float]:
    index = np.arange(1, MOMENT_SAMPLES + 1, dtype=np.float64)
    steps = [GOLDEN[settings.dims] ** -(axis + 1) for axis in range(settings.dims)]
    x = tuple(float_type((np.mod(index * step, 1.0) * MOMENT_BLOCK).astype(np.float32)) for step in steps)
    salt = dr.opaque(dr.uint32_array_t(float_type), MOMENT_SALT)
    arrays = (dr.opaque(float_type, number) for number in numbers)
    samples = np.asarray(single_octave(x, settings, salt, *arrays), dtype=np.float64)
    mean = math.fsum(samples) / MOMENT_SAMPLES
    variance = math.fsum((samples - mean) ** 2) / MOMENT_SAMPLES
    return mean, math.sqrt(max(variance, 1e-12))
