"""Distances between textures."""

from __future__ import annotations

from voldetail import metric as metrics
from voldetail.errors import InputError
from voldetail.image import MaskLike, PhotoLike, load_masked, luminance
from voldetail.metric import METRICS, Descriptor


def describe(
    photo: PhotoLike, mask: MaskLike | None = None, *, metric: str = "combined", like: Descriptor | None = None
) -> Descriptor:
    """Return what a metric measures of a picture, for `distance`; the second of two is described ``like`` the first.

    photo, mask: as for `load_photo`. metric: "combined" (the default of fits), "published" (GD10's), or another of `compare
    --metric`. Raises InputError for a picture that is too small, and an unknown metric.
    """
    if metric not in METRICS:
        raise InputError(f"There is no metric {metric!r}; use one of {', '.join(METRICS)}.")
    loaded = load_masked(photo, mask)
    return metrics.describe(luminance(loaded.pixels), loaded.opaque, metric=metric, like=like)


def compare(first: PhotoLike, second: PhotoLike, *, metric: str = "combined") -> float:
    """Return the distance M of the second picture's texture from the first's: 0 for the same picture.

    >>> compare("skimage:gravel", "skimage:gravel")
    0.0
    >>> compare("skimage:gravel", "skimage:grass") > 1
    True

    Raises InputError as `describe` does.
    """
    reference = describe(first, metric=metric)
    return metrics.distance(reference, describe(second, metric=metric, like=reference))
