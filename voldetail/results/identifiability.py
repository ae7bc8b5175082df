"""The record of how well a photo tells one number of a medium."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Identifiability:
    """One number: its key and value, and between which values pictures are nearly as near to the photo as the best one's.

    least, most: of what was tried; an interval that ends there is open.
    """

    key: str
    value: float
    low: float
    high: float
    least: float
    most: float

    @property
    def unidentified(self) -> bool:
        """Whether the photo tells nothing of it: all that was tried is near."""
        return self.low <= self.least and self.high >= self.most
