"""Texture descriptors and the distance between them: the single hinge between pictures and a search."""

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from voldetail.errors import InputError
from voldetail.metric.floors import noise_floors
from voldetail.metric.ingredients import COMBINED, INGREDIENTS, Array, Parts
from voldetail.metric.layers import Layers, Mask, layers

METRICS: tuple[str, ...] = ("combined", *INGREDIENTS)
"""Names of the metrics; "published" is GD10's own."""

FORMER_NAMES: Mapping[str, str] = MappingProxyType({"swells": "low-pass", "lean": "gradient-skew"})
"""What metrics were called before, by which they are still known."""

_Key = tuple[str, str]


@dataclass(frozen=True, eq=False)
class Descriptor:
    """Texture statistics of one picture under one metric, comparable with those described `like` the same reference.

    `basis` holds what the reference fixed (histogram ranges, units) and `features` the statistics measured, each by
    ingredient and part; `floors` the noise floor of each (ingredient, part), for "combined" only: how far apart two
    halves of the reference, a slightly enlarged and a slightly brighter copy of it lie.
    """

    metric: str
    basis: Mapping[str, Parts]
    features: Mapping[str, Parts]
    floors: Mapping[_Key, float]


def metric_named(name: str) -> str:
    """Return the one of METRICS that is called ``name``, or was; raises InputError for another."""
    metric = FORMER_NAMES.get(name, name)
    if metric not in METRICS:
        raise InputError(f"There is no metric {name!r}; use one of {', '.join(METRICS)}.")
    return metric


def describe(
    luminance: NDArray[np.floating],
    mask: Mask | None = None,
    *,
    like: Descriptor | None = None,
    metric: str = "combined",
) -> Descriptor:
    """Describe the texture of a picture, as a reference or `like` one.

    `luminance` is (H, W), linear light, any range >= 0, at least 32 x 32; it is sRGB-encoded inside, as photographs
    are seen. `mask` is (H, W) bool, True = use; only filter windows wholly inside it count, at every level. With
    `like`, the metric, histogram ranges, units and noise floors of that reference are used and `metric` is ignored.
    Raises InputError for an unknown metric, a wrong shape, values that are not finite, or a mask smaller than the
    filters.
    """
    picture = layers(luminance, mask)
    if like is not None:
        return describe_layers(picture, like)
    metric = metric_named(metric)
    names = tuple(COMBINED) if metric == "combined" else (metric,)
    basis = {name: INGREDIENTS[name].basis(picture) for name in names}
    reference = describe_layers(picture, Descriptor(metric, basis, {}, {}))
    if metric != "combined":
        return reference
    floors = noise_floors(luminance, mask, picture, lambda a, b: _raw_parts(a, b, reference))
    return Descriptor(metric, basis, reference.features, floors)


def describe_layers(picture: Layers, like: Descriptor) -> Descriptor:
    """Describe a picture whose pyramid is built already, `like` a reference."""
    features = {name: INGREDIENTS[name].measure(picture, basis) for name, basis in like.basis.items()}
    return Descriptor(like.metric, like.basis, features, like.floors)


def distance(a: Descriptor, b: Descriptor) -> float:
    """How unlike two textures are: 0 for identical pictures, the sum of `distance_by_level`.

    "published" is M of GD10 section 5. "combined" is a weighted mean of distances in units of the reference's noise
    floor: about 1 for another crop of the same photo. The other metrics sum their parts.
    Raises InputError unless both were described alike.
    """
    return sum(distance_by_level(a, b).values())


def distance_by_level(a: Descriptor, b: Descriptor) -> dict[str, float]:
    """The parts of `distance`: "level 0" to "level 2" for most metrics, "ingredient: part" for "combined"."""
    if a.metric != b.metric or not (a.basis is b.basis or _same(a.basis, b.basis)):
        raise InputError(
            "these two descriptors have different metrics or histogram ranges: describe the second picture with "
            "like= the first one's descriptor"
        )
    if a.metric != "combined":
        return {part: apart for (_, part), apart in _compared(a, b, a.basis).items()}
    parts = _compared(a, b, a.basis)
    return {
        f"{name}: {part}": weight * parts[name, part] / a.floors[name, part]
        for name, weights in COMBINED.items()
        for part, weight in weights.items()
    }


def _raw_parts(a: Layers, b: Layers, like: Descriptor) -> dict[_Key, float]:
    return _compared(describe_layers(a, like), describe_layers(b, like), like.basis)


def _compared(a: Descriptor, b: Descriptor, basis: Mapping[str, Parts]) -> dict[_Key, float]:
    return {
        (name, part): float(INGREDIENTS[name].apart(statistic, b.features[name][part], basis[name].get(part)))
        for name, parts in a.features.items()
        for part, statistic in parts.items()
    }


def _same(a: Mapping[str, Parts], b: Mapping[str, Parts]) -> bool:
    """Whether two bases are equal in content: a descriptor may have been to another process and back."""
    return a.keys() == b.keys() and all(
        a[name].keys() == b[name].keys() and all(_equal(values, b[name][part]) for part, values in a[name].items()) for name in a
    )


def _equal(a: Array, b: Array) -> bool:
    return bool(np.array_equal(a, b))
