"""Entries of a library: a structure model's parameters and the descriptor of the picture that they give (GKHF14 section 5).

An entry's parameters follow from the model, the seed and the entry's number alone: entry k is the same whoever computes it,
in whatever order, and a library may be built in parts.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal
from zlib import crc32

import numpy as np
from numpy.typing import NDArray

from voldetail.errors import InputError
from voldetail.library.span import span_of, spanned
from voldetail.library.vectors import LENGTH, vector_of
from voldetail.texture.structures import StructureModel, structure

Sampling = Literal["random", "grid"]

SIDE = 256
"""Pixels of an entry's picture, the paper's."""

ENTRIES_VERSION = 2
"""Counts changes of what an entry is: of the draws here, and of the models' pictures and their span. A stored library of another
version has other entries under the same numbers."""


@dataclass(frozen=True, eq=False)
class Entries:
    """Entries first, first + 1, ... of a model: values (N, parameters) in the model's order, vectors (N, 750) float32."""

    model: str
    seed: int
    sampling: Sampling
    first: int
    values: NDArray[np.float64]
    vectors: NDArray[np.float32]


def random_values(model: StructureModel, k: int, seed: int = 0) -> dict[str, float]:
    """Return the parameters of random entry ``k``: even over each range in its own spread (lengths by ratios).

    Raises InputError for a negative number or seed.
    """
    _check_number(k)
    if seed < 0:
        raise InputError(f"The seed is {seed}; a whole number of at least 0 is needed.")
    # The generator is named, so that the numbers do not hang on which one NumPy likes best.
    numbers = np.random.Generator(np.random.PCG64([seed, crc32(model.name.encode()), k])).random(len(model.parameters))
    return {p.key: p.at(float(share)) for p, share in zip(model.parameters, numbers, strict=True)}


def grid_values(model: StructureModel, k: int) -> dict[str, float]:
    """Return the parameters of grid entry ``k``, 0 to model.grid_size - 1; the last parameter changes fastest.

    Raises InputError for a number outside the grid.
    """
    _check_number(k)
    if k >= model.grid_size:
        raise InputError(f"The grid of {model.name} has {model.grid_size} entries, and entry {k} is asked for.")
    found = {}
    for parameter in reversed(model.parameters):
        k, index = divmod(k, parameter.stops)
        found[parameter.key] = parameter.stop(index)
    return {p.key: found[p.key] for p in model.parameters}


def entry(
    model: StructureModel, k: int, seed: int = 0, sampling: Sampling = "random", side: int = SIDE
) -> tuple[dict[str, float], NDArray[np.float32]]:
    """Return the parameters of entry ``k`` and the descriptor (750,) of its picture, of ``side`` pixels, noise of ``seed``.

    The picture is described on the scale of 0 to 1 that photos have, see `span`.
    """
    values = grid_values(model, k) if sampling == "grid" else random_values(model, k, seed)
    s = structure(model, values, side, seed=seed)
    return values, vector_of(spanned(s, span_of(s)))


def entries(
    model: StructureModel, first: int, count: int, seed: int = 0, sampling: Sampling = "random", side: int = SIDE
) -> Entries:
    """Return ``count`` entries from number ``first`` on, one chunk of a library.

    Raises InputError for a negative first, a count under 1 and, on a grid, numbers outside it.
    """
    _check_number(first)
    if count < 1:
        raise InputError(f"{count} entries are asked for; at least one is needed.")
    values = np.empty((count, len(model.parameters)), np.float64)
    vectors = np.empty((count, LENGTH), np.float32)
    for row in range(count):
        found, vectors[row] = entry(model, first + row, seed, sampling, side)
        values[row] = list(found.values())
    return Entries(model.name, seed, sampling, first, values, vectors)


def _check_number(k: int) -> None:
    if k < 0:
        raise InputError(f"Entries are counted from 0, and entry {k} is asked for.")
