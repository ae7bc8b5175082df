"""The light of a scene, resolved: where it comes from at each point and how strong it is there."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

BEAM = 0.75
"""Share of a cone's half opening within which it is at full strength (Mitsuba's default for `spot`)."""


@dataclass(frozen=True)
class Lamp:
    """A distant light (``direction``) or a near one (``position``), in scene units.

    ``strength`` is the irradiance in units of pi at the origin's plane facing the light (distant) or at the foot of a
    near one: a white matt surface there has radiance ``strength``. at_camera: a flash, seen from where it shines; the
    view of each point is then the direction to the light. (A plane that faces a camera is drawn by perspective as by
    parallel rays, up to scale, but its highlight is not.) axis, cone: of a near one that shines into a cone, the unit vector
    along its middle and half its opening in radians.
    """

    direction: tuple[float, float, float] | None = None
    position: tuple[float, float, float] | None = None
    strength: float = 1.0
    at_camera: bool = False
    axis: tuple[float, float, float] | None = None
    cone: float = math.pi

    @property
    def near(self) -> bool:
        """Whether it stands at a place, and its strength varies."""
        return self.position is not None

    @property
    def source(self) -> tuple[float, float, float]:
        """Where it stands, or the direction to it."""
        return self.position or self.direction or (0.0, 0.0, 1.0)

    @property
    def elevation(self) -> float:
        """Elevation above the image plane at the origin, in radians."""
        x, y, z = self.source
        return math.atan2(z, math.hypot(x, y))

    def scaled(self, factor: float) -> Lamp:
        """Return it ``factor`` times as strong."""
        return replace(self, strength=self.strength * factor)

    def at(self, point: Any) -> tuple[Any, Any, Any]:
        """Return (unit direction to the light, distance to it, irradiance / pi facing it) at Mitsuba points."""
        import drjit as dr

        float_type = type(point.x)
        vector_type = type(point)
        if self.position is None:
            x, y, z = (dr.opaque(float_type, v) for v in self.source)
            return vector_type(x, y, z), dr.full(float_type, 1e9), dr.opaque(float_type, self.strength)
        lamp = vector_type(*(dr.opaque(float_type, v) for v in self.position))
        offset = lamp - point
        squared = dr.squared_norm(offset)
        distance = dr.sqrt(squared)
        direction = offset / distance
        strength = dr.opaque(float_type, self.strength * self.position[2] ** 2) / squared
        if self.axis is not None:
            along = vector_type(*(dr.opaque(float_type, -v) for v in self.axis))
            angle = dr.safe_acos(dr.dot(direction, along))
            edge, inverse = dr.opaque(float_type, self.cone), dr.opaque(float_type, 1.0 / ((1.0 - BEAM) * self.cone))
            strength = strength * dr.clip((edge - angle) * inverse, 0.0, 1.0)
        return direction, distance, strength

    def on_plane(self, x: NDArray[np.float32], y: NDArray[np.float32]) -> NDArray[np.float32]:
        """Return what a white matt plane z = 0 facing the viewer reflects at (x, y): E n . l over pi."""
        if self.position is None:
            return np.full(x.shape, self.strength * self.source[2], dtype=np.float32)
        px, py, pz = self.position
        squared = (x - px) ** 2 + (y - py) ** 2 + pz**2
        falloff = self.strength * pz**3 / squared**1.5
        if self.axis is not None:
            ax, ay, az = self.axis
            cosine = ((x - px) * ax + (y - py) * ay - pz * az) / np.sqrt(squared)
            angle = np.arccos(np.clip(cosine, -1.0, 1.0))
            falloff = falloff * np.clip((self.cone - angle) / ((1.0 - BEAM) * self.cone), 0.0, 1.0)
        return np.asarray(falloff, dtype=np.float32)

    def emitter(self, tint: tuple[float, ...]) -> dict[str, Any]:
        """Return Mitsuba's dictionary for it, of the colour ``tint``."""
        if self.position is None:
            return {
                "type": "directional", "direction": [-v for v in self.source],
                "irradiance": rgb(math.pi * self.strength, tint),
            }  # fmt: skip
        intensity = rgb(math.pi * self.strength * self.position[2] ** 2, tint)
        if self.axis is None:
            return {"type": "point", "position": list(self.position), "intensity": intensity}
        half = math.degrees(self.cone)
        return {
            "type": "spot", "to_world": _aimed(self.position, self.axis), "intensity": intensity, "cutoff_angle": half,
            "beam_width": BEAM * half,
        }  # fmt: skip


def rgb(value: float, tint: tuple[float, ...]) -> dict[str, Any]:
    """Return Mitsuba's dictionary for a light or colour of ``value`` in each channel of ``tint``."""
    return {"type": "rgb", "value": [value * c for c in tint]}


def _aimed(position: tuple[float, float, float], axis: tuple[float, float, float]) -> Any:
    """Return the transform of an emitter at ``position`` that looks along ``axis``."""
    from voldetail.backend import mitsuba

    upright = [0.0, 1.0, 0.0] if abs(axis[1]) < 0.9 else [1.0, 0.0, 0.0]
    target = [p + a for p, a in zip(position, axis, strict=True)]
    return mitsuba().ScalarTransform4f().look_at(list(position), target, upright)
