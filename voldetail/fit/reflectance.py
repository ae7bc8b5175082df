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

from voldetail.image import luminance
from voldetail.render.unit_components import Components

RANKS = 24
"""Groups of pixels by luminance whose means are matched; finer groups add noise, not knowledge (tuned on 12 photos)."""

STEPS = 3
"""Re-sorting steps; the fourth changes coefficients by less than a percent."""

SAMPLES = 4608
"""Pixels used at most: enough for 24 groups of some 200."""

ACTIVE_SET_STEPS = 12

GLOSS_GAIN = 0.7
"""Share of a matt surface's residual that a highlight may at most leave: a broad one on flat relief can stand for shading
that relief should make, and then shines on every other shape. Tuned on a weathered rock."""

GLOSS_LIMIT = 0.06
"""Largest Ks: what a dielectric of index 1.65 reflects head-on. With more, white lichen on a slab became
a mirror."""

DARKEST_BACKGROUND = 0.6
"""Luminance of what shows through a medium, at least, in that of the darkest pixels: with none, thick clouds stood before
black skies and were too bright."""

LEAST_SHARE = 0.0722
"""Of luminance that a channel carries: blue's in Rec. 709; no tint of luminance 1 has more than its inverse."""

DARK = 0.03
"""Linear luminance below which differences count less and less, in the weights 1 / (q + DARK): about where sRGB's curve
leaves its linear part."""


@dataclass(frozen=True)
class Coefficients:
    """Ka, Kd, Ks, an exponent that was rendered, and the weighted residual of the order statistics.

    background: luminance of what shows through a medium.
    """

    ambient: float
    diffuse: float
    specular: float
    shininess: float
    residual: float
    background: float = 0.0


def solve(
    photo: NDArray[np.float32],
    parts: Components,
    mask: NDArray[np.bool_],
    *,
    specular: bool = True,
    background: bool = False,
) -> Coefficients:
    """Return the coefficients whose picture has the order statistics of ``photo`` (linear luminance, (H, W)).

    ``mask`` (H, W) says which pixels count. With ``specular`` False, Ks is 0. With ``background``, an even one shows
    through where the object does not cover, I = Ka A + Kd D + B (1 - C), and there is no highlight.
    """
    index = np.flatnonzero(mask.ravel())
    index = index[:: max(1, len(index) // SAMPLES)]
    wanted = _group_means(np.sort(photo.ravel()[index]))
    weights = 1.0 / (wanted + DARK)
    ambient, diffuse = parts.ambient.ravel()[index], parts.diffuse.ravel()[index]
    if background:
        columns = np.stack([ambient, diffuse, 1.0 - parts.covered.ravel()[index]], axis=1).astype(np.float64)
        # What shows through is not brighter than the photo, nor much darker: some cloud is before its darkest part too.
        least, most = DARKEST_BACKGROUND * float(wanted[0]), float(wanted[-1])
        first = np.array([0.3, 0.5, least])
        solution, residual = _alternate(columns, wanted, weights, first, STEPS, (1.0, 1.0, most), (0.0, 0.0, least))
        return Coefficients(float(solution[0]), float(solution[1]), 0.0, parts.shininess[0], residual, float(solution[2]))
    best: Coefficients | None = None
    # Matt first: a highlight has to be worth it.
    lobes = (-1, *range(len(parts.shininess))) if specular else (-1,)
    start, steps = np.array([0.3, 0.5]), STEPS
    for lobe in lobes:
        used = [ambient, diffuse] + ([parts.specular[lobe].ravel()[index]] if lobe >= 0 else [])
        columns, count = np.stack(used, axis=1).astype(np.float64), len(used)
        first = np.append(start, 0.05)[:count]
        solution, residual = _alternate(columns, wanted, weights, first, steps, (1.0, 1.0, GLOSS_LIMIT)[:count])
        # The other lobes start where the first one ended, so one step less settles them.
        start, steps = solution[:2], STEPS - 1
        if best is None or residual < best.residual * (GLOSS_GAIN if best.specular == 0.0 else 1.0):
            gloss = float(solution[2]) if lobe >= 0 else 0.0
            exponent = parts.shininess[lobe] if lobe >= 0 else parts.shininess[0]
            best = Coefficients(float(solution[0]), float(solution[1]), gloss, exponent, residual)
    assert best is not None
    return best


def colours(
    pixels: NDArray[np.float32], matt: NDArray[np.float32], through: NDArray[np.float32], mask: NDArray[np.bool_]
) -> tuple[tuple[float, float, float], tuple[float, float, float]]:
    """Return the tint of a medium and the colour (both of luminance 1, or white) of what shows through it.

    pixels (H, W, 3): the photo. matt, through (H, W): luminance of the two parts of the fitted picture. Pixels are sorted
    by luminance, and in each of RANKS groups the photo's mean colour is tint x matt + colour x through: two unknowns for
    each channel, by least squares, none negative.
    """
    photo_order = np.argsort(luminance(pixels)[mask])
    picture_order = np.argsort((matt + through)[mask])
    wanted = _group_means(pixels[mask][photo_order])
    columns = _group_means(np.stack([matt[mask], through[mask]], axis=1)[picture_order])
    brightest = max(float(through[mask].max()), 1e-6)  # where it shows most, all of it does
    least, most = np.percentile(pixels[mask], (1.0, 99.0), axis=0) / brightest
    found = np.array(
        [
            bounded_least_squares(columns, wanted[:, c], (1.0 / LEAST_SHARE, float(most[c])), (0.0, float(least[c])))
            for c in range(3)
        ]
    )
    return _of_luminance_one(found[:, 0]), _of_luminance_one(found[:, 1])


def _of_luminance_one(colour: NDArray[np.float64]) -> tuple[float, float, float]:
    brightness = float(luminance(colour[None, None].astype(np.float32))[0, 0])
    if not brightness > 1e-6:
        return 1.0, 1.0, 1.0
    r, g, b = colour / brightness
    return float(r), float(g), float(b)


def _group_means(values: NDArray[np.floating]) -> NDArray[np.float64]:
    """Return the means of RANKS equal groups of sorted values (rows, for a matrix), or of as many as there are."""
    edges = np.linspace(0, len(values), min(RANKS, len(values)) + 1).astype(int)
    sums = np.add.reduceat(values.astype(np.float64), edges[:-1], axis=0)
    counts = np.diff(edges).astype(np.float64)
    return np.asarray(sums / (counts if values.ndim == 1 else counts[:, None]))


def _alternate(
    columns: NDArray[np.float64],
    wanted: NDArray[np.float64],
    weights: NDArray[np.float64],
    start: NDArray[np.float64],
    steps: int,
    upper: tuple[float, ...],
    lower: tuple[float, ...] | None = None,
) -> tuple[NDArray[np.float64], float]:
    """Alternate between sorting the picture and solving for its coefficients, ``lower`` (default 0) to ``upper`` each."""
    current = start
    residual = np.inf
    for _ in range(steps):
        order = np.argsort(columns @ current)
        means = _group_means(columns[order])
        current = bounded_least_squares(means * weights[:, None], wanted * weights, upper, lower)
        residual = float(np.mean((weights * (means @ current - wanted)) ** 2))
    return current, residual


def bounded_least_squares(
    matrix: NDArray[np.float64],
    values: NDArray[np.float64],
    upper: tuple[float, ...] | None = None,
    lower: tuple[float, ...] | None = None,
) -> NDArray[np.float64]:
    """Return x, ``lower`` (default 0) <= x <= ``upper`` (default 1 each), that minimises |matrix x - values|.

    An active set: unknowns that leave the box are held at its side, and let go where the gradient points inwards. With
    three unknowns that is a few tiny systems, a tenth of the time that a general solver takes.
    """
    if lower is not None:
        bottom = np.array(lower)
        room = tuple(float(v) for v in np.maximum(np.array(upper or (1.0,) * len(lower)) - bottom, 0.0))
        return bottom + bounded_least_squares(matrix, values - matrix @ bottom, room)
    gram, right = matrix.T @ matrix, matrix.T @ values
    count = len(right)
    # A trace of ridge keeps columns that are zero (no highlight, all in shadow) from making the system singular.
    gram = gram + (1e-9 * float(np.trace(gram)) + 1e-12) * np.eye(count)
    top = np.ones(count) if upper is None else np.array(upper)
    held: dict[int, float] = {}
    x = np.zeros(count)
    for _ in range(ACTIVE_SET_STEPS):
        free = [i for i in range(count) if i not in held]
        for i, side in held.items():
            x[i] = side
        if free:
            rest = right[free] - sum(gram[free, i] * side for i, side in held.items())
            x[free] = np.linalg.solve(gram[np.ix_(free, free)], rest)
        outside = np.maximum(-x, x - top)
        worst = int(np.argmax(outside))
        if outside[worst] > 1e-12:
            held[worst] = 0.0 if x[worst] < 0.0 else float(top[worst])
            continue
        slope = gram @ x - right
        pull = {i: (-slope[i] if side == 0.0 else slope[i]) for i, side in held.items()}
        loosest = max(pull, key=lambda i: pull[i], default=None)
        if loosest is None or pull[loosest] <= 1e-10 * float(np.trace(gram)):
            break
        del held[loosest]
    return np.clip(x, 0.0, top)
