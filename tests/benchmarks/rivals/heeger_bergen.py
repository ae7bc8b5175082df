"""Texture synthesis of Heeger & Bergen 1995, "Pyramid-based texture analysis/synthesis", in colour: noise made into a texture.

Section 3's loop on each decorrelated channel (section 4.2):

    x <- white noise, its pixels given the photo's histogram
    repeat:  every band of x's steerable pyramid is given the histogram of the photo's band; x <- the pyramid collapsed;
             x's pixels are given the photo's histogram

Marginals of bands are all it knows, as many as a few thousand numbers a channel; it has neither formula nor extent beyond
the picture that was synthesised. The pyramid is pyrtools' SteerablePyramidFreq, of the laboratory that designed it.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from voldetail.image import to_linear, to_srgb

Picture = NDArray[np.float32]
Plane = NDArray[np.float64]

ITERATIONS = 5
LEVELS, ORIENTATIONS = 4, 4

MARGIN = 3
"""Samples at a photo's borders that do not count, in each band: the pyramid takes the photo for periodic, and what the jump
from one border to the other leaves there is no texture. The residual of the coarsest level, a few samples wide, gives an
eighth of its side at most."""


def synthesise(
    photo: Picture,
    size: tuple[int, int],
    *,
    seed: int = 0,
    iterations: int = ITERATIONS,
    levels: int = LEVELS,
    orientations: int = ORIENTATIONS,
) -> Picture:
    """Return a texture of `size` = (rows, columns) like `photo` (H, W, 3), both linear light of 0 to 1.

    Sides have to be multiples of 2^levels. Colours are decorrelated as they are seen, sRGB-encoded.
    """
    step = 2**levels
    if any(side % step for side in (*photo.shape[:2], *size)):
        raise ValueError(f"the sides {photo.shape[:2]} and {size} have to be multiples of {step}")
    encoded = to_srgb(photo).astype(np.float64)
    mean, axes = decorrelated(encoded)
    channels = (encoded - mean) @ axes
    rng = np.random.default_rng(seed)
    made = [_channel(channels[..., c], rng.standard_normal(size), iterations, levels, orientations) for c in range(3)]
    colours = np.stack(made, axis=-1) @ axes.T + mean
    return to_linear(np.clip(colours, 0, 1))


def decorrelated(encoded: NDArray[np.floating]) -> tuple[Plane, Plane]:
    """Return the mean colour (3,) and the principal axes (3, 3), a column each, the most varied first."""
    colours = encoded.reshape(-1, 3).astype(np.float64)
    _, axes = np.linalg.eigh(np.cov(colours.T))
    axes = axes[:, ::-1]
    return colours.mean(axis=0), axes * np.where(axes.sum(axis=0) < 0, -1, 1)


def bands(plane: Plane, levels: int = LEVELS, orientations: int = ORIENTATIONS) -> dict[Any, Plane]:
    """Return the bands of a channel's steerable pyramid and its two residuals."""
    found: dict[Any, Plane] = _pyramid(plane, levels, orientations).pyr_coeffs
    return found


def matched(values: Plane, like: Plane) -> Plane:
    """Return `values`, in the same order by size, with the histogram of `like`, which may have any other shape."""
    ranks = np.empty(values.size)
    ranks[np.argsort(values, axis=None, kind="stable")] = (np.arange(values.size) + 0.5) / values.size
    ordered = np.sort(like, axis=None)
    return np.interp(ranks, (np.arange(ordered.size) + 0.5) / ordered.size, ordered).reshape(values.shape)


def inner(band: Plane) -> Plane:
    """Return a band without what the photo's borders reach."""
    rows, columns = (min(MARGIN, side // 8) for side in band.shape)
    return band[rows : band.shape[0] - rows, columns : band.shape[1] - columns]


def _channel(photo: Plane, noise: Plane, iterations: int, levels: int, orientations: int) -> Plane:
    wanted: Mapping[Any, Plane] = {key: inner(band) for key, band in bands(photo, levels, orientations).items()}
    made = matched(noise, photo)
    for _ in range(iterations):
        pyramid = _pyramid(made, levels, orientations)
        pyramid.pyr_coeffs = {key: matched(band, wanted[key]) for key, band in pyramid.pyr_coeffs.items()}
        made = matched(pyramid.recon_pyr(), photo)
    return made


def _pyramid(plane: Plane, levels: int, orientations: int) -> Any:
    # Imported here: only this rival needs it, and it comes with the extra "test".
    from pyrtools.pyramids import SteerablePyramidFreq

    return SteerablePyramidFreq(plane, height=levels, order=orientations - 1)
