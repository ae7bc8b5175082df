"""The colour of a fitted detail: learnt from the photo once its relief is found, its kind chosen by the metric.

Albedo is taken apart from the relief's shading (fit.albedo) and made a procedural texture (LVLD10). Its most varied channel
may go with noise of its own ("by-example"), with the relief's height, one way or the other ("height"), or by the cell
("cell"). "auto" is whichever is nearest to the photo on seeds that nothing was fitted to, or no colour ("none").
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from voldetail.detail import Detail, DetailColour, Reflectance
from voldetail.errors import InputError
from voldetail.fit.albedo import albedo_apart
from voldetail.fit.objective import Objective
from voldetail.image import to_linear, to_srgb
from voldetail.metric import Descriptor, describe, distance
from voldetail.render import components
from voldetail.scene.relief import relief_quantiles
from voldetail.scene.volume import Volume
from voldetail.texture import CURVE_PROBABILITIES, analyse, picture

DRIVERS: dict[str, tuple[str, ...]] = {
    "none": (), "by-example": ("noise",), "height": ("height", "hollow"), "cell": ("cell",),
    "auto": ("noise", "height", "hollow", "cell"),
}
"""What may move the most varied channel, by the choice of the user."""

NAMES = {"noise": "by-example", "height": "height", "hollow": "height", "cell": "cell"}

GREY = 0.03
"""Share of the most varied channel's deviation below which another tells nothing: the noise of a compressed grey photo."""

MEAN_SIDE = 256
"""Texels a side of the texture whose mean is divided by."""


@dataclass(frozen=True)
class ColourChoice:
    """The colour of a detail: what was chosen, how far each try was from the photo, and the picture (H, W, 3)."""

    detail: Detail
    chosen: str
    distances: dict[str, float]
    picture: NDArray[np.float32]


class ColourDistance:
    """How unlike the colours of two pictures are, channel by channel of the photo's own decorrelated colours.

    The mean of the metric over the channels of the photo's sRGB colours, decorrelated (LVLD10 section 6), weighted by
    their deviations. Raises InputError as `metric.describe` does.
    """

    def __init__(self, pixels: NDArray[np.float32], mask: NDArray[np.bool_], metric: str) -> None:
        encoded = to_srgb(pixels)[mask].astype(np.float64)
        self._mean = encoded.mean(axis=0)
        variances, axes = np.linalg.eigh(np.cov((encoded - self._mean).T))
        deviations = np.sqrt(np.maximum(variances, 0.0))
        used = deviations >= GREY * deviations.max()
        self._axes, self._weights = axes[:, used], deviations[used] / deviations[used].sum()
        self._mask = mask
        self._own = [describe(c, mask, metric=metric) for c in self._channels(pixels)]

    def _channels(self, pixels: NDArray[np.float32]) -> list[NDArray[np.float32]]:
        apart = (to_srgb(pixels) - self._mean) @ self._axes + 0.5
        # The metric encodes what it is given.
        return [np.ascontiguousarray(to_linear(np.clip(c, 0.0, 1.0))) for c in np.moveaxis(apart, -1, 0)]

    def __call__(self, pixels: NDArray[np.float32], mask: NDArray[np.bool_] | None = None) -> float:
        """Return the distance of a picture (H, W, 3), of which ``mask`` may be compared."""
        used = self._mask if mask is None else mask
        found: list[Descriptor] = [
            describe(c, used, like=own) for c, own in zip(self._channels(pixels), self._own, strict=True)
        ]
        parts = [distance(own, other) for own, other in zip(self._own, found, strict=True)]
        return float(np.dot(self._weights, parts))


def choose_colour(
    objective: Objective, detail: Detail, colour: str, seeds: Sequence[int], shading_seeds: Sequence[int],
    name: str = "texture",
) -> ColourChoice:
    """Return ``detail`` with the colour that was asked for, the nearest to the photo where there are several.

    ``seeds`` judge; ``shading_seeds`` make the relief's shading that is taken from the photo. A volume's grid knows of
    density alone: there only "by-example" is made, unseen, and "auto" is none.
    """
    target = objective.target
    volume = isinstance(objective.surface, Volume)
    drivers = DRIVERS[colour]
    if volume:
        drivers = ("noise",) if drivers == ("noise",) and detail.medium is None else ()
    plain = _colours(objective, detail) if not volume else np.zeros((*target.mask.shape, 3), np.float32)
    if not drivers:
        return ColourChoice(detail, "none", {}, plain)
    shadings = [objective.evaluate(detail, seed).picture for seed in shading_seeds]
    tries = {driver: _driven(objective, detail, driver, shadings, name) for driver in drivers}
    if volume or len(drivers) == 1:
        driver, made = next(iter(tries.items()))
        return ColourChoice(made, NAMES[driver], {}, plain if volume else _colours(objective, made))
    if colour == "auto":
        tries = {"none": detail, **tries}
    try:
        judge = ColourDistance(target.pixels, target.mask, target.descriptor.metric)
    except InputError:
        return ColourChoice(detail, "none", {}, plain)
    found = {driver: _far(objective, made, judge, seeds) for driver, made in tries.items()}
    best = min(found, key=lambda driver: found[driver])
    return ColourChoice(tries[best], NAMES.get(best, "none"), found, _colours(objective, tries[best]))


def _far(objective: Objective, detail: Detail, judge: ColourDistance, seeds: Sequence[int]) -> float:
    pictures = (_colours(objective, detail.model_copy(update={"seed": seed})) for seed in seeds)
    return float(np.mean([judge(p) for p in pictures]))


def _driven(
    objective: Objective, detail: Detail, driver: str, shadings: Sequence[NDArray[np.float32]], name: str
) -> Detail:
    """Return ``detail`` with the photo's colour moved by ``driver``."""
    target = objective.target
    albedo = albedo_apart(target.pixels, target.mask, shadings)
    texture = analyse(albedo, mask=target.mask, seed=detail.seed, name=name)
    mean = picture(texture, (MEAN_SIDE, MEAN_SIDE)).reshape(-1, 3).mean(axis=0)
    gain = tuple(float(1.0 / max(v, 1e-4)) for v in mean)
    heights: tuple[float, ...] = ()
    if driver in ("height", "hollow"):
        side = objective.surface.view.pixel * max(target.mask.shape)
        heights = relief_quantiles(detail, side, tuple(CURVE_PROBABILITIES.tolist()))
    colour = DetailColour(
        driver=driver, texels_per_unit=1.0 / objective.surface.view.pixel, gain=gain, heights=heights, texture=texture,  # type: ignore[arg-type]
    )
    return detail.model_copy(update={"colour": colour})


def _colours(objective: Objective, detail: Detail) -> NDArray[np.float32]:
    """Return the picture (H, W, 3) of ``detail`` under the photo's light, clipped where the photo burns out."""
    reflectance: Reflectance = detail.reflectance
    objective.surface.update(detail)
    parts = components(
        objective.surface, objective.target.lamp, subsamples=objective.subsamples, shininess=(reflectance.shininess,)
    )
    return np.minimum(parts.colour(reflectance), objective.target.white)
