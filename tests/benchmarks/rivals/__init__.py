"""Ways of measuring texture that are compared in the table and are not in the package; most take unmasked pictures only."""

from collections.abc import Mapping
from types import MappingProxyType
from typing import Protocol

from tests.benchmarks.rivals import contours, jets, patches, portilla, random_features, sliced, tone
from voldetail.metric.layers import Layers
from voldetail.metric.quantiles import Array, Parts


class Rival(Protocol):
    """What it fixes from the reference, what it measures, how it compares one part."""

    def basis(self, layers: Layers, /) -> Parts: ...
    def measure(self, layers: Layers, basis: Parts, /) -> Parts: ...
    def compare(self, a: Array, b: Array, basis: Array | None, /) -> float: ...


RIVALS: Mapping[str, Rival] = MappingProxyType(
    {
        "patches": patches, "jets": jets, "tone": tone,
        "portilla": portilla, "sliced": sliced, "random": random_features, "contours": contours,
    }
)  # fmt: skip
