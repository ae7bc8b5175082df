"""The relief function of a Detail at points of a surface, and the displacement by it (GD10 eq. 3 and section 6)."""

from __future__ import annotations

from typing import Any

import drjit as dr

from voldetail.detail import Detail
from voldetail.noise import NoiseSettings, cell_value, relief_function

SOLID = "solid"


def settings_of(detail: Detail) -> NoiseSettings:
    """Return what is discrete in the noise of ``detail``."""
    noise = detail.noise
    dims = 3 if noise.domain == SOLID else 2
    return NoiseSettings.from_ranks(
        dims, noise.first_neighbour, noise.last_neighbour, noise.octaves, noise.envelope == "gaussian",
        noise.weights, noise.joining == "highest",
    )


def relief_at(detail: Detail, domain: tuple[Any, ...], scale: float = 1.0) -> Any:
    """Return R in [0, 1] at ``domain`` (3 coordinates, or 2 for the surface domain), as a float array.

    ``scale`` makes the detail's cells that many times larger. The value depends on the detail and the seed alone.
    """
    float_type: Any = type(domain[0])
    uint_type = dr.uint32_array_t(float_type)
    noise = detail.noise
    stripes = _opaque(
        float_type, lacunarity=noise.lacunarity, stripe_frequency=noise.stripe_frequency, stripe_spread=noise.stripe_spread
    )
    return relief_function(
        _points(detail, domain), settings_of(detail), dr.opaque(uint_type, detail.seed & 0xFFFFFFFF),
        **_cells(detail, float_type, scale), **stripes, curve=float_type(list(noise.curve)),
    )


def _points(detail: Detail, domain: tuple[Any, ...]) -> tuple[Any, ...]:
    return tuple(domain[: 3 if detail.noise.domain == SOLID else 2])


def _cells(detail: Detail, float_type: Any, scale: float) -> dict[str, Any]:
    """Return the numbers that say where the cells are and what shape grains have."""
    noise = detail.noise
    shape = {"facets": noise.facets, "elongation": noise.elongation, "size_spread": noise.size_spread}
    return _opaque(
        float_type, scale=noise.scale / scale, anisotropy=noise.anisotropy, angle=noise.angle,
        **(shape if noise.joining == "highest" else {}),
    )


def _opaque(float_type: Any, **numbers: float) -> dict[str, Any]:
    # These numbers change at every evaluation of a fit and must not become code.
    return {name: dr.opaque(float_type, float(value)) for name, value in numbers.items()}


def albedo_at(detail: Detail, domain: tuple[Any, ...], relief: Any, scale: float = 1.0) -> Any | None:
    """Return the factor (1 + g (2 R - 1)) (1 + v (2 u - 1)) on the albedo, or None where it is 1 everywhere.

    g goes with the height R, v with the grain's own number u in [0, 1).
    """
    float_type: Any = type(domain[0])
    reflectance = detail.reflectance
    factor: Any = None
    if reflectance.height_albedo != 0.0:
        factor = 1.0 + dr.opaque(float_type, reflectance.height_albedo) * (2.0 * relief - 1.0)
    if reflectance.cell_albedo != 0.0:
        uint_type = dr.uint32_array_t(float_type)
        own = cell_value(
            _points(detail, domain), settings_of(detail), dr.opaque(uint_type, detail.seed & 0xFFFFFFFF),
            **_cells(detail, float_type, scale),
        )
        grain = 1.0 + dr.opaque(float_type, reflectance.cell_albedo) * (2.0 * own - 1.0)
        factor = grain if factor is None else factor * grain
    return factor
