"""What a density does to light, and what of it can be used.

    extinction sigma(x) = extinction * d(x),    T = exp(-integral of sigma along the way)

d: the density of a `DensityGrid`, 0 to 1; T: the share of light that passes (emission and absorption, as in direct
volume rendering: Kniss et al. 2003, which GD10 section 6 uses).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import drjit as dr
import numpy as np

from voldetail.errors import InputError
from voldetail.geometry.density_grid import DensityGrid

LARGEST_ASYMMETRY = 0.95
"""Of Henyey and Greenstein's phase function; nearer to 1 its lobe is narrower than any step over a sky or a light."""


@dataclass(frozen=True)
class Medium:
    """How a density looks.

    extinction: share of light lost a scene unit at density 1, above 0. asymmetry: None for a surface's shading on the
    density's gradient (GD10 section 6: Ka, Kd, Ks); a number g from -0.95 to 0.95 for a medium that scatters with
    Henyey and Greenstein's phase function, mean cosine g. albedo: None for light that scattered once, in which Ka and Kd
    both stand for the albedo: a thick white cloud is several times as bright (`traced_medium.SCATTERINGS`); a number from
    0 to 1, the share of light that scatters where it is stopped, for all orders, approximated (`many_scatterings`).
    """

    extinction: float
    asymmetry: float | None = None
    albedo: float | None = None

    def __post_init__(self) -> None:
        if not (math.isfinite(self.extinction) and self.extinction > 0):
            raise InputError(
                f"The medium's extinction is {self.extinction:g}, but has to be finite and above 0: give about 3 divided"
                " by the thickness, in scene units, that shall hide what is behind it."
            )
        if self.asymmetry is not None and not abs(self.asymmetry) <= LARGEST_ASYMMETRY:
            raise InputError(
                f"The medium's asymmetry is {self.asymmetry:g}, but has to be from -{LARGEST_ASYMMETRY} to"
                f" {LARGEST_ASYMMETRY}: give 0 for even scattering, or about 0.8 for a cloud."
            )
        if self.albedo is not None and self.asymmetry is None:
            raise InputError(
                f"The medium's albedo is {self.albedo:g}, but what is shaded as a surface scatters nothing inside: give an"
                " asymmetry too, or no albedo."
            )
        if self.albedo is not None and not 0 <= self.albedo <= 1:
            raise InputError(
                f"The medium's albedo is {self.albedo:g}, but has to be from 0 to 1: give about 0.99 for a white cloud."
            )


def check(grid: DensityGrid) -> None:
    """Raise InputError where a grid cannot be marched: lengths, the edge, or a density outside [0, 1] or not a number."""
    if len(grid.shape) != 3 or min(grid.shape) < 1:
        raise InputError(
            f"The density grid's shape is {grid.shape}, but has to be three whole numbers above 0: give (nz, ny, nx)."
        )
    wanted, found = math.prod(grid.shape), dr.width(grid.density)
    if found != wanted:
        raise InputError(
            f"The density grid of shape {grid.shape} holds {found} values, but has to hold {wanted}: give one a cell."
        )
    if not (math.isfinite(grid.edge) and grid.edge > 0 and all(math.isfinite(v) for v in grid.lower)):
        raise InputError(
            f"The density grid has cells of edge {grid.edge:g} from the corner {grid.lower}, but the edge has to be above"
            " 0 and all of it finite: give the box in scene units."
        )
    # Written so that what is not a number fails as well.
    wrong = int(np.asarray(dr.count(~((grid.density >= 0.0) & (grid.density <= 1.0))))[0])
    if wrong:
        raise InputError(
            f"The density grid's values have to be numbers from 0 to 1, but {wrong} of its {wanted} are not: clip them."
        )


def reflected(albedo: float, asymmetry: float) -> float:
    """Return the share of even light that an endless thick medium reflects, R = (1 - s)(1 - 0.139 s) / (1 + 1.17 s).

    s^2 = (1 - omega) / (1 - g omega), after van de Hulst 1980, "Multiple Light Scattering".
    """
    s = math.sqrt((1.0 - albedo) / (1.0 - asymmetry * albedo))
    return (1.0 - s) * (1.0 - 0.139 * s) / (1.0 + 1.17 * s)


def tinted_albedo(albedo: float, asymmetry: float, tint: tuple[float, ...]) -> tuple[float, float, float]:
    """Return the albedo of each channel with which a thick medium has the colour ``tint``, ``albedo`` in its brightest.

    The inverse of `reflected`: light that scatters many times takes on an albedo's colour many times over.
    """
    whole, found = reflected(albedo, asymmetry), []
    for channel in tint:
        wanted = whole * channel / max(tint)
        b = 1.139 + 1.17 * wanted
        s = (b - math.sqrt(b * b - 4.0 * 0.139 * (1.0 - wanted))) / (2.0 * 0.139)
        found.append(max((1.0 - s * s) / (1.0 - asymmetry * s * s), 0.0))
    r, g, b = found
    return r, g, b
