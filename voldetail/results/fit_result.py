"""The record of a fit: what it found, and how."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from voldetail.detail import Detail
from voldetail.image import luminance
from voldetail.results.colour import ColourChoice
from voldetail.results.identifiability import Identifiability
from voldetail.results.interval import AmplitudeInterval
from voldetail.results.light_guess import LightGuess
from voldetail.results.target import Target
from voldetail.setup.setup import Setup


@dataclass(frozen=True)
class FitResult:
    """What a fit ended with. status says in a sentence why it ended; trace is (evaluations, best distance) as it fell.

    setup: the one that was fitted, with the direction found where its light was "auto", and then light_guess.
    heights: the amplitudes that fit about as well; None where the user gave the amplitude or stopped the fit.
    colour: what was chosen for the colour, and how far each try was from the photo.
    identifiability: for a medium, how well the photo tells each of its numbers; empty for other details, and where
    the fit was stopped.
    picture (H, W): its luminance. covered (H, W): the share of each pixel that is filled; background: what shows through.
    """

    detail: Detail
    setup: Setup
    target: Target
    picture: NDArray[np.float32]
    covered: NDArray[np.float32]
    background: tuple[float, float, float]
    distance: float
    evaluations: int
    seconds: float
    status: str
    trace: tuple[tuple[int, float], ...]
    interrupted: bool
    light_guess: LightGuess | None = None
    heights: AmplitudeInterval | None = None
    identifiability: tuple[Identifiability, ...] = ()
    colour: ColourChoice | None = None

    @property
    def coloured(self) -> NDArray[np.float32]:
        """The picture (H, W, 3) in the photo's colours."""
        if self.colour is not None and self.detail.colour is not None and self.detail.mode == "displacement":
            return self.colour.picture
        behind = np.asarray(self.background, dtype=np.float32)
        through = (1.0 - self.covered)[..., None] * behind
        matt = np.maximum(self.picture - luminance(through), 0.0)[..., None]
        return np.asarray(matt * np.asarray(self.detail.reflectance.tint, dtype=np.float32) + through, dtype=np.float32)
