"""Fitting a detail to a photo."""

from voldetail.fit.fitter import Progress, fit
from voldetail.results import FitResult

__all__ = ["FitResult", "Progress", "fit"]
