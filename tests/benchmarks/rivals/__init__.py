"""Ways of measuring texture that are compared in the table and are not in the package: unmasked pictures only."""

from types import MappingProxyType

from tests.benchmarks.rivals import contours, portilla, random_features, sliced
from voldetail.metric.ingredients import Ingredient

RIVALS: MappingProxyType[str, Ingredient] = MappingProxyType(
    {"portilla": portilla, "sliced": sliced, "random": random_features, "contours": contours}
)
