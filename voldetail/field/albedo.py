"""What colours a surface whatever its shape: patterns of albedo in grey, and the colour of a detail on top.

    f = (1 + g (2 R - 1)) (1 + v (2 u - 1)) (1 + k t) c

g goes with the height R, v with the grain's own number u in [0, 1), k with specks t in (-1, 1); c: the detail's colour.
A factor is None for 1, one array of points, or three for red, green and blue.
"""

from __future__ import annotations

from typing import Any

import drjit as dr

from voldetail.detail import Detail
from voldetail.detail.photo_relief import AnyDetail, MappedDetail
from voldetail.texture import CURVE_PROBABILITIES, colour_at

Factor = Any

LEAST_ALBEDO = 1e-4
"""Kd times tint below which no factor on it can make an albedo over 1 that is seen."""


def patterned(detail: AnyDetail) -> bool:
    """Return whether the albedo of ``detail`` varies."""
    if isinstance(detail, MappedDetail):
        return True
    r = detail.reflectance
    return detail.colour is not None or any((r.height_albedo, r.cell_albedo, r.speckle))


def coloured(
    detail: Detail,
    factor: Factor,
    points: tuple[Any, ...],
    relief: Any,
    number: Any | None,
    *,
    scale: float,
    spacing: float,
    normals: tuple[Any, ...] | None,
) -> Factor:
    """Return ``factor`` times the colour of ``detail`` at ``points``: three arrays, so that no albedo is over 1.

    relief, number: R there, and the cell's own number where it drives. spacing: between points, in scene units: what is
    finer is averaged. normals: of the bare shape, for textures that have no solid form of their own.
    """
    colour = detail.colour
    assert colour is not None
    float_type: Any = type(points[0])
    first = None
    if colour.driver == "cell":
        first = number
    elif colour.driver != "noise":
        first = share_below(relief, colour.heights, float_type)
        first = 1.0 - first if colour.driver == "hollow" else first
    texels = dr.opaque(float_type, colour.texels_per_unit / scale)
    found = colour_at(
        colour.source,
        tuple(v * texels for v in points),
        footprint=colour.texels_per_unit / scale * spacing,
        first=first,
        normals=normals,
    )
    out = []
    for value, gain, tint in zip(found, colour.gain, detail.reflectance.tint, strict=True):
        own = value * dr.opaque(float_type, gain)
        own = own if factor is None else own * factor
        albedo = detail.reflectance.diffuse * tint
        out.append(dr.minimum(own, dr.opaque(float_type, 1.0 / max(albedo, LEAST_ALBEDO))))
    return tuple(out)


def share_below(relief: Any, heights: tuple[float, ...], float_type: Any) -> Any:
    """Return the share of the surface that is lower than ``relief``, in (0, 1), between the quantiles ``heights``."""
    share: Any = float_type(CURVE_PROBABILITIES[0])
    steps = zip(heights, heights[1:], CURVE_PROBABILITIES, CURVE_PROBABILITIES[1:], strict=False)
    for low, high, least, most in steps:
        step = dr.clip((relief - dr.opaque(float_type, low)) * dr.opaque(float_type, 1.0 / max(high - low, 1e-6)), 0.0, 1.0)
        share = share + step * dr.opaque(float_type, most - least)
    return share


def factors_of(albedo: Factor) -> tuple[Any, ...]:
    """Return the arrays of a factor: none, one or three."""
    if albedo is None:
        return ()
    return albedo if isinstance(albedo, tuple) else (albedo,)


def factor_of(arrays: list[Any]) -> Any:
    """Return the factor of those arrays; 1 for none."""
    if not arrays:
        return 1.0
    return arrays[0] if len(arrays) == 1 else tuple(arrays)


def diffuse_of(detail: AnyDetail, albedo: Factor) -> tuple[Any, ...]:
    """Return the diffuse albedo Kd tint f in [0, 1] of each point, in three arrays."""
    r = detail.reflectance
    own = factors_of(albedo)
    own = own * 3 if len(own) == 1 else own
    return tuple(dr.clip(f * dr.opaque(type(f), r.diffuse * c), 0.0, 1.0) for f, c in zip(own, r.tint, strict=True))
