"""A tile of a recovered relief that repeats without seams: all maps are brought into it by one assignment.

The assignment is that of the photo's own tile (MJHRW17 algorithm 1). Heights of different places do not meet, but slopes do: they
are carried, and the tile's height is the periodic one whose slopes are nearest to them.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from voldetail.detail.photo_relief import MappedDetail
from voldetail.detail.record import ReliefParameters
from voldetail.errors import InputError
from voldetail.recover.files import unsaved_maps
from voldetail.recover.integrate import integrate
from voldetail.recover.recovery import Recovery
from voldetail.stationary.patchmatch_vote import carry
from voldetail.stationary.tile import TileProgress, stationarize

LEAST_TILE, MOST_TILE = 64, 2048
"""Pixels a side."""


def tile_of(
    recovery: Recovery, side: int, *, seed: int = 0, on_progress: Callable[[TileProgress], None] | None = None
) -> MappedDetail:
    """Return the relief as a tile of ``side`` pixels a side, at the scale of the maps.

    Raises InputError for a side that is out of range, and for one that the photo does not hold once.
    """
    if not LEAST_TILE <= side <= MOST_TILE:
        raise InputError(f"The tile's side {side} is out of range; it has to be {LEAST_TILE} to {MOST_TILE} pixels.")
    detail = recovery.detail
    record = detail.record
    shortest = min(record.rows, record.columns)
    if side > shortest:
        raise InputError(
            f"The tile is {side} pixels a side and the maps {record.columns} x {record.rows}; give a tile of at most {shortest},"
            " or a larger --size."
        )
    tile = stationarize(recovery.photo, side, mask=recovery.mask, seed=seed, on_progress=on_progress)
    where = tile.correspondence
    pixels = detail.height * np.float32(record.relief.amplitude * record.texels_per_unit)
    down, right = np.gradient(pixels)
    height = integrate(carry(where, right.astype(np.float32)), carry(where, -down.astype(np.float32)), periodic=True)
    bottom, span = float(height.min()), max(float(np.ptp(height)), 1e-4)
    made = record.model_copy(
        update={
            "name": f"{record.name}, a tile"[:200], "columns": side, "rows": side, "periodic": True, "maps": unsaved_maps(),
            "relief": ReliefParameters(amplitude=min(span / record.texels_per_unit, 1.0)),
        }
    )  # fmt: skip
    relative = np.asarray((height - bottom) / np.float32(span), np.float32)
    return MappedDetail(made, relative, np.clip(carry(where, detail.albedo), 0.0, 1.0), carry(where, detail.roughness))
