"""What belongs to a cell: one number for all positions whose closest feature point is the same."""

from __future__ import annotations

from typing import Any

import drjit as dr

from voldetail.noise.gabor import frame
from voldetail.noise.grains import GrainShape, highest_grain
from voldetail.noise.lattice import FOURTH_POINT_RADIUS, Neighbourhood, nearest_points, unit
from voldetail.noise.octave import NoiseSettings

CELL_SALT = 0x7F4A7C15
"""Multiplies the spare hash word, so that a cell's number is independent of its stripes; odd, else arbitrary."""


def cell_value(
    points: tuple[Any, ...], settings: NoiseSettings, seed: Any, *, scale: Any, anisotropy: Any, angle: Any,
    facets: Any = 0.0, elongation: Any = 1.0, size_spread: Any = 0.0,
) -> Any:
    """Return a number in [0, 1), uniform over cells of the coarsest octave and constant in each, at ``points``.

    Arguments as in `relief_function`. A cell is what is nearest to one feature point or, where the highest grain counts,
    what is seen of one grain. The number jumps at the border of cells and has no gradient.
    """
    x = tuple(dr.detach(v) for v in frame(points, scale, anisotropy, angle))
    if settings.highest:
        _, word = highest_grain(x, seed, GrainShape(facets, elongation, size_spread), settings.gaussian)
        return _number(word, type(x[0]))
    _, indices, _ = nearest_points(x, seed, 1)
    around = Neighbourhood(x, seed, FOURTH_POINT_RADIUS[len(points)])
    _, word = around.vector(indices[0])
    return _number(word, around.float_type)


def _number(word: Any, float_type: Any) -> Any:
    mixed = word * CELL_SALT
    mixed = (mixed ^ (mixed >> 15)) * CELL_SALT
    return unit(mixed ^ (mixed >> 13), float_type)
