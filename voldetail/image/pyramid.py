"""Gaussian pyramids of images and of masks."""

from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

# Burt and Adelson 1983, "The Laplacian pyramid as a compact image code": the 5-tap binomial kernel.
_KERNEL = np.array([1, 4, 6, 4, 1], dtype=np.float32) / 16
# "mirror" reflects about the centre of the border pixel (d c b | a b c d): no pixel counts twice at the
# border.
_BORDER = "mirror"


def gaussian_pyramid(image: NDArray[Any], levels: int) -> list[NDArray[np.float32]]:
    """Return `levels` images, the finest first: each is REDUCE of the one before (Burt and Adelson 1983, eq. 1).

    `image` is (H, W); level i has ceil(H / 2^i) x ceil(W / 2^i) pixels, and its pixel (0, 0) lies on that of
    level 0.
    """
    pyramid = [np.asarray(image, dtype=np.float32)]
    for _ in range(levels - 1):
        rows = ndimage.convolve1d(pyramid[-1], _KERNEL, axis=0, mode=_BORDER)[::2]
        pyramid.append(np.ascontiguousarray(ndimage.convolve1d(rows, _KERNEL, axis=1, mode=_BORDER)[:, ::2]))
    return pyramid


def masked_pyramid(mask: NDArray[np.bool_], levels: int) -> list[NDArray[np.bool_]]:
    """Return the masks that belong to `gaussian_pyramid`: a pixel is True only if all it was made from are."""
    pyramid = [np.asarray(mask, dtype=bool)]
    for _ in range(levels - 1):
        worst = ndimage.minimum_filter(pyramid[-1], size=len(_KERNEL), mode=_BORDER)
        pyramid.append(np.ascontiguousarray(worst[::2, ::2]))
    return pyramid
