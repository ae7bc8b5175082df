"""The noise floor of a reference picture: how far apart lie pictures that anyone would accept as the same texture."""

from collections.abc import Callable, Iterator

import numpy as np
from numpy.typing import NDArray

from voldetail.errors import InputError
from voldetail.image import resize, resize_mask
from voldetail.metric.layers import Layers, Mask, layers

ACCEPTED_EXPOSURE = 1.1
"""A picture 10 % brighter is the same texture."""

ACCEPTED_SCALE = 0.95
"""A picture 5 % smaller is the same texture."""

SMALLEST_FLOOR = 1e-3
"""Floors are relative (standard deviations, correlations, shares): below this it is rounding, as in a blank picture."""

_Parts = dict[tuple[str, str], float]


def noise_floors(
    luminance: NDArray[np.floating],
    mask: Mask | None,
    picture: Layers,
    compare: Callable[[Layers, Layers], _Parts],
) -> _Parts:
    """Mean distance of each part over four comparisons, in the parts' own units.

    They are: left with right half, top with bottom half, the picture with a brighter and with a smaller copy. A half
    or copy too small for the filters is left out. A photo whose brightness drifts thereby lowers the weight of what
    sees the drift.
    """
    use = np.ones(np.shape(luminance), bool) if mask is None else np.asarray(mask, bool)
    image = np.where(np.isfinite(luminance), luminance, 0).astype(np.float32)
    found = [compare(one, other) for one, other in _pairs(image, use, picture)]
    return {key: max(float(np.mean([parts[key] for parts in found])), SMALLEST_FLOOR) for key in found[0]}


def _pairs(image: NDArray[np.float32], use: Mask, picture: Layers) -> Iterator[tuple[Layers, Layers]]:
    yield picture, layers(image * np.float32(ACCEPTED_EXPOSURE), use)
    smaller = tuple(round(side * ACCEPTED_SCALE) for side in image.shape)
    for one, other in ((None, (resize(image, smaller), resize_mask(use, smaller))), *_halves(image, use)):
        try:
            yield (picture if one is None else layers(*one)), layers(*other)
        except InputError:
            continue


def _halves(
    image: NDArray[np.float32], use: Mask
) -> Iterator[tuple[tuple[NDArray[np.float32], Mask], tuple[NDArray[np.float32], Mask]]]:
    """The picture cut in two, each way, so that both sides have as many pixels inside the mask."""
    for axis in (1, 0):
        inside = np.flatnonzero(use.any(axis=1 - axis))
        share = np.cumsum(use.sum(axis=1 - axis))
        cut = int(np.searchsorted(share, share[-1] / 2)) + 1
        first, second = slice(inside[0], cut), slice(cut, inside[-1] + 1)
        yield _cut(image, use, axis, first), _cut(image, use, axis, second)


def _cut(image: NDArray[np.float32], use: Mask, axis: int, part: slice) -> tuple[NDArray[np.float32], Mask]:
    where = (slice(None), part) if axis == 1 else (part, slice(None))
    return image[where], use[where]
