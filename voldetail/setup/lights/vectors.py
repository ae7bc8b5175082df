"""Directions and lengths of a light, and numbers in its text."""

from __future__ import annotations

import math

from voldetail.errors import InputError
from voldetail.records.refusal import shown

FURTHEST = 1000.0  # scene units, 500 proxies away: beyond it a length is a slip of the pen

Vector = tuple[float, float, float]


def direction_of(azimuth: float, elevation: float) -> Vector:
    """The unit vector of a light: (cos el cos az, cos el sin az, sin el), angles in degrees.

    The azimuth runs from +x counter-clockwise in the image plane, the elevation from there to the viewer.
    """
    az, el = math.radians(azimuth), math.radians(elevation)
    return math.cos(el) * math.cos(az), math.cos(el) * math.sin(az), math.sin(el)


def angles_of(direction: Vector) -> tuple[float, float]:
    """Azimuth in [0, 360) and elevation of a direction, in degrees: the inverse of `direction_of`."""
    x, y, z = direction
    return math.degrees(math.atan2(y, x)) % 360, math.degrees(math.atan2(z, math.hypot(x, y)))


def numbers_of(text: str, listed: str, counts: tuple[int, ...], forms: str) -> list[float]:
    """The numbers in ``listed``, a part of the light's ``text``: as many as one of ``counts``.

    Raises InputError, which names ``forms``, for what is no number, not finite, or too many or few.
    """
    try:
        numbers = [float(part) for part in listed.split(",")]
    except ValueError:
        raise InputError(f"The light {shown(text)} is not understood; use {forms}.") from None
    if not all(map(math.isfinite, numbers)):
        raise InputError(f"The light {shown(text)} holds a number that is not finite; use {forms}.")
    if len(numbers) not in counts:
        wanted = " or ".join(map(str, counts))
        raise InputError(f"The light {shown(text)} has {len(numbers)} numbers where {wanted} are wanted; use {forms}.")
    return numbers
