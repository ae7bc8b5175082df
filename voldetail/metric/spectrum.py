"""The published responses compared by the 1-Wasserstein distance of their amplitudes, not bin by bin.

Histograms that miss each other by one bin or by thirty are equally far apart bin by bin; the Wasserstein distance
still says which of two wrong pictures is less wrong, so a search can follow it.
"""

from voldetail.metric.layers import LEVEL_NAMES, Layers
from voldetail.metric.quantiles import Array, Parts, quantile_functions, spread, wasserstein


def basis(layers: Layers, /) -> Parts:
    """Standard deviation of the reference's amplitudes, (17, 1) a level."""
    return {name: spread(functions) for name, functions in measure(layers, {}).items()}


def measure(layers: Layers, basis: Parts, /) -> Parts:
    """Quantile functions of the amplitudes, (17, 32) a level."""
    found: dict[str, Array] = {}
    for level, name in enumerate(LEVEL_NAMES):
        picked = layers.pick(layers.maps[level], level, stride=1 if level else 2)
        found[name] = quantile_functions(picked)
    return found


def apart(a: Array, b: Array, basis: Array | None, /) -> Array:
    """Mean over frequencies, in standard deviations of the reference."""
    return wasserstein(a, b, basis)
