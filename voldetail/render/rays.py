"""The camera's rays through the samples of a View."""

from __future__ import annotations

from typing import Any

import drjit as dr

from voldetail.backend import mitsuba
from voldetail.setup.view import View


def rays_of(view: View, subsamples: int) -> Any:
    """Return the camera rays of a regular grid of ``subsamples`` squared samples a pixel, row by row."""
    mi = mitsuba()
    x, y = (mi.Float(v) for v in view.coordinates(subsamples))
    if not view.perspective:
        return mi.Ray3f(mi.Point3f(x, y, view.distance), mi.Vector3f(0.0, 0.0, -1.0))
    eye = mi.Point3f(0.0, 0.0, view.distance)
    return mi.Ray3f(eye, dr.normalize(mi.Point3f(x, y, 0.0) - eye))
