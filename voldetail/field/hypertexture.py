"""Hypertexture: an object's density, its points shifted by the relief function in space (GD10 section 6).

Symbols
    P'      P + A_d R(P) G(P), the shifted point, at which the density is looked up
    A_d     amplitude, scene units      R(P)    relief function in [0, 1] (eq. 3), at P in the object's own frame
    G       the normalised gradient of the object's density, G = -n with n the outward normal (field.shell)
    s, d    signed distance, and the object's density, a function of s alone (field.shell)
    d_h     exponent of the transfer function th = d(P')^d_h

Choices:
- G is normalised, as GD10 says: A_d R is then a length, whatever the thickness of the shell, and the same as displacement's.
- G points inwards, where density is higher. A point outside looks up what lies A_d R deeper: matter grows outwards by
  A_d R, as with P' = P + A_d R N of displacement.
- s is a distance, so that moving along its gradient changes it by as much as one moves: s(P') = s(P) - A_d R(P). That is
  what is computed: d(P') = d(s - A_d R). It is GD10's lookup wherever the way from P to P' does not pass the middle of the
  object; where it does (parts thinner than the shift), P' would come out on the other side and the lookup tear a hole,
  and this does not. And n is defined outside the shell, where GD10's gradient of density vanishes.

R is solid noise: along the way outwards it changes, so one foot point may have several surfaces above it (overhangs, tufts)
and islands may float free. With R constant along n this would be displacement.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import drjit as dr

from voldetail.backend import mitsuba
from voldetail.detail import Detail
from voldetail.errors import InputError
from voldetail.field.relief import SOLID, relief_at
from voldetail.field.shell import Points, Shell
from voldetail.geometry.density_grid import DensityGrid, split

FLOOR = 1e-12
"""Least density whose power with an exponent below 1 has a slope."""


@dataclass(frozen=True, eq=False)
class Hypertexture:
    """The density of ``shell`` shifted by the relief of ``detail``; at any point, or baked.

    exponent: d_h of the transfer function, over 0; 1 leaves the density as it is. scale: as many times larger the detail is.
    """

    shell: Shell
    detail: Detail
    exponent: float = 1.0
    scale: float = 1.0

    def __post_init__(self) -> None:
        if self.detail.noise.domain != SOLID:
            raise InputError(
                'A hypertexture needs noise that fills space, but the detail\'s noise.domain is "surface": set it to "solid"'
                " (the other numbers may stay), or put the detail on as displacement."
            )
        for name, value in (("exponent d_h", self.exponent), ("scale", self.scale)):
            if not (math.isfinite(value) and value > 0):
                raise InputError(f"The {name} of a hypertexture is {value:g}; it has to be over 0.")
        if self.amplitude > self.shell.plan.amplitude * (1 + 1e-6):
            raise InputError(
                f"The relief rises by up to {self.amplitude:g} scene units, but the shell was planned for"
                f" {self.shell.plan.amplitude:g}: plan it for an amplitude of {self.amplitude:g}."
            )

    @property
    def amplitude(self) -> float:
        """A_d in scene units, with the scale."""
        return self.detail.relief.amplitude * self.scale

    @property
    def level(self) -> float:
        """The density of the surface itself, 0.5^d_h: where R is 0 it lies on the proxy."""
        return float(0.5**self.exponent)

    def height_at(self, points: Points) -> Any:
        """Return s - A_d R at ``points`` of the scene: 0 on the relief's surface, negative inside."""
        return self._height(self.shell.own(points))[0]

    def density_at(self, points: Points) -> Any:
        """Return th(d(P')) in [0, 1] at ``points`` of the scene."""
        own = self.shell.own(points)
        return dr.select(self.shell.within(own), self._transfer(self.shell.profile(self._height(own)[0])), 0.0)

    def outward_at(self, points: Points) -> Points:
        """Return the gradient of `height_at`, n - A_d grad R, not normalised: the normal where there is no density either."""
        return self._gradients(points)[1]

    def gradient_at(self, points: Points) -> Points:
        """Return the gradient of `density_at`, per scene unit; it points inwards, and is 0 beside the shell."""
        height, outward = self._gradients(points)
        base = self.shell.profile(height)
        exponent = dr.opaque(type(height), self.exponent)
        slope = self.shell.slope(height) * exponent * dr.power(dr.maximum(base, FLOOR), exponent - 1.0)
        slope = dr.select(self.shell.within(self.shell.own(points)), slope, 0.0)
        return tuple(slope * v for v in outward)

    def bake(self) -> DensityGrid:
        """Return the density on the cubes of the shell's plan; the noise is computed only where it can matter.

        Raises InputError where the plan is for tiles alone.
        """
        shell = self.shell
        shell.plan.check_dense()
        density = dr.zeros(mitsuba().Float, shell.plan.cells)
        for index in shell.tiles():
            self._fill(density, index, lambda index: split(index, shell.plan.shape))
        return shell.grid(density)

    def bake_block(self, first: tuple[int, int, int], side: int, distance: Any = None) -> Any:
        """Return the densities of ``side`` cubed cells of the plan's grid from cell ``first`` (z, y, x) on, x fastest.

        They are those of `bake` to the bit, and 0 beside the grid, where ``first`` may lie too. distance: s at the cells'
        middles, for a shell that does not know it; else the shell's.
        """
        mi = mitsuba()
        density = dr.zeros(mi.Float, side**3)
        start = [dr.opaque(mi.Int32, number) for number in reversed(first)]

        def cells_of(index: Any) -> Points:
            return tuple(mi.Int32(cell) + low for cell, low in zip(split(index, (side, side, side)), start, strict=True))

        self._fill(density, dr.arange(mi.UInt32, side**3), cells_of, distance)
        return density

    def _fill(self, density: Any, index: Any, cells_of: Callable[[Any], Points], distances: Any = None) -> None:
        """Write the density of the cells ``cells_of(index)`` to the places ``index`` of ``density``."""
        mi = mitsuba()
        shell, half = self.shell, self.shell.plan.thickness / 2
        lowest, highest = dr.opaque(mi.Float, -half), dr.opaque(mi.Float, half + self.amplitude)
        cells = cells_of(index)
        own = shell.own(shell.middles_of(cells))
        distance = shell.distance(own)[0] if distances is None else dr.gather(mi.Float, distances, index)
        within = shell.within(own) & shell.in_box(cells)
        dr.scatter(density, dr.select(within & (distance <= lowest), mi.Float(1.0), 0.0), index)
        # Below the shell a shift only goes deeper; above it the highest relief does not reach.
        near: Any = dr.compress((distance > lowest) & (distance < highest) & within)
        dr.eval(density)
        if dr.width(near):
            chosen = dr.gather(mi.UInt32, index, near)
            own = shell.own(shell.middles_of(cells_of(chosen)))
            distance = shell.distance(own)[0] if distances is None else dr.gather(mi.Float, distances, chosen)
            dr.scatter(density, self._transfer(shell.profile(distance - self._relief(own))), chosen)
            dr.eval(density)

    def _height(self, own: Points) -> tuple[Any, Points]:
        distance, normal = self.shell.distance(own)
        return distance - self._relief(own), normal

    def _relief(self, own: Points) -> Any:
        return relief_at(self.detail, own, self.scale) * dr.opaque(type(own[0]), self.amplitude)

    def _transfer(self, density: Any) -> Any:
        if self.exponent == 1.0:
            return density
        # 0 to a power is 0: the floor is for the logarithm in it alone.
        raised = dr.power(dr.maximum(density, 1e-30), dr.opaque(type(density), self.exponent))
        return dr.select(density > 0.0, raised, 0.0)

    def _gradients(self, points: Points) -> tuple[Any, Points]:
        """Return height and its gradient in the scene's axes: n is known, and R's is Dr.Jit's (reverse mode)."""
        own = tuple(type(v)(dr.detach(v)) for v in self.shell.own(points))
        distance, normal = self.shell.distance(own)
        dr.enable_grad(*own)
        relief = self._relief(own)
        # R at a point depends on that point alone: one pass gives the gradients of all.
        dr.backward_from(relief)
        outward = tuple(n - dr.grad(v) for n, v in zip(normal, own, strict=True))
        height = distance - dr.detach(relief)
        return height, self.shell.to_scene(outward)
