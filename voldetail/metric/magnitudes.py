"""How filter magnitudes go together: over frequencies, levels and space (after Portilla & Simoncelli 2000, section 2.3).

Edges, cracks and grains excite several orientations, frequencies and levels at one place and in repeating places;
a picture with the same spectrum and random phases does not. Correlations do not see the spectrum itself.
"""

import numpy as np

from voldetail.metric.filters import WINDOW
from voldetail.metric.layers import LEVEL_NAMES, LEVELS, Layers, inside
from voldetail.metric.quantiles import Array, Parts

LAGS = ((0, 4), (4, 0), (4, 4), (4, -4), (0, 8), (8, 0), (0, 12), (12, 0))
"""Displacements (rows, columns) between magnitudes of one filter, in steps of the level's map."""


def basis(layers: Layers, /) -> Parts:
    """Nothing: correlations need no unit of the reference."""
    return {}


def measure(layers: Layers, basis: Parts, /) -> Parts:
    """Correlations of the amplitudes: (136,) within a level, (289,) to the next, (17 * lags,) in space."""
    found = {}
    standard = layers.maps
    for level, name in enumerate(LEVEL_NAMES):
        maps, allowed = _standardised(standard[level], layers, level)
        flat = maps.reshape(len(maps), -1)
        weight = max(int(allowed.sum()), 1)
        upper = np.triu_indices(len(maps), 1)
        found[f"within {name}"] = (flat @ flat.T)[upper] / weight
        found[f"space {name}"] = np.concatenate([_lagged(maps, allowed, *lag) for lag in LAGS])
        if level + 1 < LEVELS:
            coarse, coarse_allowed = _standardised(standard[level + 1], layers, level + 1)
            # Window centres: coarse pixel y + 3 lies on fine pixel 2 y + 6, the centre of the fine window 2 y + 3.
            rows, columns = coarse_allowed.shape
            fine = maps[:, 1:, 1:] if level == 0 else maps[:, 3::2, 3::2]
            fine_allowed = allowed[1:, 1:] if level == 0 else allowed[3::2, 3::2]
            rows, columns = min(rows, fine.shape[1]), min(columns, fine.shape[2])
            both = fine_allowed[:rows, :columns] & coarse_allowed[:rows, :columns]
            fine, coarse = fine[:, :rows, :columns], coarse[:, :rows, :columns]
            product = fine.reshape(len(fine), -1) @ coarse.reshape(len(coarse), -1).T
            found[f"across {name}"] = product.ravel() / max(int(both.sum()), 1)
    return {part: values.astype(np.float32) for part, values in found.items()}


def compare(a: Array, b: Array, basis: Array | None, /) -> float:
    """Root mean square difference of the correlations."""
    return float(np.sqrt(np.mean((a - b) ** 2)))


def _standardised(maps: Array, layers: Layers, level: int) -> tuple[Array, np.ndarray]:
    """Maps with mean 0 and variance 1 over the allowed windows and 0 elsewhere; and those windows."""
    mask = layers.masks[level]
    stride = 1 if level else 2
    allowed = np.ones(maps.shape[1:], bool) if mask is None else inside(mask, WINDOW)[::stride, ::stride]
    flat = maps.reshape(len(maps), -1)
    weight = allowed.ravel().astype(np.float32)
    count = max(float(weight.sum()), 1.0)
    mean = flat @ weight / count
    centred = (flat - mean[:, None]) * weight
    deviation = np.sqrt(np.einsum("kn,kn->k", centred, centred) / count)
    centred /= np.maximum(deviation, np.float32(1e-4))[:, None]
    return centred.reshape(maps.shape), allowed


def _lagged(maps: Array, allowed: np.ndarray, rows: int, columns: int) -> Array:
    """Correlation of each map with itself displaced by (rows, columns)."""
    height, width = allowed.shape
    near = (slice(0, max(height - rows, 0)), slice(max(-columns, 0), width - max(columns, 0)))
    far = (slice(rows, height), slice(max(columns, 0), width - max(-columns, 0)))
    pairs = max(int((allowed[near] & allowed[far]).sum()), 1)
    return np.einsum("kij,kij->k", maps[:, *near], maps[:, *far]) / pairs
