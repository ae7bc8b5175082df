"""What the metrics share about one picture: its encoded pyramid and which filter windows the mask allows."""

from dataclasses import dataclass
from functools import cached_property
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from voldetail.errors import InputError
from voldetail.image import gaussian_pyramid, masked_pyramid, to_srgb
from voldetail.metric.filters import WINDOW, responses
from voldetail.types import Array, Mask

_Value = TypeVar("_Value", bound=np.generic)

LEVELS = 3
"""Levels of the Gaussian pyramid, GD10 section 5."""

LEVEL_NAMES = tuple(f"level {level}" for level in range(LEVELS))


def inside(mask: Mask, size: int) -> Mask:
    """Where a size x size window lies wholly in the mask, by first pixel: (H, W) -> (H - size + 1, W - size + 1)."""
    rows, columns = mask.shape[0] - size + 1, mask.shape[1] - size + 1
    if rows < 1 or columns < 1:
        return np.zeros((max(rows, 0), max(columns, 0)), bool)
    sums = np.zeros((mask.shape[0] + 1, mask.shape[1] + 1), np.int32)
    sums[1:, 1:] = mask.cumsum(0, dtype=np.int32).cumsum(1, dtype=np.int32)
    count = sums[size:, size:] - sums[:-size, size:] - sums[size:, :-size] + sums[:-size, :-size]
    return np.asarray(count == size * size)


@dataclass(frozen=True, eq=False)
class Layers:
    """The sRGB-encoded pyramid of one picture, `images[l]` (H_l, W_l) float32, and its masks (None: no mask)."""

    images: tuple[Array, ...]
    masks: tuple[Mask | None, ...]

    @cached_property
    def amplitudes(self) -> tuple[Array, ...]:
        """Filter amplitudes of every pixel's window at each level, (17, N_l), inside the mask (GD10 eq. 4)."""
        return tuple(self.pick(responses(image), level) for level, image in enumerate(self.images))

    @cached_property
    def maps(self) -> tuple[Array, ...]:
        """The same amplitudes as maps, (17, h_l, w_l), with every second window at level 0 and all at the others.

        Neighbouring windows of 8 pixels share most of their content: at level 0 a quarter of them says the same.
        """
        return tuple(responses(image, 1 if level else 2) for level, image in enumerate(self.images))

    def windows(self, level: int, size: int = WINDOW) -> Mask | None:
        """Which size x size windows of a level the mask allows (by first pixel), or None for all."""
        mask = self.masks[level]
        return None if mask is None else inside(mask, size)

    def pick(self, values: NDArray[_Value], level: int, size: int = WINDOW, stride: int = 1) -> NDArray[_Value]:
        """(K, h, w) values of size x size windows -> (K, N): those that the mask allows."""
        allowed = self.windows(level, size)
        if allowed is None:
            return np.ascontiguousarray(values).reshape(len(values), -1)
        return values[:, allowed[::stride, ::stride]]


SMALLEST = WINDOW << (LEVELS - 1)
"""Pixels a side of the smallest picture that has a window at every level."""


def layers(luminance: NDArray[np.floating], mask: Mask | None = None) -> Layers:
    """Check a picture and build its pyramid.

    `luminance` is (H, W), linear, finite and not negative beyond rounding; `mask` (H, W) bool, True = use.
    Raises InputError when a shape or value is wrong or when a level has no window inside the mask.
    """
    image, use = _checked(luminance, mask)
    encoded = to_srgb(np.maximum(image, 0).astype(np.float32, copy=False))
    images = tuple(np.ascontiguousarray(level, np.float32) for level in gaussian_pyramid(encoded, LEVELS))
    if use is None or use.all():
        return Layers(images, (None,) * LEVELS)
    masks = tuple(np.asarray(level, bool) for level in masked_pyramid(use, LEVELS))
    for level, level_mask in enumerate(masks):
        if not inside(level_mask, WINDOW).any():
            raise InputError(
                f"the mask is smaller than the metric's filters: no {WINDOW} x {WINDOW} window of pyramid level "
                f"{level} lies wholly inside it; paint a zone of at least about "
                f"{2 * SMALLEST} x {2 * SMALLEST} pixels"
            )
    return Layers(images, masks)


def _checked(luminance: NDArray[np.floating], mask: Mask | None) -> tuple[NDArray[np.floating], Mask | None]:
    """The picture, 0 where it is not finite, and its mask; refused where the filters cannot use them."""
    image = np.asarray(luminance)
    if image.ndim != 2:
        raise InputError(
            f"the metric compares luminance pictures of shape (height, width), but got shape {image.shape}: "
            "convert colours to luminance first"
        )
    use = None if mask is None else np.asarray(mask)
    if use is not None and (use.shape != image.shape or use.dtype != np.bool_):
        raise InputError(
            f"the mask has shape {use.shape} and type {use.dtype}, but must be boolean with the picture's shape "
            f"{image.shape}: paint it over the same picture"
        )
    finite = np.isfinite(image)
    if not (finite.all() if use is None else finite[use].all()):
        raise InputError("the picture has values that are not finite (NaN or infinity): repair or mask them")
    if not finite.all():
        image = np.where(finite, image, 0)
    if min(image.shape) < SMALLEST:
        raise InputError(
            f"the picture is {image.shape[1]} x {image.shape[0]} pixels, but the metric's filters need at least "
            f"{SMALLEST} x {SMALLEST}: use a larger zone or a higher resolution"
        )
    return image, use
