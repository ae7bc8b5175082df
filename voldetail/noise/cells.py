"""What belongs to a cell: one number for all positions whose closest feature point is the same."""

from __future__ import annotations

from typing import Any

from voldetail.noise.gabor import frame
from voldetail.noise.lattice import FOURTH_POINT_RADIUS, Neighbourhood, nearest_points, unit

CELL_SALT = 0x7F4A7C15
"""Multiplies the spare hash word, so that a cell's number is independent of its stripes; odd, else arbitrary."""


def cell_value(points: tuple[Any, ...], seed: Any, *, scale: Any, anisotropy: Any, angle: Any) -> Any:
    """Return a number in [0, 1), uniform over cells of the coarsest octave and constant in each, at ``points``.

    Arguments as in `relief_function`. It jumps at the border of cells and has no gradient.
    """
    x = frame(points, scale, anisotropy, angle)
    _, indices, _ = nearest_points(x, seed, 1)
    around = Neighbourhood(x, seed, FOURTH_POINT_RADIUS[len(points)])
    _, word = around.vector(indices[0])
    mixed = word * CELL_SALT
    mixed = (mixed ^ (mixed >> 15)) * CELL_SALT
    return unit(mixed ^ (mixed >> 13), around.float_type)
