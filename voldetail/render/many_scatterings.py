"""Light that scattered any number of times in a density: diffusion between scatterings, with a chance of escape at each.

A medium of extinction sigma, albedo w and mean cosine g passes on light as one of sigma' = (1 - g w) sigma and albedo
w' = w (1 - g) / (1 - g w) that scatters evenly (similarity relation: Wyman, Patterson & Wilson 1989). In it light leaves a
place x unscattered with the chance a(x), the mean transmittance over all directions (`sky_light`), or scatters again, at
1 / sigma' from there: its mean intensity f obeys

    sigma' (1 - w' (1 - a)) f - div(D grad f) = q,    D = 1 / (3 sigma')

a diffusion (Stam 1995) that loses light by escape (Sobolev 1963), not at a boundary, which a density has none of; where
nothing leaves nor enters it is the usual one, and without D the escape-probability series w / (1 - w (1 - a)). The sky
has q = sigma' a. With w = 1 and the sky all around, f = 1 whatever the density: a white furnace is white. What a medium
turns towards the viewer v, with V(u) = a + b . u of `sky_light` for the sky and 1 - V(u) for what scattered before, is

    A = w (f - G b . v (1 - f) / (1 - a))

G: the mean cosine of g on light from half of all directions (`of_a_half`). The lamp's light goes straight on while it
turns little: of each scattering the share c = sqrt(g) stays in the beam, broadened by a mean cosine of sqrt(g), the rest
goes into q = w (1 - c) sigma (1 - a) B / 4, where B = exp(-(1 - w c) sigma depth). The beam's part is a sum over orders,
each less, flatter and wider than the one before (Wrenninge, Kulla & Lundqvist 2013), here with the weights of
exp(-(1 - w c) sigma depth), so that the first is single scattering:

    D = w (sum_i exp(-t) (w c t)^i / i! p(g c^i) + f + G b . v f / (1 - a)),    t = sigma depth, p: the phase function

How near it comes: tests/benchmarks/scattering.py. Solved on the sky's coarse grid by conjugate gradients, without a
random number; linear in the light. A frame takes 1.3 times as long as with one scattering, 1.2 for a grid of 128 cubed.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import drjit as dr
import numpy as np
from numpy.typing import NDArray

from voldetail.backend import mitsuba
from voldetail.field.medium import Medium
from voldetail.geometry.density_grid import DensityGrid
from voldetail.geometry.lookup import Lookup
from voldetail.render.optical_depth import LightDepth
from voldetail.render.sky_light import COARSE, centres, coarsened, icosahedron
from voldetail.setup.lamp import Lamp
from voldetail.setup.view import View

Values = NDArray[np.float32]

REACH = 3.0
"""Longest way between two scatterings in coarse edges: 1 / sigma' has no bound where the density is low. Tuned, as the next
three, on slabs of optical thickness 0.3 to 30 (tests/benchmarks/scattering.py), of 1, 2, 3, 4 and 6."""

SKY_TURN, LAMP_TURN = 0.8, 1.3
"""Factors of the terms with b in A and D, which are of first order in direction only."""

THIN = 0.2
"""Power (times g squared) of 1 - a by which less turns out of the beam in thin places: forward scattering leaves
them before its light is even. Without, a slab of thickness 1 (g = 0.85) is 1.5 times as bright from the front; with 0.5,
a soft ball of thickness 10 a quarter too dark from the side."""

LEAST = 1e-3
"""Optical thickness of a coarse cell that holds nothing: what is solved goes on there, for the cells between."""

TOLERANCE, ROUNDS = 1e-2, 200
"""Residual, of the source, at which the solver stops, and the most rounds. What is left is 0.1 to 0.3 % of a picture of a
cloud; up to 30 rounds are taken, of 0.1 to 0.3 ms each for 34 cubed."""


class ManyScatterings:
    """All orders of scattering in a grid; ``one_sided``: no sky below the plane z = 0, where light is lost."""

    def __init__(self, grid: DensityGrid, medium: Medium, view: View, one_sided: bool) -> None:
        self.g, self.albedo, self.extinction = medium.asymmetry or 0.0, medium.albedo or 0.0, medium.extinction
        self.kept = math.sqrt(max(self.g, 0.0))
        self.coarse = _with_margin(coarsened(grid, max(1, round(max(grid.shape) / COARSE))))
        self.centre = centres(self.coarse)
        reduced = self.extinction * (1.0 - self.g * self.albedo)
        self.turned = self.albedo * (1.0 - self.g) / (1.0 - self.g * self.albedo)
        density = np.array(self.coarse.density)
        self.empty = density <= 0.0
        self.sigma = np.maximum(density * reduced, LEAST / self.coarse.edge)
        *towards_sky, seen, escaping = self._openness(reduced, one_sided)
        # Never quite 0: it divides.
        self.closed = np.maximum(1.0 - escaping, 1e-4)
        # Half of all directions, the steepest that a first order stands for, has |b| = 1.5 a.
        steepest = 1.5 * np.minimum(seen, self.closed) / np.maximum(np.sqrt(sum(b * b for b in towards_sky)), 1e-9)
        towards_viewer = sum(b * v for b, v in zip(towards_sky, self._viewer(view), strict=True))
        self.lean = of_a_half(self.g) * np.minimum(1.0, steepest) * towards_viewer
        self.diffusion = Diffusion(self.sigma, 1.0 - self.turned * self.closed, self.coarse.shape, self.coarse.edge)
        even = self.diffusion.solve(self.sigma * seen)
        even = np.where(self.empty, seen + self.turned * (1.0 - seen) * even, even)
        rest = np.minimum(1.0 - even, 1.0) / np.maximum(1.0 - seen, 1e-4)
        self.sky = np.maximum(even - SKY_TURN * self.lean * rest, 0.0)
        self._lit: tuple[Lamp, LightDepth, Lookup] | None = None

    def _viewer(self, view: View) -> list[Any]:
        """Return x, y and z of the unit vectors from the coarse cells to the viewer."""
        if not view.perspective:
            return [0.0, 0.0, 1.0]
        x, y, z = (np.array(c) for c in self.centre)
        away = np.maximum(np.sqrt(x * x + y * y + (view.distance - z) ** 2), 1e-9)
        return [-x / away, -y / away, (view.distance - z) / away]

    def _openness(self, extinction: float, one_sided: bool) -> list[Values]:
        """Return b (x, y, z) and a of the sky, and a of all directions, in each coarse cell."""
        mi = mitsuba()
        total = [dr.zeros(mi.Float, dr.width(self.centre)) for _ in range(5)]
        directions = icosahedron()
        for direction in directions:
            depth = LightDepth(self.coarse, Lamp(direction=direction)).at(self.centre)
            towards = mi.Vector3f(*(dr.opaque(mi.Float, v) for v in direction))
            passed = self._mean_passed(depth, towards, extinction) * (1.0 / len(directions))
            shown = 0.0 if one_sided and direction[2] < 0 else 1.0
            weights = (*(3.0 * v * shown for v in direction), shown, 1.0)
            total = [t + passed * dr.opaque(mi.Float, w) for t, w in zip(total, weights, strict=True)]
            dr.eval(total)
        return [np.array(t) for t in total]

    def _mean_passed(self, depth: Any, direction: Any, extinction: float) -> Any:
        """Return the mean transmittance over each coarse cell, of the depth at its middle: the cell may be opaque."""
        mi = mitsuba()
        sigma = dr.opaque(mi.Float, extinction)
        across = dr.opaque(mi.Float, self.coarse.edge) / dr.max(dr.abs(direction))
        t = dr.maximum(sigma * self.coarse.density * across, 1e-3)
        return dr.exp(-dr.maximum(sigma * depth - 0.5 * t, 0.0)) * (1.0 - dr.exp(-t)) / t

    def light(self, lamp: Lamp, depth: LightDepth) -> Lookup:
        """Return what the sky, and what the lamp's beam has lost, turn towards the viewer; kept for as long as both stay."""
        if self._lit is None or self._lit[:2] != (lamp, depth):
            direction, _, irradiance = lamp.at(self.centre)
            lost = 1.0 - self.albedo * self.kept
            beam = irradiance * self._mean_passed(depth.at(self.centre), direction, self.extinction * lost)
            turning = 0.25 * self.albedo * (1.0 - self.kept) / (1.0 - self.g * self.albedo) * self.sigma * np.array(beam)
            even = self.diffusion.solve(turning * self.closed ** (1.0 + THIN * max(self.g, 0.0) ** 2))
            even = np.where(self.empty, self.turned * self.closed * even, even)
            diffused = np.maximum(even + LAMP_TURN * self.lean * even / self.closed, 0.0)
            none = np.zeros_like(even)
            packed = _float(np.stack([self.sky, diffused, none, none], axis=1).ravel())
            self._lit = lamp, depth, Lookup(packed, 4, self.coarse.shape, self.coarse.lower, self.coarse.edge)
        return self._lit[2]

    def shade(self, lamp: Lamp, depth: LightDepth, along: Any, lobes: int) -> Callable[[Any, Any, Any], list[Any]]:
        """Return the function of (point, density there, active) that gives the unit components."""
        mi = mitsuba()
        light = self.light(lamp, depth)
        albedo, kept, extinction = (dr.opaque(mi.Float, v) for v in (self.albedo, self.kept, self.extinction))
        g, narrowing = dr.opaque(mi.Float, self.g), dr.opaque(mi.Float, math.log2(max(self.kept, 1e-9)))

        def scatter(point: Any, found: Any, active: Any) -> list[Any]:
            direction, _, irradiance = lamp.at(point)
            turned = dr.dot(direction, along)
            thickness = extinction * depth.at(point, active)
            mean = albedo * kept * thickness
            first = dr.exp(-thickness)
            second, all_orders = mean * first, dr.exp(mean - thickness)
            # Further ones have the phase of their mean one.
            rest = dr.maximum(all_orders - first - second, 0.0)
            order = dr.maximum((mean * all_orders - second) / dr.maximum(rest, 1e-7), 2.0)
            further = _phase(g * dr.exp2(order * narrowing), turned)
            beam = first * _phase(g, turned) + second * _phase(g * kept, turned) + rest * further
            many = light.at(point, active)
            lamplight = irradiance * beam + many.y
            return [albedo * many.x, albedo * lamplight, *(0.0 * thickness for _ in range(lobes))]

        return scatter


class Diffusion:
    """The equation above on a grid: seven points, no flow through the box's faces, scaled to a diagonal of 1."""

    def __init__(self, sigma: Values, lost: Values, shape: tuple[int, int, int], edge: float) -> None:
        way = 1.0 / np.maximum(sigma, 1.0 / (REACH * edge))
        flow = (sigma * (way / edge) ** 2 / 3.0).astype(np.float32).reshape(shape)
        diagonal = (sigma * lost).astype(np.float32)
        self.loss = float(diagonal.sum())
        self.strides = (shape[1] * shape[2], shape[2], 1)
        between: list[Values] = []
        for axis, stride in enumerate(self.strides):
            low, high = (np.moveaxis(flow, axis, 0)[part] for part in (slice(None, -1), slice(1, None)))
            both = np.zeros(shape, dtype=np.float32)
            np.moveaxis(both, axis, 0)[:-1] = 2.0 * low * high / (low + high)
            between.append(both.ravel()[: both.size - stride])
            diagonal[: both.size - stride] += between[-1]
            diagonal[stride:] += between[-1]
        self.scale = 1.0 / np.sqrt(diagonal)
        self.between = [c * self.scale[:-s] * self.scale[s:] for c, s in zip(between, self.strides, strict=True)]

    def solve(self, source: Values) -> Values:
        """Return f of the source q (conjugate gradients: Hestenes & Stiefel 1952)."""

        def dot(a: Values, b: Values) -> float:
            return float(np.einsum("i,i", a, b))  # in one thread: others would cost more than they help

        residual = (source * self.scale).astype(np.float32)
        enough = TOLERANCE**2 * dot(residual, residual)
        # From what is the same everywhere and loses as much as comes in: for a white furnace it is the answer.
        found = (float(source.sum()) / max(self.loss, 1e-30) / self.scale).astype(np.float32)
        residual -= self._times(found)
        way, square = residual.copy(), dot(residual, residual)
        for _ in range(ROUNDS):
            if square <= enough:
                break
            turned = self._times(way)
            step = square / dot(way, turned)
            found += step * way
            residual -= step * turned
            square, before = dot(residual, residual), square
            way = residual + (square / before) * way
        return np.asarray(found * self.scale, dtype=np.float32)

    def _times(self, values: Values) -> Values:
        product, flow = values.copy(), np.empty_like(values)
        for c, stride in zip(self.between, self.strides, strict=True):
            product[:-stride] -= np.multiply(c, values[stride:], out=flow[stride:])
            product[stride:] -= np.multiply(c, values[:-stride], out=flow[stride:])
        return product


def of_a_half(g: float) -> float:
    """Return the G with which 1/2 + 3/4 G of the light from the half of all directions behind is turned ahead.

    Of Henyey and Greenstein's function (1941) the share (1 + g) / 2 g (1 - (1 - g) / sqrt(1 + g^2)); near 0, G = g.
    """
    if abs(g) < 1e-3:
        return g
    ahead = (1.0 + g) / (2.0 * g) * (1.0 - (1.0 - g) / math.hypot(1.0, g))
    return 4.0 / 3.0 * (ahead - 0.5)


def _phase(g: Any, cosine: Any) -> Any:
    root = dr.rsqrt(1.0 + g * g - 2.0 * g * cosine)
    return 0.25 * (1.0 - g * g) * root * root * root


def _with_margin(grid: DensityGrid) -> DensityGrid:
    """Return the grid with one empty cell around it: light leaves a shape that the box cuts, too."""
    values = np.pad(grid.array(), 1)
    nz, ny, nx = values.shape
    x, y, z = (v - grid.edge for v in grid.lower)
    return DensityGrid(_float(values.ravel()), (nz, ny, nx), (x, y, z), grid.edge)


def _float(values: Values) -> Any:
    """Return a Dr.Jit array of NumPy's values, which it uses where they lie: aligned, or another kernel is compiled."""
    room = np.empty(values.size + 16, dtype=np.float32)
    start = (-room.ctypes.data // 4) % 16
    aligned = room[start : start + values.size]
    aligned[:] = values
    return mitsuba().Float(aligned)
