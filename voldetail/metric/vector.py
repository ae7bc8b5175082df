"""Descriptors of the default metric as vectors, to be kept in tables and compared with any photo's.

What "combined" measures of a picture does not hang on its reference: that fixes units and noise floors alone, and both enter
when two descriptors are compared. So a vector can be written without a photo, and its distance from one is the metric's own.
"""

from __future__ import annotations

from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from voldetail.errors import InputError
from voldetail.metric.descriptor import FORMER_NAMES, Descriptor, describe
from voldetail.metric.filters import WINDOW
from voldetail.metric.ingredients import COMBINED, INGREDIENTS, Array
from voldetail.metric.layers import LEVELS

VECTOR_VERSION = 1
"""Counts changes of what is measured that no constant in `definition` tells."""

NAMES_IN_FILES = {now: former for former, now in FORMER_NAMES.items()}
"""Ingredients as the libraries name them that were made under a former name: they are no others."""

BLOCK = 128
"""Vectors compared at once: what is worked on stays in the processor's cache."""


def combined_vector(descriptor: Descriptor) -> Array:
    """Return the weighed statistics of a "combined" descriptor as one vector (L,), float32, in the order of `parts`.

    Raises InputError for a descriptor under another metric.
    """
    _check(descriptor)
    return np.concatenate([descriptor.features[name][part].ravel() for name, part, _ in parts()]).astype(np.float32)


def distances(photo: Descriptor, vectors: NDArray[np.floating]) -> NDArray[np.float64]:
    """Return the distances (N,) of ``vectors`` (N, L) from ``photo``, a "combined" descriptor, as `distance` gives them.

    Raises InputError for another metric, and vectors of another length.
    """
    _check(photo)
    if vectors.ndim != 2 or vectors.shape[1] != vector_length():
        raise InputError(f"The vectors have the shape {vectors.shape}; (vectors, {vector_length()}) is needed.")
    out = np.zeros(len(vectors))
    for start in range(0, len(vectors), BLOCK):
        block, first = np.asarray(vectors[start : start + BLOCK], np.float32), 0
        for name, part, shape in parts():
            size = int(np.prod(shape))
            b = block[:, first : first + size].reshape(-1, *shape)
            weight = COMBINED[name][part] / photo.floors[name, part]
            apart = INGREDIENTS[name].apart(photo.features[name][part], b, photo.basis[name].get(part))
            out[start : start + BLOCK] += weight * apart
            first += size
    return out


@lru_cache(maxsize=1)
def parts() -> tuple[tuple[str, str, tuple[int, ...]], ...]:
    """Return ingredient, part and shape of what a vector holds, in order; all pictures have the same."""
    some = describe(np.random.default_rng(0).random((64, 64)).astype(np.float32))
    return tuple((name, part, some.features[name][part].shape) for name, weights in COMBINED.items() for part in weights)


def definition() -> dict[str, Any]:
    """Return all that decides a vector, as JSON has it: what stored ones were measured with."""
    return {
        "version": VECTOR_VERSION,
        "parts": [[NAMES_IN_FILES.get(name, name), part, list(shape)] for name, part, shape in parts()],
        "levels": LEVELS, "window": WINDOW,
    }  # fmt: skip


def vector_length() -> int:
    """Return L."""
    return sum(int(np.prod(shape)) for _, _, shape in parts())


def _check(descriptor: Descriptor) -> None:
    if descriptor.metric != "combined":
        raise InputError(f"Vectors are kept of the metric combined, and this descriptor is of {descriptor.metric}.")
