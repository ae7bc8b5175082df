"""Records of what a fit ends with: below the fit, which fills them, and the report, which reads them."""

from voldetail.results.colour import ColourChoice
from voldetail.results.fit_result import FitResult
from voldetail.results.gallery import Gallery
from voldetail.results.identifiability import Identifiability
from voldetail.results.interval import AmplitudeInterval
from voldetail.results.light_guess import LightGuess
from voldetail.results.target import EVEN_ENOUGH, Target

__all__ = [
    "EVEN_ENOUGH", "AmplitudeInterval", "ColourChoice", "FitResult", "Gallery", "Identifiability", "LightGuess", "Target",
]  # fmt: skip
