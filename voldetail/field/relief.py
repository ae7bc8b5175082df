"""The relief function of a Detail at points of a surface, and the displacement by it (GD10 eq. 3 and section 6)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import drjit as dr
import numpy as np

from voldetail.backend import mitsuba
from voldetail.detail import Detail
from voldetail.detail.photo_relief import AnyDetail, MappedDetail
from voldetail.field.albedo import coloured
from voldetail.field.mapped import mapped_relief_and_albedo
from voldetail.noise import (
    OCTAVE_NUMBERS,
    NoiseSettings,
    PlateShape,
    StoneShape,
    cell_value,
    number_of,
    relief_function,
    specks,
)

SOLID = "solid"
QUANTILE_POINTS = 64
"""A side of the square over which heights are counted."""


def settings_of(detail: Detail) -> NoiseSettings:
    """Return what is discrete in the noise of ``detail``."""
    noise = detail.noise
    dims = 3 if noise.domain == SOLID else 2
    return NoiseSettings.from_ranks(
        dims,
        noise.first_neighbour,
        noise.last_neighbour,
        noise.octaves,
        noise.envelope == "gaussian",
        noise.weights,
        noise.joining == "highest",
        noise.has_plates,
    )


def relief_at(detail: Detail, domain: tuple[Any, ...], scale: float = 1.0) -> Any:
    """Return R in [0, 1] at ``domain`` (3 coordinates, or 2 for the surface domain), as a float array.

    ``scale`` makes the detail's cells that many times larger. The value depends on the detail and the seed alone.
    """
    return _relief(detail, domain, scale)[0]


def relief_quantiles(detail: Detail, side: float, shares: Sequence[float]) -> tuple[float, ...]:
    """Return the heights R below which the ``shares`` of a square of ``side`` scene units lie, of the plane z = 0."""
    float_type = mitsuba().Float
    axis = (np.arange(QUANTILE_POINTS, dtype=np.float32) + 0.5) / QUANTILE_POINTS * side
    x, y = np.meshgrid(axis, axis)
    points = float_type(x.ravel()), float_type(y.ravel()), dr.zeros(float_type, x.size)
    return tuple(float(v) for v in np.quantile(np.asarray(relief_at(detail, points)), shares))


def relief_and_albedo(
    detail: AnyDetail,
    domain: tuple[Any, ...],
    scale: float = 1.0,
    *,
    spacing: float = 0.0,
    normals: tuple[Any, ...] | None = None,
) -> tuple[Any, Any | None]:
    """Return `relief_at` and the factor on the albedo (field.albedo): None for 1, an array, or three for colour.

    ``spacing`` of the points in scene units, between which colour is averaged; ``normals`` of the bare shape in the domain.
    """
    if isinstance(detail, MappedDetail):
        return mapped_relief_and_albedo(detail, domain, scale, spacing=spacing, normals=normals)
    relief, owner = _relief(detail, domain, scale)
    float_type: Any = type(domain[0])
    reflectance, points, seed = detail.reflectance, _points(detail, domain), _seed(detail, float_type)
    patterns, number = [], None
    if reflectance.height_albedo != 0.0:
        patterns.append((reflectance.height_albedo, 2.0 * relief - 1.0))
    if reflectance.cell_albedo != 0.0 or (detail.colour is not None and detail.colour.driver == "cell"):
        number = cell_value(points, seed, **_cells(detail, float_type, scale)) if owner is None else number_of(owner, float_type)
        if reflectance.cell_albedo != 0.0:
            patterns.append((reflectance.cell_albedo, 2.0 * number - 1.0))
    if reflectance.speckle != 0.0:
        size = dr.opaque(float_type, reflectance.speckle_scale / scale)
        patterns.append((reflectance.speckle, specks(tuple(v * size for v in points), seed)))
    factor: Any = None
    for strength, pattern in patterns:
        one = 1.0 + dr.opaque(float_type, strength) * pattern
        factor = one if factor is None else factor * one
    if detail.colour is not None:
        factor = coloured(detail, factor, points, relief, number, scale=scale, spacing=spacing, normals=normals)
    return relief, factor


def _relief(detail: Detail, domain: tuple[Any, ...], scale: float) -> tuple[Any, Any | None]:
    """Return the relief and, where the highest counts, the stone on top."""
    float_type: Any = type(domain[0])
    noise = detail.noise
    shape = plates = None
    if noise.joining == "highest":
        shape = StoneShape.of(noise, lambda value: _opaque(float_type, value))
    if noise.has_plates:
        plates = PlateShape.of(noise, lambda value: _opaque(float_type, value))
    octaves = {name: _opaque(float_type, getattr(noise, name)) for name in OCTAVE_NUMBERS}
    return relief_function(
        _points(detail, domain),
        settings_of(detail),
        _seed(detail, float_type),
        **_cells(detail, float_type, scale),
        **octaves,
        curve=float_type(list(noise.curve)),
        shape=shape,
        plates=plates,
    )


def _points(detail: Detail, domain: tuple[Any, ...]) -> tuple[Any, ...]:
    return tuple(domain[: 3 if detail.noise.domain == SOLID else 2])


def _seed(detail: Detail, float_type: Any) -> Any:
    return dr.opaque(dr.uint32_array_t(float_type), detail.seed & 0xFFFFFFFF)


def _cells(detail: Detail, float_type: Any, scale: float) -> dict[str, Any]:
    noise = detail.noise
    numbers = {"scale": noise.scale / scale, "anisotropy": noise.anisotropy, "angle": noise.angle}
    return {name: _opaque(float_type, value) for name, value in numbers.items()}


def _opaque(float_type: Any, value: float) -> Any:
    # These numbers change at every evaluation of a fit and must not become code.
    return dr.opaque(float_type, float(value))
