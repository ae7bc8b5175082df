"""The colour of a fitted detail: learnt from the photo once its relief is found, its kind chosen by the metric.

Albedo is taken apart from the relief's shading (fit.albedo) and made a procedural texture (LVLD10). Its most varied channel
may go with noise of its own ("by-example"), with the relief's height, one way or the other ("height"), or by the cell
("cell"). "auto" is whichever is nearest to the photo on seeds that nothing was fitted to, or no colour ("none").
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from voldetail.detail import Detail, DetailColour, Reflectance
from voldetail.errors import InputError
from voldetail.field.relief import relief_quantiles
from voldetail.fit.albedo import albedo_apart
from voldetail.fit.objective import COVERED, Objective
from voldetail.image import to_linear, to_srgb
from voldetail.metric import Descriptor, describe, distance
from voldetail.render.unit_components import components
from voldetail.render.volume import Volume
from voldetail.results.colour import ColourChoice
from voldetail.texture import CURVE_PROBABILITIES, analyse, picture

DRIVERS: dict[str, tuple[str, ...]] = {
    "none": (),
    "by-example": ("noise",),
    "height": ("height", "hollow"),
    "cell": ("cell",),
    "auto": ("noise", "height", "hollow", "cell"),
}
"""What may move the most varied channel, by the choice of the user."""

NAMES = {"noise": "by-example", "height": "height", "hollow": "height", "cell": "cell"}

PENALTIES = {"height": 1.06, "hollow": 1.06, "cell": 1.06}
"""Factors on the distances by which a colour that goes with the relief has to pay for itself. Without them it won by a few
percent on most photographs, and was further from those under other lights than colour by example was (tuned on two of the
captures of one surface under several lights)."""

GREY = 0.03
"""Share of the most varied channel's deviation below which another tells nothing: the noise of a compressed grey photo."""

MEAN_SIDE = 256
"""Texels a side of the texture whose mean is divided by."""


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
        found: list[Descriptor] = [describe(c, used, like=own) for c, own in zip(self._channels(pixels), self._own, strict=True)]
        parts = [distance(own, other) for own, other in zip(self._own, found, strict=True)]
        return float(np.dot(self._weights, parts))


def choose_colour(
    objective: Objective,
    detail: Detail,
    colour: str,
    seeds: Sequence[int],
    shading_seeds: Sequence[int],
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
    if colour == "auto" and is_grey(target.pixels, target.mask):
        drivers = ()  # what brightness alone tells, the relief and its patterns of albedo were searched for
    plain = np.zeros((*target.mask.shape, 3), np.float32) if volume else _colours(objective, detail)[0]
    if not drivers:
        return ColourChoice(detail, "none", {}, plain)
    evaluations = [objective.evaluate(detail, seed) for seed in shading_seeds]
    seen = np.logical_and.reduce([target.mask, *(e.mask for e in evaluations)])
    if not seen.any():
        return ColourChoice(detail, "none", {}, plain)
    learnt = _learnt(objective, [e.picture for e in evaluations], seen, detail.seed, name)
    tries = {driver: _driven(objective, detail, driver, learnt) for driver in drivers}
    if volume or len(drivers) == 1:
        driver, coloured_detail = next(iter(tries.items()))
        return ColourChoice(coloured_detail, NAMES[driver], {}, plain if volume else _colours(objective, coloured_detail)[0])
    if colour == "auto":
        tries = {"none": detail, **tries}
    try:
        judge = ColourDistance(target.pixels, target.mask, target.descriptor.metric)
        distances = {driver: _far(objective, coloured_detail, judge, seeds) for driver, coloured_detail in tries.items()}
    except InputError:  # too little is seen of it to be compared
        return ColourChoice(detail, "none", {}, plain)
    best = min(distances, key=lambda driver: distances[driver] * PENALTIES.get(driver, 1.0))
    return ColourChoice(tries[best], NAMES.get(best, "none"), distances, _colours(objective, tries[best])[0])


def is_grey(pixels: NDArray[np.float32], mask: NDArray[np.bool_]) -> bool:
    """Return whether a photo (H, W, 3) has one channel that varies, but for what compression adds."""
    deviations = np.sqrt(np.maximum(np.linalg.eigvalsh(np.cov(to_srgb(pixels)[mask].astype(np.float64).T)), 0.0))
    return bool(deviations[1] <= GREY * deviations[2])


def _far(objective: Objective, detail: Detail, judge: ColourDistance, seeds: Sequence[int]) -> float:
    found = []
    for seed in seeds:
        colours, covered = _colours(objective, detail.model_copy(update={"seed": seed}))
        found.append(judge(colours, objective.target.mask & covered))
    return float(np.mean(found))


def _learnt(
    objective: Objective, shadings: Sequence[NDArray[np.float32]], seen: NDArray[np.bool_], seed: int, name: str
) -> DetailColour:
    """Return the colour that the photo has by example, once the ``shadings`` are taken out of it."""
    albedo = albedo_apart(objective.target.pixels, seen, shadings)
    texture = analyse(albedo, mask=seen, seed=seed, name=name)
    r, g, b = (1.0 / max(float(v), 1e-4) for v in picture(texture, (MEAN_SIDE, MEAN_SIDE)).reshape(-1, 3).mean(axis=0))
    return DetailColour(texels_per_unit=1.0 / objective.surface.view.pixel, gain=(r, g, b), texture=texture)


def _driven(objective: Objective, detail: Detail, driver: str, learnt: DetailColour) -> Detail:
    """Return ``detail`` with the ``learnt`` colour moved by ``driver``."""
    heights: tuple[float, ...] = ()
    if driver in ("height", "hollow"):
        side = objective.surface.view.pixel * max(objective.target.mask.shape)
        heights = relief_quantiles(detail, side, tuple(CURVE_PROBABILITIES.tolist()))
    colour = learnt.model_copy(update={"driver": driver, "heights": heights})
    return detail.model_copy(update={"colour": colour})


def _colours(objective: Objective, detail: Detail) -> tuple[NDArray[np.float32], NDArray[np.bool_]]:
    """Return the picture (H, W, 3) of ``detail`` under the photo's light, clipped where that burns out, and where it is whole."""
    reflectance: Reflectance = detail.reflectance
    objective.surface.update(detail)
    parts = components(
        objective.surface, objective.target.lamp, subsamples=objective.subsamples, shininess=(reflectance.shininess,)
    )
    return np.minimum(parts.colour(reflectance), objective.target.white), parts.covered > COVERED
