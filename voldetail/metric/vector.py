"""Descriptors of the default metric as rows of numbers, to be kept in tables and compared with any photo's.

What "combined" measures of a picture does not hang on its reference: that fixes units and noise floors alone, and both enter
when two descriptors are compared. So a row can be written without a photo, and its distance from one is the metric's own.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from voldetail.errors import InputError
from voldetail.metric import magnitudes, patterns, quantiles
from voldetail.metric.descriptor import Descriptor, describe
from voldetail.metric.filters import WINDOW
from voldetail.metric.ingredients import COMBINED, Array
from voldetail.metric.layers import LEVELS

APART: Mapping[str, Callable[[Array, Array, Array | None], Array]] = {
    "magnitudes": magnitudes.apart, "patterns": patterns.apart, "marginals": quantiles.apart, "spectrum": quantiles.apart,
    "granulometry": quantiles.apart, "swells": quantiles.apart,
}  # fmt: skip
"""How each ingredient compares many at once."""

ROWS_VERSION = 1
"""Counts changes of what is measured that no constant in `definition` tells."""

BLOCK = 128
"""Rows compared at once: what is worked on stays in the processor's cache."""


def row_of(found: Descriptor) -> Array:
    """Return the weighed statistics of a "combined" descriptor in one row (L,), float32, in the order of `parts`.

    Raises InputError for a descriptor under another metric.
    """
    _check(found)
    return np.concatenate([found.features[name][part].ravel() for name, part, _ in parts()]).astype(np.float32)


def distances(photo: Descriptor, rows: NDArray[np.floating]) -> NDArray[np.float64]:
    """Return the distances (N,) of ``rows`` (N, L) from ``photo``, a "combined" descriptor, as `distance` gives them.

    Raises InputError for another metric, and rows of another length.
    """
    _check(photo)
    if rows.ndim != 2 or rows.shape[1] != row_length():
        raise InputError(f"The rows have the shape {rows.shape}; (rows, {row_length()}) is needed.")
    out = np.zeros(len(rows))
    for start in range(0, len(rows), BLOCK):
        block, first = np.asarray(rows[start : start + BLOCK], np.float32), 0
        for name, part, shape in parts():
            size = int(np.prod(shape))
            b = block[:, first : first + size].reshape(-1, *shape)
            weight = COMBINED[name][part] / photo.floors[name, part]
            found = APART[name](photo.features[name][part], b, photo.basis[name].get(part))
            out[start : start + BLOCK] += weight * found
            first += size
    return out


@lru_cache(maxsize=1)
def parts() -> tuple[tuple[str, str, tuple[int, ...]], ...]:
    """Return ingredient, part and shape of what a row holds, in order; all pictures have the same."""
    some = describe(np.random.default_rng(0).random((64, 64)).astype(np.float32))
    return tuple((name, part, some.features[name][part].shape) for name, weights in COMBINED.items() for part in weights)


def definition() -> dict[str, Any]:
    """Return all that decides a row, as JSON has it: what stored rows were measured with."""
    return {
        "version": ROWS_VERSION, "parts": [[name, part, list(shape)] for name, part, shape in parts()], "levels": LEVELS,
        "window": WINDOW,
    }  # fmt: skip


def row_length() -> int:
    """Return L."""
    return sum(int(np.prod(shape)) for _, _, shape in parts())


def _check(found: Descriptor) -> None:
    if found.metric != "combined":
        raise InputError(f"Rows are kept of the metric combined, and this descriptor is of {found.metric}.")
