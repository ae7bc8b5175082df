"""The record of how well a photo tells the relief's amplitude."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class AmplitudeInterval:
    """Amplitudes in scene units whose pictures are nearly as near to the photo as the best one's.

    low, high: under the light given. low_any, high_any: also under one up to 10 degrees lower or higher (the same
    where a light has no elevation). Both hold the fitted amplitude. An end at that of ``amplitudes`` is open: nothing
    beyond was looked at.
    amplitudes, distances, distances_any: what was looked at, with the mean distance over seeds.
    """

    low: float
    high: float
    low_any: float
    high_any: float
    amplitudes: tuple[float, ...]
    distances: tuple[float, ...]
    distances_any: tuple[float, ...]

    @property
    def ends(self) -> dict[str, float]:
        """The four ends by name."""
        return {"low": self.low, "high": self.high, "low_any": self.low_any, "high_any": self.high_any}
