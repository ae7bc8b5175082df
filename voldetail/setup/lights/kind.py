"""What every kind of light tells of itself."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from typing import ClassVar, Protocol

import numpy as np
from numpy.typing import NDArray

from voldetail.setup.lamp import Lamp
from voldetail.setup.lights.vectors import Vector

Numbers = Callable[[str, tuple[int, ...]], list[float]]
"""From a part of a light's text, and how many numbers it may hold, to the numbers; refuses others."""

Fields = dict[str, object]
"""Numbers of a light's record by name."""


class LightNumbers(Protocol):
    """The numbers of a light's record, as setup.light has it; a kind has its own of them, and the others are None or default."""

    @property
    def direction(self) -> Vector | None: ...
    @property
    def position(self) -> Vector | None: ...
    @property
    def target(self) -> Vector | None: ...
    @property
    def angle(self) -> float | None: ...
    @property
    def foot(self) -> tuple[float, float] | None: ...
    @property
    def height(self) -> float: ...
    @property
    def strength(self) -> float: ...


class LightKind(ABC):
    """A kind of light.

    name: in files. forms: how its text looks, for help and refusals. needed: numbers of the record that it cannot do without.
    own: numbers that are its own, `needed` included (what two kinds have is own to both). estimated: whether it is no light
    yet but is to be found from the photo.
    """

    name: ClassVar[str]
    forms: ClassVar[tuple[str, ...]]
    needed: ClassVar[tuple[str, ...]] = ()
    own: ClassVar[tuple[str, ...]] = ()
    estimated: ClassVar[bool] = False

    @abstractmethod
    def fields(self, word: str, numbers: Numbers) -> Fields | None:
        """Return the numbers that the text ``word`` gives, None where it is not of this kind."""

    @abstractmethod
    def text(self, light: LightNumbers) -> str:
        """Return the text that `fields` reads, numbers to 7 digits."""

    @abstractmethod
    def lamp(self, light: LightNumbers, luminance: NDArray[np.float32] | None) -> Lamp:
        """Return where the light comes from and how strong it is, for a photo of ``luminance`` (H, W) where that matters."""

    @abstractmethod
    def words(self, light: LightNumbers) -> str:
        """Return the light in words, angles in degrees."""

    def source(self, light: LightNumbers) -> Vector | None:
        """Return the direction or the place that it comes from, None where it is always before the surface."""
        return None


def listed(*numbers: float) -> str:
    """Return numbers as they are typed, to 7 digits."""
    return ",".join(f"{v:.7g}" for v in numbers)
