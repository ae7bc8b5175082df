"""The maps of a photo's relief as Gaussian scores, and the way back: what can be mixed without losing contrast.

Height and albedo are four channels. The albedo's are turned to their principal axes first, along which they are uncorrelated
(LVLD10 section 5.1 does so for colour textures); each channel's ranks become normal deviates, whose mixtures are normal again.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import zoom

from voldetail.detail.parameters import LUMINANCE_WEIGHTS
from voldetail.detail.photo_relief import MappedDetail
from voldetail.texture.analysis import principal_axes
from voldetail.texture.gaussian import gaussianise

CHANNELS = 4
QUANTILES = 256
FARTHEST = 3.5
"""Scores between which quantiles are kept: beyond lie 5 of 10 000 values."""

FLATTEST = 1e-6
"""Deviation of a channel below which it is constant."""


@dataclass(frozen=True, eq=False)
class Scores:
    """values (H, W, 4): normal deviates of height and of the albedo along its axes. plain (H, W, 4): height, red, green, blue.

    quantiles (4, QUANTILES): the channels' values at equally spaced scores of -farthest to farthest. axes (3, 3): a column an
    axis, mean (3,): of the albedo. luminance: of the albedo's mean. factor: how many texels of the maps became one.
    """

    values: NDArray[np.float32]
    plain: NDArray[np.float32]
    quantiles: NDArray[np.float32]
    axes: NDArray[np.float64]
    mean: NDArray[np.float64]
    luminance: float
    factor: float
    farthest: float = FARTHEST


def scores_of(detail: MappedDetail, spacing: float) -> Scores:
    """Return the scores of the maps, made smaller first where points are more than a texel apart (``spacing``, in texels)."""
    luminance = float(detail.albedo.reshape(-1, 3).mean(axis=0) @ np.asarray(LUMINANCE_WEIGHTS))
    factor = 2 ** max(0, int(np.floor(np.log2(max(spacing, 1.0)))))
    factor = min(factor, max(1, min(detail.height.shape) // 8))
    plain = np.concatenate([_averaged(detail.height[..., None], factor), _averaged(detail.albedo, factor)], axis=-1)
    colour = plain[..., 1:].reshape(-1, 3).astype(np.float64)
    mean = colour.mean(axis=0)
    axes = principal_axes(plain[..., 1:].reshape(-1, 3)).T
    turned = np.concatenate([plain[..., :1].reshape(-1, 1), (colour - mean) @ axes], axis=1)
    scores, quantiles = zip(*(_gaussian(turned[:, c]) for c in range(CHANNELS)), strict=True)
    values = np.stack(scores, axis=-1).reshape(plain.shape).astype(np.float32)
    return Scores(values, plain, np.stack(quantiles).astype(np.float32), axes, mean, max(luminance, 1e-4), float(factor))


def _averaged(values: NDArray[np.float32], factor: int) -> NDArray[np.float32]:
    """Return the means of blocks of ``factor`` squared texels; what is left at the edges is stretched in."""
    if factor == 1:
        return np.asarray(values, np.float32)
    rows, columns = (max(1, s // factor) for s in values.shape[:2])
    if values.shape[0] != rows * factor or values.shape[1] != columns * factor:
        grow = (rows * factor / values.shape[0], columns * factor / values.shape[1], 1)
        values = zoom(values, grow, order=1, mode="nearest", grid_mode=True)[: rows * factor, : columns * factor]
    blocks = values.reshape(rows, factor, columns, factor, values.shape[-1])
    return np.asarray(blocks.mean(axis=(1, 3)), np.float32)


def _gaussian(values: NDArray[np.float64]) -> tuple[NDArray[np.floating], NDArray[np.float64]]:
    """Return the normal deviates of ``values`` (N,), by ranks, and their quantiles at equally spaced deviates."""
    if values.std() < FLATTEST:
        return np.zeros(len(values)), np.full(QUANTILES, values.mean())
    return gaussianise(values, np.linspace(-FARTHEST, FARTHEST, QUANTILES))
