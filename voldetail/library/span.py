"""Structure maps on the scale of 0 to 1 that photos have.

    s' = (s - low) / (high - low), held in [0, 1],      low, high: quantiles of s

A photo's structure has its tones at 0 and 1 whatever they are (`two_tone`). A model's own may stay between 0.1 and 0.8, and would
never be like a photo of itself, so entries are brought to the same scale in the same way before they are described. The paper
does not say so of its entries; results/retrieval has what it is worth.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from voldetail.texture.analysis import CONSTANT

Span = tuple[float, float]

TRIM = 0.005
"""Share of pixels, at either end, that may lie beyond the tones. The paper takes a photo's extreme pixels; a speck then leaves
the rest a contrast that no entry has, and sand becomes streaks. Tuned on 33 photographs, see results/retrieval."""


def span_of(structure: ArrayLike, trim: float = TRIM) -> Span:
    """Return (low, high) of a structure map: ``trim`` of its pixels lie under and over; the extremes where those are one."""
    s = np.asarray(structure, np.float32)
    low, high = (float(v) for v in np.quantile(s, [trim, 1.0 - trim]))
    if high - low < CONSTANT:
        low, high = float(s.min()), float(s.max())
    return low, max(high, low + CONSTANT)


def spanned(structure: ArrayLike, span: Span) -> NDArray[np.float32]:
    """Return a structure map on the scale of 0 to 1 of a ``span``."""
    low, high = span
    return np.asarray(np.clip((np.asarray(structure, np.float32) - low) / (high - low), 0.0, 1.0), np.float32)
