"""A density on a regular grid: what a volumetric detail is baked to, and what is marched, traced or made a surface of."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import drjit as dr
import numpy as np
from numpy.typing import NDArray

from voldetail.backend import mitsuba


@dataclass(frozen=True, eq=False)
class DensityGrid:
    """Densities at the middles of equal cubes that fill a box.

    density: Dr.Jit Float of nz ny nx values in [0, 1], x fastest. shape: (nz, ny, nx). lower: the box's corner with the
    least coordinates, in scene units. edge: of a cube, in scene units. Outside the box the density is 0.
    """

    density: Any
    shape: tuple[int, int, int]
    lower: tuple[float, float, float]
    edge: float

    @property
    def upper(self) -> tuple[float, float, float]:
        """The box's other corner."""
        nz, ny, nx = self.shape
        x, y, z = self.lower
        return x + nx * self.edge, y + ny * self.edge, z + nz * self.edge

    def array(self) -> NDArray[np.float32]:
        """The densities as (nz, ny, nx)."""
        return np.asarray(self.density, dtype=np.float32).reshape(self.shape)


def split(index: Any, shape: tuple[int, int, int]) -> tuple[Any, Any, Any]:
    """Return the column x, row y and slice z of the cells with the numbers ``index``, x fastest."""
    _, ny, nx = (dr.opaque(type(index), count) for count in shape)
    row = index // nx
    layer = row // ny
    return index - row * nx, row - layer * ny, layer


def middles(index: Any, shape: tuple[int, int, int], lower: tuple[float, float, float], edge: float) -> tuple[Any, Any, Any]:
    """Return the middles of the cells with the numbers ``index``, in scene units."""
    float_type: Any = mitsuba().Float
    side = dr.opaque(float_type, edge)
    x, y, z = (
        dr.fma(float_type(cell) + 0.5, side, dr.opaque(float_type, float(low)))
        for cell, low in zip(split(index, shape), lower, strict=True)
    )
    return x, y, z
