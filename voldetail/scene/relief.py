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
        noise.weights,
    )


def relief_at(detail: Detail, domain: tuple[Any, ...], scale: float = 1.0) -> Any:
    """Return R in [0, 1] at ``domain`` (3 coordinates, or 2 for the surface domain), as a float array.

    ``scale`` makes the detail's cells that many times larger. The value depends on the detail and the seed alone.
    """
    float_type: Any = type(domain[0])
    uint_type = dr.uint32_array_t(float_type)
    noise = detail.noise
    dims = 3 if noise.domain == SOLID else 2
    points = tuple(domain[:dims])

    def number(value: float) -> Any:
        # Opaque: these numbers change at every evaluation of a fit and must not become code.
        return dr.opaque(float_type, float(value))

    return relief_function(
        points, settings_of(detail), dr.opaque(uint_type, detail.seed & 0xFFFFFFFF),
        scale=number(noise.scale / scale), anisotropy=number(noise.anisotropy), angle=number(noise.angle),
        lacunarity=number(noise.lacunarity), stripe_frequency=number(noise.stripe_frequency),
        stripe_spread=number(noise.stripe_spread), curve=float_type(list(noise.curve)),
    )


def albedo_at(detail: Detail, domain: tuple[Any, ...], relief: Any, scale: float = 1.0) -> Any | None:
    """Return the factor (1 + g (2 R - 1)) (1 + v (2 u - 1)) on the albedo, or None where it is 1 everywhere.

    g goes with the height R, v with the grain's own number u in [0, 1).
    """
    float_type: Any = type(domain[0])
    noise, reflectance = detail.noise, detail.reflectance
    factor: Any = None
    if reflectance.height_albedo != 0.0:
        factor = 1.0 + dr.opaque(float_type, reflectance.height_albedo) * (2.0 * relief - 1.0)
    if reflectance.cell_albedo != 0.0:
        uint_type = dr.uint32_array_t(float_type)
        own = cell_value(
            tuple(domain[: 3 if noise.domain == SOLID else 2]), dr.opaque(uint_type, detail.seed & 0xFFFFFFFF),
            scale=dr.opaque(float_type, noise.scale / scale), anisotropy=dr.opaque(float_type, noise.anisotropy),
            angle=dr.opaque(float_type, noise.angle),
        )
        grain = 1.0 + dr.opaque(float_type, reflectance.cell_albedo) * (2.0 * own - 1.0)
        factor = grain if factor is None else factor * grain
    return factor
