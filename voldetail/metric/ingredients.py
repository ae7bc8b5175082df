"""The ways of measuring texture, by name, and how the default metric weighs them."""

from collections.abc import Mapping
from types import MappingProxyType
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from voldetail.metric import jets, magnitudes, marginals, patches, patterns, published, spectrum, tone
from voldetail.metric.layers import Layers

Array = NDArray[np.float32]
Parts = Mapping[str, Array]


class Ingredient(Protocol):
    """One way of measuring texture: what it fixes from the reference, what it measures, how it compares one part."""

    def basis(self, layers: Layers, /) -> Parts: ...
    def measure(self, layers: Layers, basis: Parts, /) -> Parts: ...
    def compare(self, a: Array, b: Array, basis: Array | None, /) -> float: ...


INGREDIENTS: Mapping[str, Ingredient] = MappingProxyType(
    {
        "published": published,
        "spectrum": spectrum,
        "marginals": marginals,
        "magnitudes": magnitudes,
        "patterns": patterns,
        "patches": patches,
        "jets": jets,
        "tone": tone,
    }
)

COMBINED: Mapping[str, Mapping[str, float]] = MappingProxyType({})
