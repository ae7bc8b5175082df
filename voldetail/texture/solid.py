"""Weights for 3D noise whose plane slices look like the 2D texture.

A slice through a band-limited solid noise is not band-limited (Cook and DeRose 2005, section 3): a slice meets high
frequencies at a slant, where they look low. A 3D band puts about 4^-k of its power k octaves below its own. So

    sum_i SLICE_SHARE[b - i] s3^2 v_i^2 = sum_i PLANE_SHARE[b - i] s2^2 w_i^2      for every frequency band b,

solved for v_i^2 >= 0 by least squares, gives a slice the power by octave of the 2D texture with weights w_i. A slice cannot
fall off towards low frequencies faster than its highest band does (4^-k, about white noise): where the photo does, the rest
stays. The curve is applied to the noise divided by its own deviation, so the histogram is right in any case.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from scipy.optimize import nnls

from voldetail.noise.wavelet_spectrum import variance
from voldetail.types import Floats

FINEST_SHARE = -1
"""The octave, relative to the band's own, of the first number in the two tables below."""

PLANE_SHARE = (0.0732, 0.8397, 0.0866)
"""Share of a 2D band's variance in the octaves from one finer to two coarser. Made by
    line = taper_line(8192, 1.0); m = leak_matrix(line, line, 9) / variance(2); (m[2:5, 3] + m[3:6, 4]) / 2"""

SLICE_SHARE = (0.0584, 0.6091, 0.2604, 0.0529, 0.0141, 0.0037)
"""Share of a 3D band's variance in a slice, from one octave finer to four coarser; each octave beyond has a quarter of the
last. The mean over the planes xy, xz and yz of the turned lattice (they differ by 1 %, 2 % and, two octaves down, by 12 %).
Made by `slice_shares` of tests/unit/wavelet_reference.py."""


def share(table: tuple[float, ...], octaves: int) -> float:
    """Return the share of a band's variance ``octaves`` below its own, from one of the two tables."""
    index = octaves - FINEST_SHARE
    if index < 0:
        return 0.0
    if index < len(table):
        return table[index]
    return table[-1] * 0.25 ** (index - len(table) + 1) if table is SLICE_SHARE else 0.0


def share_matrix(table: tuple[float, ...], count: int) -> Floats:
    """Return (count, count): share of each noise band's variance (columns) in each frequency band (rows).

    What is finer than the finest frequency band is folded back into it by the raster.
    """
    matrix = np.array([[share(table, b - i) for i in range(count)] for b in range(count)])
    matrix[0, 0] += share(table, FINEST_SHARE)
    return matrix


@lru_cache(maxsize=256)
def slice_weights(weights: tuple[float, ...]) -> tuple[float, ...]:
    """Return the weights v_i (as many) of 3D bands of which a slice has the power by octave of the 2D bands w_i."""
    if not any(weights):
        return weights
    squares = np.square(np.asarray(weights))
    wanted = variance(2) * (share_matrix(PLANE_SHARE, len(weights)) @ squares)
    matrix = variance(3) * share_matrix(SLICE_SHARE, len(weights))
    # An octave's error counts by its own size, but none that is under a hundredth of all.
    size = 1.0 / np.maximum(wanted, 0.01 * wanted.sum())
    found, _ = nnls(matrix * size[:, None], wanted * size)
    return tuple(np.sqrt(found).tolist())
