"""The package's metrics and the benchmark's rivals behind one face: a reference picture, and distances from it."""

import dataclasses
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tests.benchmarks.rivals import RIVALS
from tests.benchmarks.texture_pictures import Picture
from voldetail.metric import METRICS, Descriptor, describe, distance
from voldetail.metric.descriptor import describe_layers
from voldetail.metric.layers import Layers, layers
from voldetail.metric.quantiles import Parts

YARDSTICKS = (*METRICS, *RIVALS)


@dataclass(frozen=True)
class Reference:
    """A picture described by one metric: a Descriptor, or what a rival fixed and measured."""

    metric: str
    descriptor: Descriptor | None
    basis: Parts
    features: Parts

    def measure(self, picture: Layers) -> "Descriptor | Parts":
        """What `apart` wants of another picture."""
        if self.descriptor is not None:
            return describe_layers(picture, self.descriptor)
        return RIVALS[self.metric].measure(picture, self.basis)

    def apart(self, measured: "Descriptor | Parts") -> float:
        """Distance of a picture that was measured like this or, for most metrics, like any other reference."""
        if self.descriptor is not None:
            assert isinstance(measured, Descriptor)
            alike = dataclasses.replace(measured, basis=self.descriptor.basis, floors=self.descriptor.floors)
            return distance(self.descriptor, alike)
        assert not isinstance(measured, Descriptor)
        rival = RIVALS[self.metric]
        return sum(rival.compare(a, measured[name], self.basis.get(name)) for name, a in self.features.items())

    def distance(self, picture: Picture, mask: NDArray[np.bool_] | None = None) -> float:
        return self.apart(self.measure(layers(picture, mask)))


def reference(picture: Picture, metric: str, mask: NDArray[np.bool_] | None = None) -> Reference:
    """Describe a picture that others are compared with, inside ``mask``."""
    if metric in METRICS:
        return Reference(metric, describe(picture, mask, metric=metric), {}, {})
    seen, rival = layers(picture, mask), RIVALS[metric]
    basis = rival.basis(seen)
    return Reference(metric, None, basis, rival.measure(seen, basis))


def distances(references: Sequence[Reference], picture: Layers) -> list[float]:
    """Distances of one picture from many references of one metric."""
    measured, found = None, []
    for one in references:
        # Only the published metric's features, and not their comparison alone, depend on the reference.
        if measured is None or one.metric == "published":
            measured = one.measure(picture)
        found.append(one.apart(measured))
    return found
