"""What a path-traced picture needs besides the surface: sensor, integrator and lights, as Mitsuba has them."""

from __future__ import annotations

import math
from typing import Any

from voldetail.backend import mitsuba
from voldetail.setup.lamp import Lamp, rgb
from voldetail.setup.view import View

BOUNCES = 4
"""Longest path, in edges: light from the sky or lamp, and two reflections between parts of the relief."""


def sensor_of(view: View) -> Any:
    """Return the Mitsuba sensor that sees what ``view`` sees; its window is centred, as `whole_view` makes it."""
    mi = mitsuba()
    half_wide = (view.right - view.left) / 2
    film = {
        "type": "hdrfilm",
        "width": view.columns,
        "height": view.rows,
        "pixel_format": "rgba",
        "component_format": "float32",
        "rfilter": {"type": "box"},
    }
    placed = mi.ScalarTransform4f().look_at([0, 0, view.distance], [0, 0, 0], [0, 1, 0])
    if view.perspective:
        angle = math.degrees(2.0 * math.atan(half_wide / view.distance))
        return mi.load_dict({"type": "perspective", "fov": angle, "fov_axis": "x", "to_world": placed, "film": film})
    scaled = placed @ mi.ScalarTransform4f().scale([half_wide, half_wide, 1.0])
    return mi.load_dict({"type": "orthographic", "to_world": scaled, "film": film})


def path_integrator() -> Any:
    """Return the path tracer; lights are not themselves seen."""
    return mitsuba().load_dict({"type": "path", "max_depth": BOUNCES, "hide_emitters": True})


def emitters_of(lamp: Lamp, sky: float, tint: tuple[float, ...] = (1.0, 1.0, 1.0)) -> dict[str, Any]:
    """Return Mitsuba emitters for a lamp and a uniform sky of radiance ``sky``, both of the colour ``tint``."""
    return {"sky": {"type": "constant", "radiance": rgb(sky, tint)}, "light": lamp.emitter(tint)}
