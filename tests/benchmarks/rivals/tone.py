"""Distribution of the encoded pixel values, which says nothing about where they lie."""

from voldetail.metric.layers import Layers
from voldetail.metric.quantiles import Array, Parts, quantile_functions, spread, wasserstein


def basis(layers: Layers, /) -> Parts:
    """Standard deviation of the reference's values, (1, 1)."""
    return {name: spread(functions) for name, functions in measure(layers, {}).items()}


def measure(layers: Layers, basis: Parts, /) -> Parts:
    """Quantile function (1, 32) of the values inside the mask."""
    return {"values": quantile_functions(layers.pick(layers.images[0][None], 0, 1))}


def compare(a: Array, b: Array, basis: Array | None, /) -> float:
    """1-Wasserstein distance in the reference's standard deviations."""
    return float(wasserstein(a, b, basis))
