"""Whether the number of samples a pixel reaches the metric: the same details at 1 to 4 samples a side, and traced grain."""

from typing import Any

import numpy as np

from tests.benchmarks import texture_pictures as pictures
from tests.benchmarks.texture_families import AZIMUTH, ELEVATION, TRUTHS
from voldetail.backend import mitsuba
from voldetail.detail import Detail, with_values
from voldetail.metric import describe, distance
from voldetail.render.heightfield import HeightField
from voldetail.render.unit_components import components
from voldetail.setup.lamp import Lamp
from voldetail.setup.light import direction_of
from voldetail.setup.view import View

SUBSAMPLES = (1, 2, 3, 4)
PHOTOS = ("gravel", "grass")
METRICS = ("combined", "published")

TRACED = 4
"""Random samples a pixel of the picture with grain, of two lights (the sky and the lamp) as a path tracer draws them."""


def grain_check(photos: dict[str, pictures.Picture]) -> dict[str, Any]:
    """Distance from two photos of each detail, by the square root of samples a pixel, and with a tracer's grain.

    The grain is that of TRACED random positions a pixel, which is what a tracer adds where everything else is exact:
    pixels are means of as many of the 4 x 4 samples of a fine grid, drawn at random.
    """
    mitsuba()
    surface = HeightField(View(-1.0, 1.0, -1.0, 1.0, pictures.SIDE, pictures.SIDE))
    lamp = Lamp(direction=direction_of(AZIMUTH, ELEVATION))
    found: dict[str, Any] = {}
    for name, truth in TRUTHS.items():
        surface.update(with_values(Detail(seed=1), truth))
        shown = {str(n): _matt(surface, lamp, n) for n in SUBSAMPLES}
        shown["traced"] = _drawn(surface, lamp)
        for photo in PHOTOS:
            for metric in METRICS:
                asking = describe(pictures.crop(photos[photo], (0, 0)), metric=metric)
                found[f"{name} from {photo}, {metric}"] = {
                    samples: round(distance(asking, describe(p, like=asking)), 4) for samples, p in shown.items()
                }
    return found


def _matt(surface: HeightField, lamp: Lamp, subsamples: int) -> pictures.Picture:
    return components(surface, lamp, subsamples=subsamples).luminance(0.1, 0.5, 0.0, 0.0)


def _drawn(surface: HeightField, lamp: Lamp) -> pictures.Picture:
    """Pixels as means of a few of the 4 x 4 samples of a finer view."""
    side, rng = pictures.SIDE, np.random.default_rng(2)
    fine = HeightField(View(-1.0, 1.0, -1.0, 1.0, side, side))
    fine.raise_to(surface.z, surface.albedo)
    fine.view = View(-1.0, 1.0, -1.0, 1.0, 4 * side, 4 * side)
    samples = _matt(fine, lamp, 1).reshape(side, 4, side, 4).transpose(0, 2, 1, 3).reshape(side, side, 16)
    chosen = rng.integers(0, 16, (side, side, TRACED))
    return np.ascontiguousarray(np.take_along_axis(samples, chosen, axis=2).mean(axis=2), np.float32)
