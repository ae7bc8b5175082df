"""Patterns that colour what the relief raises: one number for all of a cell, and specks finer than any cell."""

from __future__ import annotations

from typing import Any

import drjit as dr

from voldetail.noise.gabor import NoiseSettings, single_octave
from voldetail.noise.lattice import FOURTH_POINT_RADIUS, Neighbourhood, nearest_points, unit
from voldetail.noise.moments import moments
from voldetail.noise.relief import frame

CELL_SALT = 0x7F4A7C15
"""Multiplies the spare hash word, so that a cell's number is independent of its stripes; odd, else arbitrary."""

SPECK_SALT = 0x4CF5AD43
"""Added to the seed, so that specks do not lie where the relief's points do; odd, else arbitrary."""


def specks(points: tuple[Any, ...], seed: Any) -> Any:
    """Return spots in (-1, 1) at ``points``, in specks: z / sqrt(1 + z^2) of the closest kernel's standard score z."""
    float_type: Any = type(points[0])
    settings = NoiseSettings.from_ranks(len(points), 1, 1, gaussian=True)
    mean, deviation = moments(settings, float_type, 0.0, 0.0)
    none = dr.opaque(float_type, 0.0)
    z = (single_octave(points, settings, seed + SPECK_SALT, none, none) - mean) * (1.0 / deviation)
    return z / dr.sqrt(1.0 + z * z)


def cell_value(points: tuple[Any, ...], seed: Any, *, scale: Any, anisotropy: Any, angle: Any) -> Any:
    """Return the `number_of` the cell of the coarsest octave at ``points``: of what is nearest to one feature point.

    Arguments as in `relief_function`. It jumps at the border of cells and has no gradient.
    """
    x = frame(points, scale, anisotropy, angle)
    _, indices, _ = nearest_points(x, seed, 1)
    around = Neighbourhood(x, seed, FOURTH_POINT_RADIUS[len(points)])
    _, word = around.vector(indices[0])
    return number_of(word, around.float_type)


def number_of(word: Any, float_type: Any) -> Any:
    """Return a number in [0, 1), uniform over the hash words of cells or stones."""
    mixed = word * CELL_SALT
    mixed = (mixed ^ (mixed >> 15)) * CELL_SALT
    return unit(mixed ^ (mixed >> 13), float_type)
