"""The light of a scene, resolved: where it comes from at each point and how strong it is there."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter

from voldetail.errors import InputError
from voldetail.setup.light import FORMS_GIVEN
from voldetail.setup.setup import Light

FOOT_BLUR = 0.06
"""Blur, in photo widths, before the brightest point is taken as the flash's foot; tuned on the flash photographs of
../shared/data so that a single glint does not win."""


@dataclass(frozen=True)
class Lamp:
    """A distant light (``direction``) or a near one (``position``), in scene units.

    ``strength`` is the irradiance in units of pi at the origin's plane facing the light (distant) or at the foot of a
    near one: a white matt surface there has radiance ``strength``. at_camera: a flash, seen from where it shines; the
    view of each point is then the direction to the light. (A plane that faces a camera is drawn by perspective as by
    parallel rays, up to scale, but its highlight is not.)
    """

    direction: tuple[float, float, float] | None = None
    position: tuple[float, float, float] | None = None
    strength: float = 1.0
    at_camera: bool = False

    def at(self, point: Any) -> tuple[Any, Any, Any]:
        """Return (unit direction to the light, distance to it, irradiance / pi facing it) at Mitsuba points."""
        import drjit as dr

        float_type = type(point.x)
        vector_type = type(point)
        if self.position is None:
            assert self.direction is not None
            x, y, z = (dr.opaque(float_type, v) for v in self.direction)
            return vector_type(x, y, z), dr.full(float_type, 1e9), dr.opaque(float_type, self.strength)
        lamp = vector_type(*(dr.opaque(float_type, v) for v in self.position))
        offset = lamp - point
        squared = dr.squared_norm(offset)
        distance = dr.sqrt(squared)
        strength = dr.opaque(float_type, self.strength * self.position[2] ** 2)
        return offset / distance, distance, strength / squared

    def on_plane(self, x: NDArray[np.float32], y: NDArray[np.float32]) -> NDArray[np.float32]:
        """Return what a white matt plane z = 0 facing the viewer reflects at (x, y): E n . l over pi."""
        if self.position is None:
            assert self.direction is not None
            return np.full(x.shape, self.strength * self.direction[2], dtype=np.float32)
        px, py, pz = self.position
        squared = (x - px) ** 2 + (y - py) ** 2 + pz**2
        return np.asarray(self.strength * pz**3 / squared**1.5, dtype=np.float32)

    @property
    def elevation(self) -> float:
        """Elevation above the image plane at the origin, in radians."""
        x, y, z = self.direction or self.position or (0.0, 0.0, 1.0)
        return math.atan2(z, math.hypot(x, y))


def lamp_of(light: Light, luminance: NDArray[np.float32] | None = None) -> Lamp:
    """Return the Lamp for a Light of a Setup; a flash without a foot is over the brightest part of ``luminance``.

    Raises InputError for the light "auto", which only a fit can make a direction of.
    """
    if light.kind == "directional":
        return Lamp(direction=light.direction, strength=light.strength)
    if light.kind == "point":
        return Lamp(position=light.position, strength=light.strength)
    if light.kind == "auto":
        raise InputError(f"The light auto is estimated from a photo, by fit alone: give it as {FORMS_GIVEN}.")
    u, v = light.foot or (flash_foot(luminance) if luminance is not None else (0.5, 0.5))
    rows, columns = luminance.shape if luminance is not None else (1, 1)
    unit = 2.0 / max(rows, columns)
    return Lamp(
        position=((u - 0.5) * columns * unit, (0.5 - v) * rows * unit, 2.0 * light.height), strength=light.strength,
        at_camera=True,
    )


def flash_foot(luminance: NDArray[np.float32]) -> tuple[float, float]:
    """Return where a flash photo is brightest, as fractions (u, v) from the left and the top."""
    rows, columns = luminance.shape
    # Full resolution is not needed for a wide blur.
    step = max(1, max(rows, columns) // 256)
    small = luminance[::step, ::step]
    blurred = gaussian_filter(small.astype(np.float64), FOOT_BLUR * max(small.shape), mode="constant")
    weight = gaussian_filter(np.ones_like(small, dtype=np.float64), FOOT_BLUR * max(small.shape), mode="constant")
    row, column = np.unravel_index(np.argmax(blurred / weight), small.shape)
    return (float(column) + 0.5) / small.shape[1], (float(row) + 0.5) / small.shape[0]
