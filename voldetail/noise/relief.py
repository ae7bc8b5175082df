"""The relief function R (GD10 eq. 3): octaves of cellular-Gabor noise through the curve H.

Symbols
    R(x)    H(1/eta sum_i (q/m)^i N(m^i Q S x)), N one octave (noise.gabor, eq. 2)
    m       lacunarity: octave i has frequency m^i and weight (q/m)^i
    q       gain of each octave over the one before; ours, and 1 in the paper
    S       diag(s f, s, s), Q rotation by `angle` in the surface plane; X = S Q x
    eta     normalisation, chosen here so that the argument of H lies in [-1, 1]
    H       eleven control points (noise.curve)

The paper calls eta a constant and says no more. Octaves use independent points, so mean and deviation of
their sum follow from those of one octave (`moments`): each is brought to mean 0 and deviation 1, which for equal
octaves changes nothing but the constant, and lets stones be followed by plain noise. With z = sum / (ETA deviation of
the sum), the argument of H is z / sqrt(1 + z^2): strictly inside [-1, 1], without the plateaus that clipping would give; what it
bends, the free curve H can unbend.
"""

from __future__ import annotations

from typing import Any

import drjit as dr

from voldetail.noise.curve import evaluate_curve
from voldetail.noise.gabor import TURN, NoiseSettings, octave_and_owner
from voldetail.noise.moments import differentiable_moments
from voldetail.noise.plates import PlateShape
from voldetail.noise.stones import StoneShape

ETA = 1.5
"""Deviations at which the argument of H is 1/sqrt(2); tuned so that all eleven points of H are in use."""

CURVE_POINTS = 11

OCTAVE_NUMBERS = ("lacunarity", "gain", "stripe_frequency", "stripe_spread")
"""Arguments of `relief_function` that are a detail's numbers, by the detail's own names."""

OCTAVE_SALT = 0x632BE5AB
"""Step of the salt from one octave to the next; any odd number does, the hash mixes it."""


def relief_function(
    points: tuple[Any, ...],
    settings: NoiseSettings,
    seed: Any,
    *,
    scale: Any,
    anisotropy: Any,
    angle: Any,
    lacunarity: Any,
    stripe_frequency: Any,
    stripe_spread: Any,
    curve: Any,
    gain: Any = 1.0,
    shape: StoneShape | None = None,
    plates: PlateShape | None = None,
) -> tuple[Any, Any | None]:
    """Return R(x) in [0, 1], eq. 3, at ``points`` (2 or 3 float arrays, scene units), and the hash word of the
    cell or stone that it belongs to in the coarsest octave, None where all points count.

    ``seed`` is a UInt array; ``curve`` a float array of eleven values; the others floats or float arrays of
    width 1, differentiable. ``shape`` is that of the stones where the highest counts, ``plates`` that of
    the plates where settings.plates. Keep what changes opaque (`dr.opaque`), else each value compiles a kernel.
    """
    float_type: Any = type(points[0])
    x = frame(points, scale, anisotropy, angle)
    total = dr.zeros(float_type, dr.width(points[0]))
    weight: Any = float_type(1.0)
    frequency: Any = float_type(1.0)
    owner: Any | None = None
    sum_of_squares: Any = float_type(0.0)
    for octave in range(settings.octaves):
        scaled = tuple(v * frequency for v in x)
        salt = seed + (octave * OCTAVE_SALT & 0xFFFFFFFF)
        own = settings.of_octave(octave)
        numbers: tuple[Any, ...] = (stripe_frequency, stripe_spread)
        if own.highest:
            assert shape is not None, "stones need a shape"
            numbers = shape.numbers
        if own.plates:
            assert plates is not None, "plates need a shape"
            numbers += plates.numbers
        value, word = octave_and_owner(scaled, own, salt, *numbers)
        owner = word if octave == 0 else owner
        mean, deviation = differentiable_moments(own, float_type, *numbers)
        total += (weight / deviation) * (value - mean)
        sum_of_squares += weight * weight
        weight = weight * (gain / lacunarity)
        frequency = frequency * lacunarity
    z = total / (ETA * dr.sqrt(sum_of_squares))
    # Not dr.rsqrt: its last bits come from the processor's own estimate and differ between machines.
    return evaluate_curve(curve, z / dr.sqrt(1.0 + z * z), CURVE_POINTS), owner


def frame(points: tuple[Any, ...], scale: Any, anisotropy: Any, angle: Any) -> tuple[Any, ...]:
    """Return X = S Q x in lattice axes: rotate by -angle in the first two axes, scale, turn (3D)."""
    s, c = dr.sincos(angle)
    x, y, *rest = points
    framed = ((x * c + y * s) * (scale * anisotropy), (y * c - x * s) * scale, *(v * scale for v in rest))
    if len(framed) == 2:
        return framed
    return tuple(sum(float(TURN[row, axis]) * framed[axis] for axis in range(3)) for row in range(3))
