"""Ka, Kd, Ks and shininess from the photo, at each evaluation (GD10 section 7).

The paper matches luminance order statistics: the darkest pixels set Ka, the mean Kd, the brightest Ks, their number the
shininess. Here all order statistics take part at once. The picture is linear in the coefficients, I = Ka A + Kd D +
Ks S_n, but its sorted values are not, since the order of the pixels changes; with the order of the last step kept, they
are, and a few steps settle it. Solved under bounds: no coefficient is negative, and a matt surface reflects no more
than it receives.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from voldetail.render import Components

RANKS = 24
"""Groups of pixels by luminance whose means are matched; finer groups add noise, not knowledge (tuned on 12 photos)."""

STEPS = 3
"""Re-sorting steps; the fourth changes coefficients by less than a percent."""

SAMPLES = 9000
"""Pixels used at most: enough for 24 groups of some 400."""

DARK = 0.03
"""Linear luminance below which differences count less and less, in the weights 1 / (q + DARK): about where sRGB's curve
leaves its linear part."""


@dataclass(frozen=True)
class Coefficients:
    """Ka, Kd, Ks, an exponent that was rendered, and the weighted residual of the order statistics."""

    ambient: float
    diffuse: float
    specular: float
    shininess: float
    residual: float


def solve(photo: NDArray[np.float32], parts: Components, mask: NDArray[np.bool_], *, specular: bool = True) -> Coefficients:
    """Return the coefficients whose picture has the order statistics of ``photo`` (linear luminance, (H, W)).

    ``mask`` (H, W) says which pixels count. With ``specular`` False, Ks is 0.
    """
    index = np.flatnonzero(mask.ravel())
    index = index[:: max(1, len(index) // SAMPLES)]
    wanted = _group_means(np.sort(photo.ravel()[index]))
    weights = 1.0 / (wanted + DARK)
    ambient, diffuse = parts.ambient.ravel()[index], parts.diffuse.ravel()[index]
    best: Coefficients | None = None
    lobes = range(len(parts.shininess)) if specular else (-1,)
    for lobe in lobes:
        columns = [ambient, diffuse] + ([parts.specular[lobe].ravel()[index]] if lobe >= 0 else [])
        found, residual = _alternate(np.stack(columns, axis=1).astype(np.float64), wanted, weights)
        if best is None or residual < best.residual:
            gloss = float(found[2]) if lobe >= 0 else 0.0
            exponent = parts.shininess[lobe] if lobe >= 0 else parts.shininess[0]
            best = Coefficients(float(found[0]), float(found[1]), gloss, exponent, residual)
    assert best is not None
    return best


def _group_means(values: NDArray[np.floating]) -> NDArray[np.float64]:
    """Return the means of RANKS equal groups of sorted values (rows, for a matrix)."""
    edges = np.linspace(0, len(values), RANKS + 1).astype(int)
    sums = np.add.reduceat(values.astype(np.float64), edges[:-1], axis=0)
    counts = np.diff(edges).astype(np.float64)
    return np.asarray(sums / (counts if values.ndim == 1 else counts[:, None]))


def _alternate(
    columns: NDArray[np.float64], wanted: NDArray[np.float64], weights: NDArray[np.float64]
) -> tuple[NDArray[np.float64], float]:
    """Alternate between sorting the picture and solving for its coefficients."""
    current = np.array([0.3, 0.5, 0.05][: columns.shape[1]])
    residual = np.inf
    for _ in range(STEPS):
        order = np.argsort(columns @ current)
        means = _group_means(columns[order])
        current = bounded_least_squares(means * weights[:, None], wanted * weights)
        residual = float(np.mean((weights * (means @ current - wanted)) ** 2))
    return current, residual


def bounded_least_squares(matrix: NDArray[np.float64], values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return x in [0, 1]^k, k at most 3, that minimises |matrix x - values|: the best of all faces of the cube.

    With three unknowns the 27 combinations of free, 0 and 1 are fewer steps than a general solver takes to start.
    """
    count = matrix.shape[1]
    gram, right = matrix.T @ matrix, matrix.T @ values
    best, best_cost = np.zeros(count), np.inf
    for face in range(3**count):
        state = [(face // 3**i) % 3 for i in range(count)]  # 0 free, 1 at zero, 2 at one
        x = np.array([1.0 if s == 2 else 0.0 for s in state])
        free = [i for i, s in enumerate(state) if s == 0]
        if free:
            part = gram[np.ix_(free, free)] + 1e-9 * np.eye(len(free))
            x[free] = np.linalg.solve(part, right[free] - gram[free] @ x)
            if (x[free] < 0).any() or (x[free] > 1).any():
                continue
        cost = float(x @ gram @ x - 2 * right @ x)
        if cost < best_cost - 1e-12:
            best, best_cost = x, cost
    return best
