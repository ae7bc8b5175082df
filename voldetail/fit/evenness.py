"""Whether a photo is the same everywhere, which all statistics of it suppose; and an even one made of it (MJHRW17).

    u = s / d

s: the measure of stationarity by local histograms (stationary.measure, eq. 1 and 3), windows a sixth of the shorter
side; d: the mean difference of two of its pixels, in CIE L*a*b*. 0 is perfectly even, 1 as uneven as a photo of two halves
that share no colour.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from voldetail.errors import InputError
from voldetail.results.target import EVEN_ENOUGH
from voldetail.stationary.colour import to_lab
from voldetail.stationary.measure import stationarity
from voldetail.stationary.tile import stationarize

WINDOW = 1 / 6
"""Of the shorter side: what is uneven over less is texture; over more there is too little of it to tell."""

PAIRS_SEED = 0


def unevenness(pixels: NDArray[np.float32], mask: NDArray[np.bool_]) -> float | None:
    """Return u of a linear picture (H, W, 3) inside the mask; None where it cannot be measured or has one colour."""
    try:
        measured = stationarity(pixels, mask, measure="histogram", sigma=max(1.0, WINDOW * min(mask.shape)))
    except InputError:
        return None
    lab = to_lab(pixels)[mask]
    other = np.random.default_rng(PAIRS_SEED).permutation(len(lab))
    apart = float(np.abs(lab - lab[other]).sum(axis=1).mean())
    return measured.value / apart if apart > 1e-3 and math.isfinite(measured.value) else None


def warning(value: float | None) -> str:
    """Return what to tell the user of a photo's `unevenness`; "" where it is even enough."""
    if value is None or value <= EVEN_ENOUGH:
        return ""
    return (
        f"The photo is uneven ({value:.2f}, where up to {EVEN_ENOUGH:g} is even enough): stains or shading differ from side to"
        " side and will be fitted as relief; choose an even --zone, or give --stationarize."
    )


def evened(source: NDArray[np.float32], mask: NDArray[np.bool_], shape: tuple[int, int], seed: int) -> NDArray[np.float32]:
    """Return a picture of ``shape`` made of ``source`` (H, W, 3) inside its mask that is alike everywhere.

    A toroidal tile, as large as the shorter sides allow, repeated as far as ``shape`` needs. Raises InputError for a source
    too small for it.
    """
    side = min(*shape, *mask.shape)
    tile = stationarize(source, side, seed=seed, mask=mask).tile
    rows, columns = (math.ceil(n / side) for n in shape)
    return np.ascontiguousarray(np.tile(tile, (rows, columns, 1))[: shape[0], : shape[1]])
