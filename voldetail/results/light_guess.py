"""The record of a guessed light."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class LightGuess:
    """A guessed light: angles in degrees as on the command line.

    confidence: about the share of such photos in which the azimuth is within 30 degrees; sign_confidence: that in which
    the light is at this end of its axis, 0.5 for a coin. sentence: the same for people.
    """

    azimuth: float
    elevation: float
    confidence: float
    sign_confidence: float
    sentence: str
