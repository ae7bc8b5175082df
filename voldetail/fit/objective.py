"""One evaluation: displace, look, solve the reflectance, compare."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from voldetail.detail import Detail
from voldetail.errors import InputError
from voldetail.fit.reflectance import solve
from voldetail.image import resize, resize_mask
from voldetail.metric import Descriptor, describe, distance
from voldetail.render.heightfield import HeightField
from voldetail.render.mesh_surface import MeshSurface
from voldetail.render.unit_components import SHININESS, Components, components
from voldetail.render.volume import Volume
from voldetail.results import Target

UNUSABLE = 1e3
"""Distance of a picture that cannot be compared (the surface left the mask): far, but a number for the search."""

COVERED = 0.999
"""Share of a pixel that has to be surface for it to count: all of it, but for rounding."""


@dataclass(frozen=True)
class Evaluation:
    """A detail with its solved reflectance, its distance from the photo and its picture (linear luminance).

    score: what a search should lower, see `Objective`. covered (H, W): share of a pixel that is filled. background:
    luminance of what shows through a medium.
    """

    detail: Detail
    distance: float
    score: float
    picture: NDArray[np.float32]
    mask: NDArray[np.bool_]
    covered: NDArray[np.float32]
    background: float = 0.0


class Objective:
    """Compares details with a Target on one surface; counts its evaluations.

    With ``reduced``, the same target at fewer pixels, the score is the mean of the distances at both sizes. The finest
    pixels of a photo hold what no rendering has, a lens, a sensor and a compression, and all families of noise are
    about as far from that; at half the size, stones are nearer to stones than anything else is. Without it, the score is
    the distance.
    """

    def __init__(
        self,
        target: Target,
        surface: HeightField | MeshSurface | Volume,
        *,
        specular: bool,
        subsamples: int = 2,
        reduced: Target | None = None,
    ) -> None:
        self.target, self.surface = target, surface
        # A volume's edges are as soft as a cell: more samples cost three times as much and show nothing new.
        self.subsamples = 1 if isinstance(surface, Volume) else subsamples
        self.specular, self.reduced = specular, reduced
        self.evaluations = 0

    def evaluate(self, detail: Detail, seed: int | None = None) -> Evaluation:
        """Return the Evaluation of ``detail``, under another noise ``seed`` if given."""
        return self._compared(*self._looked_at(detail, seed))

    def evaluate_all(self, details: Iterable[Detail], seed: int) -> Iterator[Evaluation]:
        """Yield the Evaluation of each of ``details`` under one ``seed``, in order.

        While one is compared, by NumPy in one thread, the next is looked at, by Dr.Jit in all: a third of the time less
        on two cores.
        """
        with ThreadPoolExecutor(1) as worker:
            waiting: Future[Evaluation] | None = None
            for detail in details:
                seen = self._looked_at(detail, seed)
                if waiting is not None:
                    yield waiting.result()
                waiting = worker.submit(self._compared, *seen)
            if waiting is not None:
                yield waiting.result()

    def _looked_at(self, detail: Detail, seed: int | None) -> tuple[Detail, Components]:
        self.evaluations += 1
        # What is compared is luminance, under the tint that is solved: colour is learnt when the relief is found.
        changes: dict[str, Any] = {"colour": None} if seed is None else {"colour": None, "seed": seed}
        detail = detail.model_copy(update=changes)
        self.surface.update(detail)
        return detail, components(self.surface, self.target.lamp, subsamples=self.subsamples, shininess=SHININESS)

    def _compared(self, detail: Detail, parts: Components) -> Evaluation:
        medium = detail.medium is not None
        mask = self.target.mask if medium else self.target.mask & (parts.covered > COVERED)
        if not mask.any():
            return Evaluation(detail, UNUSABLE, UNUSABLE, np.zeros_like(self.target.luminance), mask, parts.covered)
        coefficients = solve(self.target.luminance, parts, mask, specular=self.specular, background=medium)
        picture = parts.luminance(coefficients.ambient, coefficients.diffuse, coefficients.specular, coefficients.shininess)
        if medium:
            picture = picture + np.float32(coefficients.background) * (1.0 - parts.covered)
        picture = np.minimum(picture, self.target.white)
        detail = detail.model_copy(
            update={
                "reflectance": detail.reflectance.model_copy(
                    update={
                        "ambient": coefficients.ambient,
                        "diffuse": coefficients.diffuse,
                        "specular": coefficients.specular,
                        "shininess": coefficients.shininess,
                        "tint": self.target.tint,
                    }
                )
            }
        )
        try:
            value = score = distance(self.target.descriptor, self.describe(picture, mask))
            if self.reduced is not None:
                score = 0.5 * (value + self._reduced_distance(self.reduced, picture, mask))
        except InputError:
            value = score = UNUSABLE
        return Evaluation(detail, value, score, picture, mask, parts.covered, coefficients.background)

    def _reduced_distance(self, reduced: Target, picture: NDArray[np.float32], mask: NDArray[np.bool_]) -> float:
        used = reduced.mask
        if not mask.all():
            used = used & resize_mask(mask, used.shape)
        small = resize(picture, used.shape)
        return distance(reduced.descriptor, describe(small, None if used.all() else used, like=reduced.descriptor))

    def describe(self, picture: NDArray[np.float32], mask: NDArray[np.bool_]) -> Descriptor:
        """Return the descriptor of a picture, like the photo's."""
        return describe(picture, None if mask.all() else mask, like=self.target.descriptor)
