"""Sizes and contrasts of bright and of dark spots: a granulometry by openings and closings (Matheron 1975; Serra 1982).

What an opening by a square of 2 r + 1 pixels takes away is brighter than its surroundings and narrower than the square;
a closing does the same for the dark. Stones are bright spots of one size between narrow dark gaps, holes the reverse,
and noise of the same spectrum is neither: no filter that is linear, or symmetric in bright and dark, tells them apart.
"""

import numpy as np

from voldetail.metric.layers import LEVEL_NAMES, Layers
from voldetail.metric.quantiles import Array, Parts, quantile_functions, wasserstein

RADII = (1, 2)
"""Radii of the squares in pixels of each level: at three levels 1 to 8 pixels of the picture."""

COARSEST_RADII = (1, 2, 3)
"""And at the coarsest, which no other follows: up to 12 pixels of the picture."""

KINDS = (("bright", 1.0), ("dark", -1.0))


def basis(layers: Layers, /) -> Parts:
    """Unit of each part: the standard deviation of the reference's encoded values at that level, (1, 1)."""
    found: dict[str, Array] = {}
    for level, (name, image) in enumerate(zip(LEVEL_NAMES, layers.images, strict=True)):
        deviation = layers.pick(image[None], level, 1).std()
        unit = np.full((1, 1), max(float(deviation), 1e-4), np.float32)
        found |= {f"{kind} {name}": unit for kind, _ in KINDS}
    return found


def measure(layers: Layers, basis: Parts, /) -> Parts:
    """Quantile functions (radii, 32) of what openings and closings take away at each level."""
    spots: dict[str, Array] = {}
    for level, (name, image) in enumerate(zip(LEVEL_NAMES, layers.images, strict=True)):
        radii = COARSEST_RADII if level == len(LEVEL_NAMES) - 1 else RADII
        for kind, sign in KINDS:
            spots[f"{kind} {name}"] = np.concatenate(
                [quantile_functions(_residue(layers, level, sign * image, radius)) for radius in radii]
            )
    return spots


def apart(a: Array, b: Array, basis: Array | None, /) -> Array:
    """1-Wasserstein distance, mean over radii, in the reference's standard deviations."""
    return wasserstein(a, b, basis)


def _residue(layers: Layers, level: int, image: Array, radius: int) -> Array:
    """What an opening takes from ``image`` where its support of 4 r + 1 pixels is inside the mask, (1, N)."""
    side, margin = 2 * radius + 1, 2 * radius
    opened = _extreme(_extreme(image, side, np.minimum), side, np.maximum)
    taken = image[margin : image.shape[0] - margin, margin : image.shape[1] - margin] - opened
    picked: Array = layers.pick(taken[None], level, 4 * radius + 1)
    return picked if picked.size else np.zeros((1, 1), np.float32)


def _extreme(image: Array, side: int, of: np.ufunc) -> Array:
    """Minimum or maximum over squares wholly inside: (H, W) -> (H - side + 1, W - side + 1).

    Widths double as far as they can, so that few whole-picture operations are needed: an eighth of the time that a
    filter which also serves borders takes.
    """
    for axis in (0, 1):
        width = 1
        while width < side:
            step = min(width, side - width)
            length = image.shape[axis] - step
            first, second = (slice(None),) * axis + (slice(0, length),), (slice(None),) * axis + (slice(step, None),)
            image = of(image[first], image[second])
            width += step
    return image
