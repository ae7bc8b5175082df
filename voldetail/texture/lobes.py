"""The few lobes whose noise has a channel's power spectrum: the analysis of Gabor noise by example (Galerne, Lagae, Lefebvre
and Drettakis, ACM TOG 31(4), 2012), by a Gaussian mixture instead of a sparse choice out of a dictionary.

Symbols
    z          the channel, mapped by rank to a Gaussian law
    S          its blurred power spectrum (texture.spectrum), beta the deviation of the blur
    v, b, c    a lobe's variance, and its deviations along and across its frequency: b^2 = b'^2 - beta^2 for the fitted b'

What lies below a few cycles across the photo is one or two lobes at zero. No lobe is thinner than LEAST_BLUR beta, so
the noise has forgotten its value after about a third of the photo's shorter side: it keeps such power and cannot drift.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from voldetail.detail.colour import MOST_LOBES, Lobe
from voldetail.texture.mixture import Bins, Pairs, binned, first_pairs, fit_pairs
from voldetail.texture.spectrum import Spectrum, power_spectrum

COUNT = 24
"""Lobes looked for: on nine photos twice as many lower the divergence by at most 0.02 nats, and a third of them raise it by
at most 0.1; only ruled stripes, a row of harmonics, ask for more."""

LEAST_BLUR = 0.5
"""Least deviation of a lobe, of the blur's: what is thinner cannot be told from it."""

LEAST_SHARE = 0.002
"""Lobes with less of the variance are left out, and the others grow for it."""

MOST_FREQUENCY, MOST_BANDWIDTH = 0.75, 0.5


def lobes_of(channel: NDArray[np.float64], mask: NDArray[np.bool_] | None = None, count: int = COUNT) -> tuple[Lobe, ...]:
    """Return at most ``count`` lobes (1 to 64) for ``channel`` (H, W), row 0 on top, the one of most variance first.

    Frequencies in cycles per texel, angles counter-clockwise with y up, so a picture's row r lies at y = -r. The variances
    add up to that of the channel. Of ``mask`` (H, W) only what is True counts. Raises InputError for a channel that is too
    small, not finite or constant, ValueError for another count.
    """
    if not 1 <= count <= MOST_LOBES:
        raise ValueError(f"count is {count}, and has to be from 1 to {MOST_LOBES}")
    spectrum = power_spectrum(channel, mask)
    bins = binned(spectrum.power, spectrum.fx, spectrum.fy)
    return _lobes(_kept(bins, fit_pairs(bins, first_pairs(bins, count, spectrum.blur), spectrum.blur)), spectrum)


def lobe_rows(lobes: Sequence[Lobe]) -> NDArray[np.float64]:
    """Return the numbers of ``lobes`` as `noise.lobes.lobe_table` reads them: (n, 5), the last column their variances."""
    return np.array(
        [(v.frequency, v.angle, v.bandwidth, v.bandwidth if v.across is None else v.across, v.variance) for v in lobes]
    )


def _kept(bins: Bins, pairs: Pairs) -> Pairs:
    """Return the pairs without those that hardly count."""
    good = pairs.share >= min(LEAST_SHARE, pairs.share.max())
    share = pairs.share[good]
    return Pairs(share / share.sum(), pairs.centre[good], pairs.angle[good], pairs.deviation[good])


def _lobes(pairs: Pairs, spectrum: Spectrum) -> tuple[Lobe, ...]:
    least = (LEAST_BLUR * spectrum.blur) ** 2
    deviation = np.minimum(np.sqrt(np.maximum(pairs.deviation**2 - spectrum.blur**2, least)), MOST_BANDWIDTH)
    return tuple(
        Lobe(
            frequency=min(float(np.hypot(*pairs.centre[k])), MOST_FREQUENCY),
            angle=float(pairs.angle[k] % math.pi),
            bandwidth=float(deviation[k, 0]),
            across=float(deviation[k, 1]),
            variance=float(pairs.share[k] * spectrum.variance),
        )
        for k in np.argsort(-pairs.share, kind="stable")
    )
