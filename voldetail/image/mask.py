"""Masks: which pixels of a photo are to be used."""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from voldetail.errors import InputError
from voldetail.image.load import load_samples

NEAR = 0.1  # this close to black or white is black or white: JPEG noise around edges
MAX_BETWEEN = 0.02  # of all pixels: the smoothed border of a drawn mask; more is a picture and not a mask
_COLOUR = 0.1  # channels that differ by more are a colour; JPEG tints grey by less


def load_mask(path: str | Path, shape: tuple[int, int]) -> NDArray[np.bool_]:
    """Read a mask for a photo of `shape` = (height, width): True where the file is white and not transparent.

    A file of two values of which one is 0 is taken by them; otherwise up to 2 % of the pixels may lie between
    black and white (smoothed edges) and are cut at half. Raises InputError for another size, for a mask that
    is empty, and for a picture that is not black and white.
    """
    samples = load_samples(path, "mask")
    values = samples.values
    height, width = values.shape[:2]
    if (height, width) != tuple(shape):
        raise InputError(
            f"The mask {path} has {width} x {height} pixels and the photo {shape[1]} x {shape[0]}; give one of the photo's size."
        )
    if values.ndim == 3:
        if float((values.max(axis=2) - values.min(axis=2)).max()) > _COLOUR:
            raise InputError(f"The mask {path} is in colour; save it black (leave out) and white (use).")
        values = values.mean(axis=2)
    mask = _two_values(values)
    if mask is None:
        between = int(np.count_nonzero((values > NEAR) & (values < 1 - NEAR)))
        if between > MAX_BETWEEN * values.size:
            raise InputError(
                f"The mask {path} is not black and white: {100 * between / values.size:.1f} % of its pixels lie "
                f"between, {100 * MAX_BETWEEN:.0f} % are allowed for smooth edges; save it with two values."
            )
        mask = values > 0.5
    if samples.alpha is not None:
        mask = mask & (samples.alpha > 0.5)
    if not mask.any():
        raise InputError(f"The mask {path} is empty: no pixel is white; paint what is to be used white.")
    return np.ascontiguousarray(mask)


def _two_values(values: NDArray[np.float32]) -> NDArray[np.bool_] | None:
    """Return where `values` are the higher one if they are 0 and one other number (0 and 1 of 255, say)."""
    highest = values.max()
    if values.min() != 0 or highest == 0 or np.any((values != 0) & (values != highest)):
        return None
    return np.asarray(values == highest)
