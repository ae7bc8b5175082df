"""What an entry's picture is described with, of which there are two: one measure for all entries of a library.

structures   the vector of GKHF14 section 4, see `vectors`: two-tone maps, compared in any turn
reliefs      the project's own metric, see `metric.vector`: pictures of reliefs under one light
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Literal

from voldetail.library import vectors
from voldetail.metric import vector

MeasureName = Literal["structures", "reliefs"]


@dataclass(frozen=True)
class Measure:
    """A way of describing pictures.

    length: numbers of a vector. kind: of number they are kept as. definition: all that decides them, as JSON has it. outlined:
    whether norms and outlines are kept beside the vectors (see `tables`), which queries need that turn the picture.
    """

    name: MeasureName
    length: Callable[[], int]
    kind: Literal["float16", "float32"]
    definition: Callable[[], dict[str, Any]]
    outlined: bool


MEASURES: dict[str, Measure] = {
    "structures": Measure("structures", lambda: vectors.LENGTH, "float32", vectors.definition, True),
    # Half precision changes a distance by a thousandth at most (tests/unit/test_metric_vector.py).
    "reliefs": Measure("reliefs", vector.vector_length, "float16", vector.definition, False),
}
"""The measures by name."""
