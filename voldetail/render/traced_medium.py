"""A density grid as a participating medium in Mitsuba, for the final picture: all orders of scattering, path-traced.

The same grid, extinction and phase function as the marcher's: a `heterogeneous` medium inside the grid's box, which has
no surface of its own. The look-up between cells is the same as `lookup` has it.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from voldetail.backend import mitsuba
from voldetail.errors import InputError
from voldetail.field.medium import Medium, check
from voldetail.geometry.density_grid import DensityGrid
from voldetail.render.traced import emitters_of
from voldetail.setup.lamp import Lamp
from voldetail.setup.view import View

ALBEDO = 0.99
"""Single-scattering albedo unless given here or by the medium: 1 for a cloud of water, less so that long paths end."""

SCATTERINGS = 128
"""Times that light may scatter. Of what a white slab of optical thickness 10 reflects straight back (g = 0), all is there
at 128, 94 % at 64, 54 % at 8 and 15 % at 1, which is what the marcher sees of a
medium without an albedo; for g = 0.8 100, 98, 20 and 2 %."""

OPAQUE = 16.0
"""Largest optical thickness of a cell that is sampled. Collisions are drawn against the densest cell of the whole box
(one majorant), so that a needlessly high extinction costs time everywhere; what passes such a cell, 1e-7, is not seen."""


class TracedVolume:
    """A Mitsuba scene of one medium in a box with its lights, seen through a View.

    albedo: share of the light that scatters where it is stopped, 0 to 1; a colour of three of them is tinted; the medium's
    own unless given, or else ALBEDO. sky:
    radiance of the uniform sky, shown behind the medium if ``show_sky``. scatterings: the most for one path; 1 for what
    the marcher sees of a medium without an albedo. tint: colour of the lights; ``emitters`` of one's own take their place.
    """

    def __init__(
        self, grid: DensityGrid, medium: Medium, view: View, lamp: Lamp | None, *, sky: float = 0.0,
        albedo: float | tuple[float, float, float] | None = None, scatterings: int = SCATTERINGS, show_sky: bool = False,
        tint: tuple[float, ...] = (1.0, 1.0, 1.0), emitters: dict[str, Any] | None = None,
    ) -> None:  # fmt: skip
        check(grid)
        if albedo is None:
            albedo = ALBEDO if medium.albedo is None else medium.albedo
        colour = np.broadcast_to(np.asarray(albedo, dtype=float), (3,))
        if not np.all((colour >= 0.0) & (colour <= 1.0)):
            raise InputError(f"The medium's albedo is {albedo}, but has to be from 0 to 1: give 0.99 for a white cloud.")
        mi = mitsuba()
        self.view = view
        self.integrator = mi.load_dict(
            # A path has one edge more than it scatters, to the light. Russian roulette only past the brightest orders.
            {"type": "volpath", "max_depth": scatterings + 1, "rr_depth": 16, "hide_emitters": not show_sky}
        )
        self.scene = mi.load_dict(
            {"type": "scene", "box": box_of(grid, medium, colour.tolist()), **(emitters or _lights(lamp, sky, tint))}
        )


def box_of(grid: DensityGrid, medium: Medium, albedo: list[float]) -> dict[str, Any]:
    """Return the Mitsuba shape that holds the medium: the grid's box without a surface."""
    transform = mitsuba().ScalarTransform4f
    lower, upper = np.array(grid.lower), np.array(grid.upper)
    unit = transform().translate(lower.tolist()).scale((upper - lower).tolist())
    cube = transform().translate((0.5 * (lower + upper)).tolist()).scale((0.5 * (upper - lower)).tolist())
    density = {
        "type": "gridvolume",
        "grid": mitsuba().VolumeGrid(np.ascontiguousarray(grid.array()[..., None])),
        "raw": True,
        "filter_type": "trilinear",
        "wrap_mode": "clamp",
        "to_world": unit,
    }
    return {
        "type": "cube",
        "to_world": cube,
        "bsdf": {"type": "null"},
        "interior": {
            "type": "heterogeneous",
            "sigma_t": density,
            "scale": min(medium.extinction, OPAQUE / grid.edge),
            "albedo": {"type": "constvolume", "value": {"type": "rgb", "value": albedo}},
            "phase": {"type": "hg", "g": medium.asymmetry or 0.0},
        },
    }


def _lights(lamp: Lamp | None, sky: float, tint: tuple[float, ...]) -> dict[str, Any]:
    lights = emitters_of(lamp or Lamp(direction=(0.0, 0.0, 1.0), strength=0.0), sky, tint)
    if lamp is None:
        del lights["light"]
    # A sky that gives nothing would still take half of the light samples.
    if sky == 0.0 and lamp is not None:
        del lights["sky"]
    return lights
