"""One model's entries as a query sees them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from voldetail.library.pieces import Rows
from voldetail.library.tables import Table


@dataclass(frozen=True, eq=False)
class Group:
    """Entries of one model: its name, the names of its numbers, their values (N, numbers), and the descriptors' table.

    seed: of the noise in the entries' pictures. Row k of ``values`` belongs to entry k of ``table``.
    """

    model: str
    keys: tuple[str, ...]
    values: NDArray[np.float64] | Rows[np.float64]
    table: Table
    seed: int

    def parameters(self, entry: int) -> dict[str, float]:
        """Return the numbers of an entry by name."""
        return {key: float(value) for key, value in zip(self.keys, self.values[entry], strict=True)}


Groups = Mapping[str, Group]


@dataclass(frozen=True, eq=False)
class Series:
    """Reliefs under one light: its name, the names of their numbers, values (N, numbers), vectors (N, L) of `metric.vector`.

    seed: of all that is random in them. definition: what else decides them, as their source says.
    """

    name: str
    keys: tuple[str, ...]
    values: NDArray[np.float64] | Rows[np.float64]
    vectors: NDArray[np.float16] | Rows[np.float16]
    seed: int
    definition: Mapping[str, Any]
