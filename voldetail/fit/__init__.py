"""Fitting a detail to a photo."""

from voldetail.fit.fitter import FitResult, Progress, fit

__all__ = ["FitResult", "Progress", "fit"]
