"""The grid of a shell: its cubes, what they will take, and how they are cut into blocks."""

from __future__ import annotations

import math
from dataclasses import dataclass

from voldetail.errors import InputError
from voldetail.geometry.mesh_distance import Grid
from voldetail.geometry.meshes import Mesh
from voldetail.setup.proxy import ProxySetup

SIDE = 64
"""Steps along a block's side; tuned on a sphere of 256 cells a side."""


@dataclass(frozen=True, eq=False)
class ShellPlan:
    """The grid of a shell, and what it will take.

    edge, thickness, amplitude in scene units; shape (nz, ny, nx) and lower as those of a DensityGrid; depth: how far a
    plane's slab reaches down. byte_count: memory at the most. seconds: about how long density and noise take. mesh: the
    checked mesh in its own frame, None for the simple shapes. blocks: how many blocks of SIDE cells a side the surface can
    reach, where the grid as a whole is too large (then bytes and seconds are those of `tiled_isosurface`); 0 for a dense one.
    """

    proxy: ProxySetup
    edge: float
    thickness: float
    amplitude: float
    shape: tuple[int, int, int]
    lower: tuple[float, float, float]
    depth: float
    byte_count: int
    seconds: float
    mesh: Mesh | None = None
    blocks: int = 0

    @property
    def cells(self) -> int:
        """How many cubes the grid has."""
        return math.prod(self.shape)

    @property
    def sentence(self) -> str:
        """The plan in words, for the user to read before it is carried out."""
        nz, ny, nx = self.shape
        tiles = f" in at most {self.blocks} of {math.prod(block_counts(self.shape))} blocks," if self.blocks else ""
        return (
            f"{nx} x {ny} x {nz} cells of {self.edge:.3g} scene units,{tiles} {self.byte_count / 2**20:.0f} MB,"
            f" about {max(self.seconds, 1.0):.0f} s"
        )

    def check_dense(self) -> None:
        """Refuse to fill the whole grid where it was planned for tiles."""
        if self.blocks:
            raise InputError(
                f"A grid of {self.sentence.split(',')[0]} was planned for its surface by tiles alone: plan it without tiles to"
                " fill it."
            )


def block_counts(shape: Grid) -> Grid:
    """Return how many blocks the grid has along z, y and x."""
    nz, ny, nx = (-(-(count + 1) // SIDE) for count in shape)
    return nz, ny, nx
