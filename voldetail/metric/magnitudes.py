"""How filter magnitudes go together: over frequencies, levels and space (after Portilla & Simoncelli 2000, section 2).

Edges, cracks and stones excite several orientations, frequencies and levels at one place, and again at the next
stone; a picture with the same spectrum and random phases does not. The magnitudes are those of GD10 eq. 4, so they
cost nothing more. Correlations do not see the spectrum itself, nor contrast.
"""

import numpy as np
from numpy.typing import NDArray

from voldetail.metric.filters import WINDOW
from voldetail.metric.layers import LEVEL_NAMES, LEVELS, Layers, inside
from voldetail.metric.quantiles import Array, Parts

LAGS = ((0, 8), (8, 0), (8, 8), (8, -8), (0, 16), (16, 0), (0, 24), (24, 0))
"""Displacements (rows, columns) between magnitudes of one filter, in pixels of the level: from one window's side
on, below which windows overlap and correlate whatever the picture."""

_FAINT = np.float32(1e-4)
"""Magnitudes that deviate less than this (encoded units) do not vary, they round."""

Allowed = NDArray[np.bool_]


def basis(layers: Layers, /) -> Parts:
    """Nothing: correlations need no unit of the reference."""
    return {}


def measure(layers: Layers, basis: Parts, /) -> Parts:
    """Correlations of the magnitudes: (136,) within a level, (289,) with the next, (17 * lags,) in space."""
    correlations: dict[str, Array] = {}
    maps = [_standardised(layers, level) for level in range(LEVELS)]
    for level, name in enumerate(LEVEL_NAMES):
        magnitudes, allowed = maps[level]
        upper = np.triu_indices(len(magnitudes), 1)
        correlations[f"within {name}"] = _correlations(magnitudes, magnitudes, allowed)[upper]
        if level + 1 < LEVELS:  # a coarsest level has too few displaced pairs, and no next level
            step = 1 if level else 2
            lags = ((rows // step, columns // step) for rows, columns in LAGS)
            correlations[f"space {name}"] = np.concatenate([_lagged(magnitudes, allowed, *lag) for lag in lags])
            coarse, coarse_allowed = maps[level + 1]
            # Window y is centred on pixel y + 3, and coarse pixel y + 3 lies on fine pixel 2 y + 6: fine window
            # 2 y + 3, at level 0 (every second window) its neighbour 2 (y + 1).
            first, step = (1, 1) if level == 0 else (3, 2)
            fine = magnitudes[:, first::step, first::step]
            rows, columns = np.minimum(fine.shape[1:], coarse.shape[1:])
            both = allowed[first::step, first::step][:rows, :columns] & coarse_allowed[:rows, :columns]
            across = _correlations(fine[:, :rows, :columns], coarse[:, :rows, :columns], both)
            correlations[f"across {name}"] = across.ravel()
    return correlations


def apart(a: Array, b: Array, basis: Array | None, /) -> Array:
    """Root mean square difference of the correlations, of any number of ``b`` (..., n) at once."""
    return np.asarray(np.sqrt(np.mean((a - b) ** 2, axis=-1)))


def _standardised(layers: Layers, level: int) -> tuple[Array, Allowed]:
    """Maps (17, h, w) with mean 0 and variance 1 over the allowed windows and 0 elsewhere; and those windows."""
    maps, mask = layers.maps[level], layers.masks[level]
    step = 1 if level else 2
    allowed = np.ones(maps.shape[1:], bool) if mask is None else inside(mask, WINDOW)[::step, ::step]
    flat, weight = maps.reshape(len(maps), -1), allowed.ravel().astype(np.float32)
    count = max(float(weight.sum()), 1.0)
    centred = flat - (flat @ weight / count)[:, None]
    if mask is not None:
        centred *= weight
    deviation = np.sqrt(np.einsum("kn,kn->k", centred, centred) / count)
    centred /= np.maximum(deviation, _FAINT)[:, None]
    return centred.reshape(maps.shape), allowed


def _correlations(one: Array, other: Array, allowed: Allowed) -> Array:
    """Mean products of all pairs of maps, (17, 17); row by row, so that no product is large (see `filters`)."""
    product: Array = np.matmul(one.transpose(1, 0, 2), other.transpose(1, 2, 0)).sum(axis=0)
    return product / np.float32(max(int(allowed.sum()), 1))


def _lagged(maps: Array, allowed: Allowed, rows: int, columns: int) -> Array:
    """Correlation of each map with itself displaced by (rows, columns), (17,); 0 where no pair is allowed."""
    height, width = allowed.shape
    if rows >= height or abs(columns) >= width:
        return np.zeros(len(maps), np.float32)
    near = (slice(0, height - rows), slice(max(-columns, 0), width - max(columns, 0)))
    far = (slice(rows, height), slice(max(columns, 0), width - max(-columns, 0)))
    pairs = max(int((allowed[near] & allowed[far]).sum()), 1)
    return np.asarray(np.einsum("kij,kij->k", maps[:, *near], maps[:, *far]) / pairs, np.float32)
