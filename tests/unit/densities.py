"""Small density grids whose pictures are known, shared by the tests of what is seen of a volume."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from voldetail.backend import mitsuba
from voldetail.geometry.density_grid import DensityGrid

Array = NDArray[np.float64]


def sampled(
    density: Callable[[Array, Array, Array], Array], shape: tuple[int, int, int] = (32, 32, 32),
    lower: tuple[float, float, float] = (-1.0, -1.0, -1.0), edge: float = 2 / 32,
) -> DensityGrid:  # fmt: skip
    """Return a grid of ``density(x, y, z)`` at the cells' middles."""
    z, y, x = np.meshgrid(*(np.arange(n) + 0.5 for n in shape), indexing="ij")
    places = (lower[axis] + v * edge for axis, v in enumerate((x, y, z)))
    values = np.broadcast_to(density(*places), shape).astype(np.float32).ravel()
    # Through a list into memory of Dr.Jit's own, as what is baked has: NumPy's is used where it lies, and a kernel for
    # memory that happens not to be aligned is another one.
    return DensityGrid(mitsuba().Float(values.tolist()), shape, lower, edge)


def slab(density: Callable[[Array], Array], cells: int = 16) -> DensityGrid:
    """Return a slab of thickness 1/2, z from -1/4 to 1/4, much wider; ``density`` of the height from 0 to 1."""
    edge = 0.5 / cells
    half = 2.0
    across = round(2 * half / edge)
    return sampled(lambda x, y, z: density((z + 0.25) / 0.5), (cells, across, across), (-half, -half, -0.25), edge)


def sphere(cells: int, radius: float = 0.7, ramp: float = 2.0) -> DensityGrid:
    """Return a ball whose density falls from 1 to 0 within ``ramp`` cells about its surface."""
    edge = 2.0 / cells
    return sampled(
        lambda x, y, z: np.clip((radius - np.sqrt(x * x + y * y + z * z)) / (ramp * edge) + 0.5, 0, 1),
        (cells, cells, cells), edge=edge,
    )  # fmt: skip


def cloud(cells: int = 32) -> DensityGrid:
    """Return a soft ball with waves in it, smooth over several cells."""

    def density(x: Array, y: Array, z: Array) -> Array:
        t = np.clip((0.8 - np.sqrt((x - 0.1) ** 2 + (y + 0.05) ** 2 + z * z)) / 0.5, 0, 1)
        return t * t * (3 - 2 * t) * (0.6 + 0.4 * np.sin(7 * x + 1) * np.sin(7 * y) * np.sin(7 * z + 2))

    return sampled(density, (cells, cells, cells), edge=2.0 / cells)


def points(places: Array) -> object:
    """Return Mitsuba points of an (N, 3) array."""
    return mitsuba().Point3f(*(mitsuba().Float(np.ascontiguousarray(places[:, a], dtype=np.float32)) for a in range(3)))
