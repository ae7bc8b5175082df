"""Resampling without aliasing."""

from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image

WHOLE = 0.999
"""Share of a pixel that has to be inside for it to count as inside: all of it, but for rounding."""


def resize(image: NDArray[Any], size: tuple[int, int]) -> NDArray[np.float32]:
    """Resample an image (H, W) or (H, W, C) to `size` = (height, width), float32, within the range of its values.

    Shrinking uses a Hamming-windowed sinc stretched over the pixels that merge (no aliasing, no negative
    lobe), and enlarging a cubic. Constant images stay constant. Raises ValueError for an empty size.
    """
    source = np.asarray(image, dtype=np.float32)
    height, width = size
    if height < 1 or width < 1 or source.size == 0:
        raise ValueError(f"cannot resize {source.shape} to {size}")
    planes = source[..., None] if source.ndim == 2 else source
    result = np.stack([_plane(planes[..., c], height, width) for c in range(planes.shape[2])], axis=-1)
    # The cubic overshoots at edges; light below zero or brighter than the photo would be an invention.
    result = np.clip(result, source.min(), source.max())
    return np.ascontiguousarray(result[..., 0] if source.ndim == 2 else result)


def resize_mask(mask: NDArray[np.bool_], size: tuple[int, int]) -> NDArray[np.bool_]:
    """Resample a mask (H, W) to `size` = (height, width): True where a new pixel lies wholly inside it."""
    return np.asarray(resize(mask, size) > WHOLE)


def _plane(plane: NDArray[np.float32], height: int, width: int) -> NDArray[np.float32]:
    picture = Image.fromarray(np.ascontiguousarray(plane))
    for target in ((width, picture.height), (width, height)):  # one axis at a time: each has its own filter
        shrinks = target[0] < picture.width or target[1] < picture.height
        picture = picture.resize(target, Image.Resampling.HAMMING if shrinks else Image.Resampling.BICUBIC)
    return np.asarray(picture, dtype=np.float32)
