"""Densities in files: Mitsuba's grid volumes (.vol), version 3, which its `gridvolume` reads.

"VOL" 3, int32: 1 (float32), columns nx, rows ny, slices nz, channels 1; float32: the box's least and greatest corner
(x, y, z each); nx ny nz float32 densities, x fastest; all little-endian.
"""

from __future__ import annotations

import math
import struct
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from voldetail.errors import InputError
from voldetail.files import readable, write_bytes
from voldetail.geometry.density_grid import DensityGrid

SUFFIX = ".vol"
MAGIC, FLOAT32 = b"VOL\x03", 1
_HEADER = struct.Struct("<4s5i6f")
MAX_CELLS = 1 << 27
"""512 cells a side: half a gigabyte, and several while a surface is made of it."""


def write_density(path: Path, grid: DensityGrid) -> None:
    """Write ``grid`` as a .vol file, whole or not at all."""
    nz, ny, nx = grid.shape
    header = _HEADER.pack(MAGIC, FLOAT32, nx, ny, nz, 1, *grid.lower, *grid.upper)
    write_bytes(path, header + grid.array().astype("<f4").tobytes())


def read_density(path: Path) -> tuple[NDArray[np.float32], tuple[float, ...], tuple[float, ...]]:
    """Read a .vol file: densities (nz, ny, nx), and the least and the greatest corner of its box.

    Raises InputError for a file of another kind, of another size than its header says, with values that are not numbers
    from 0 to 1, or with a box without volume.
    """
    data = readable(path, "density file", _HEADER.size + 4 * MAX_CELLS).read_bytes()
    if len(data) < _HEADER.size or not data.startswith(MAGIC):
        raise InputError(f"The density file {path} is no grid volume of version 3 (.vol); write it with voldetail bake.")
    _, encoding, nx, ny, nz, channels, *box = _HEADER.unpack_from(data)
    if encoding != FLOAT32 or channels != 1:
        raise InputError(
            f"The density file {path} holds {channels} channels of encoding {encoding}, but has to hold one of float32"
            " (encoding 1); write the density alone."
        )
    if min(nx, ny, nz) < 1 or nx * ny * nz > MAX_CELLS:
        raise InputError(
            f"The density file {path} has {nx} x {ny} x {nz} cells; each number has to be above 0, all at most {MAX_CELLS}"
            " (512 a side): use a coarser grid."
        )
    wanted, found = nx * ny * nz * 4, len(data) - _HEADER.size
    if found != wanted:
        raise InputError(
            f"The density file {path} has {nx} x {ny} x {nz} cells, {wanted} bytes, but holds {found}; write it again, whole."
        )
    if not all(math.isfinite(v) for v in box) or any(high <= low for low, high in zip(box[:3], box[3:], strict=True)):
        raise InputError(f"The density file {path} has the box {box[:3]} to {box[3:]}, which has no volume; give it one.")
    density = np.frombuffer(data, dtype="<f4", offset=_HEADER.size).reshape(nz, ny, nx).astype(np.float32)
    # Written so that what is not a number fails as well.
    wrong = int(np.count_nonzero(~((density >= 0.0) & (density <= 1.0))))
    if wrong:
        raise InputError(
            f"The density file {path} has to hold numbers from 0 to 1, but {wrong} of its {density.size} are not"
            " (or are NaN): scale them."
        )
    return density, tuple(box[:3]), tuple(box[3:])
