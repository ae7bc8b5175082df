"""A density seen by walking along each ray: emission and absorption, front to back (GD10 section 6, after Kniss et al.).

    I = sum_i T_i alpha_i C_i,   alpha_i = 1 - exp(-sigma d_i h),   T_{i+1} = T_i (1 - alpha_i),   coverage = 1 - T

d_i: density in the middle of step i of length h; sigma: extinction. C is what a place reflects, in unit components:
a surface's (ambient, diffuse, Phong lobes) on n = -grad d / |grad d|, or what a medium scatters, of one order here or of
all (`many_scatterings`). Steps are equal along a ray and lie at fixed places: no random number, so no grain. The error
falls with the square of the step.
"""

from __future__ import annotations

from typing import Any

import drjit as dr

from voldetail.backend import mitsuba
from voldetail.errors import InputError
from voldetail.field.medium import Medium, check
from voldetail.geometry.density_grid import DensityGrid
from voldetail.geometry.lookup import Emptiness, with_gradient
from voldetail.render.many_scatterings import ManyScatterings
from voldetail.render.optical_depth import LightDepth
from voldetail.render.rays import rays_of
from voldetail.render.sky_light import SkyLight
from voldetail.setup.lamp import Lamp
from voldetail.setup.view import View

STEP = 0.5
"""Longest step in edges of a cell: tests/unit/test_marched.py has the table of errors."""

CUTOFF = 1e-3
"""Transmittance below which a ray ends: less than an 8-bit picture shows. What is left gets the mean colour so far."""

FLAT = 0.05
"""Gradient, in densities over the box's longest side, at which a place is half a surface. Less is the inside of a
body, which has no side to shade and reflects evenly: a quarter of the light, the mean of max(0, n . l) over all n."""

LIFT, SKY_LIFT = 2.5, 1.5
"""Edges by which a surface's place is lifted along its normal before it looks for the light, and edges of the coarse grid
before it looks for the sky: a surface is not to be hidden by its own thickness. On a sphere whose density rises within 2
cells, the lit side is then within 2 % of Lambert's law and the sky's share within 4 % of 1; without, both lose half or more."""


class MarchedVolume:
    """A density grid over a View; `fill` sets the grid, `march` looks at it.

    ``one_sided_sky``: only the sky in front of the plane z = 0, as for a plane that goes on beyond the view.
    """

    def __init__(self, view: View, *, one_sided_sky: bool = False, step: float = STEP) -> None:
        self.view, self.one_sided_sky, self.step = view, one_sided_sky, step
        self._rays: dict[int, Any] = {}

    def fill(self, grid: DensityGrid, medium: Medium) -> None:
        """Set the density and how it looks; raises InputError for a grid that cannot be marched."""
        mi = mitsuba()
        check(grid)
        if grid.upper[2] >= self.view.distance:
            raise InputError(
                f"The volume's box reaches up to z = {grid.upper[2]:g}, to the camera at {self.view.distance:g}: move the"
                " camera away or make the box smaller."
            )
        self.grid, self.medium = grid, medium
        self.extinction = dr.opaque(mi.Float, medium.extinction)
        dr.eval(grid.density)
        self._density, self._emptiness = with_gradient(grid), Emptiness(grid)
        if medium.albedo is None:
            self._sky = SkyLight(grid, self.extinction, self.one_sided_sky)
        else:
            self._many = ManyScatterings(grid, medium, self.view, self.one_sided_sky)
        self._light: tuple[Lamp, LightDepth] | None = None

    def light_depth(self, lamp: Lamp) -> LightDepth:
        """Return the density between the box and the lamp; kept for as long as both stay."""
        if self._light is None or self._light[0] != lamp:
            self._light = (lamp, LightDepth(self.grid, lamp))
        return self._light[1]

    def march(self, lamp: Lamp, subsamples: int, shininess: tuple[float, ...]) -> list[Any]:
        """Return (coverage, ambient, diffuse, a lobe for each of ``shininess``) of the samples, row by row."""
        mi = mitsuba()
        if subsamples not in self._rays:
            self._rays[subsamples] = rays_of(self.view, subsamples)
            dr.make_opaque(self._rays[subsamples].o, self._rays[subsamples].d)
        ray = self._rays[subsamples]
        shade = self._shade(lamp, shininess, ray.d)
        first, last = self._span(ray)
        count = dr.ceil(dr.maximum(last - first, 0.0) / dr.opaque(mi.Float, self.step * self.grid.edge))
        h = dr.select(count > 0.0, (last - first) / dr.maximum(count, 1.0), 0.0)
        # Left unevaluated, the loop would carry along how they came about.
        dr.eval(first, count, h)

        def going(i: Any, passed: Any, sums: list[Any]) -> Any:
            return (i < count) & (passed > CUTOFF)

        def step(i: Any, passed: Any, sums: list[Any]) -> tuple[Any, Any, list[Any]]:
            t = first + (i + 0.5) * h
            point = ray.o + t * ray.d
            empty, ahead = self._emptiness.ahead(point, ray.d)

            def walk(i: Any, passed: Any, sums: list[Any]) -> tuple[Any, Any, list[Any]]:
                return i + 1.0 + dr.floor(ahead / h), passed, sums

            def sample(i: Any, passed: Any, sums: list[Any]) -> tuple[Any, Any, list[Any]]:
                found = self._density.at(point)
                through = dr.exp(-self.extinction * found.w * h)
                weight = passed * (1.0 - through)
                colours = shade(point, found, weight > 0.0)
                return i + 1.0, passed * through, [s + weight * c for s, c in zip(sums, colours, strict=True)]

            return dr.if_stmt((i, passed, sums), empty, walk, sample)

        width = dr.width(ray.o)
        zeros = [dr.zeros(mi.Float, width) for _ in range(2 + len(shininess))]
        state = (dr.zeros(mi.Float, width), dr.full(mi.Float, 1.0, width), zeros)
        _, passed, sums = dr.while_loop(state, going, step, label="march along the view")
        ended = passed <= CUTOFF
        covered = dr.select(ended, 1.0, 1.0 - passed)
        rest = dr.select(ended, 1.0 / (1.0 - passed), 1.0)
        return [covered, *(s * rest for s in sums)]

    def _span(self, ray: Any) -> tuple[Any, Any]:
        """Return where each ray enters and leaves the box (slabs; Kay & Kajiya 1986)."""
        mi = mitsuba()
        lower, upper = (mi.Point3f(*(dr.opaque(mi.Float, float(v)) for v in c)) for c in (self.grid.lower, self.grid.upper))
        parallel = dr.abs(ray.d) < 1e-8
        one, other = (lower - ray.o) / ray.d, (upper - ray.o) / ray.d
        beside = parallel & ((ray.o < lower) | (ray.o >= upper))
        near = dr.select(parallel, 0.0, dr.minimum(one, other))
        far = dr.select(beside, -1.0, dr.select(parallel, 1e9, dr.maximum(one, other)))
        return dr.maximum(dr.max(near), 0.0), dr.min(far)

    def _shade(self, lamp: Lamp, shininess: tuple[float, ...], along: Any) -> Any:
        """Return the function of (point, gradient and density, active) that gives the unit components there."""
        mi = mitsuba()
        if self.medium.albedo is not None:
            return self._many.shade(lamp, self.light_depth(lamp), along, len(shininess))
        light, sky, edge = self.light_depth(lamp), self._sky, dr.opaque(mi.Float, self.grid.edge)
        flat = dr.opaque(mi.Float, FLAT / (max(self.grid.shape) * self.grid.edge))
        exponents = [dr.opaque(mi.Float, n) for n in shininess]
        g = dr.opaque(mi.Float, self.medium.asymmetry or 0.0)

        def scatter(point: Any, found: Any, active: Any) -> list[Any]:
            direction, _, irradiance = lamp.at(point)
            # Henyey & Greenstein 1941 times pi: irradiance is in units of pi. Light travels along -direction.
            turned = dr.dot(direction, along)
            phase = 0.25 * (1.0 - g * g) * dr.power(1.0 + g * g - 2.0 * g * turned, -1.5)
            passed = dr.exp(-self.extinction * light.at(point, active))
            return [sky.scattered(point, -along, g, active), phase * irradiance * passed, *(0.0 * n for n in exponents)]

        def reflect(point: Any, found: Any, active: Any) -> list[Any]:
            steepness = dr.sqrt(found.x * found.x + found.y * found.y + found.z * found.z)
            side = steepness / (steepness + flat)
            normal = mi.Vector3f(found.x, found.y, found.z) * (-1.0 / dr.maximum(steepness, 1e-12))
            direction, _, irradiance = lamp.at(point)
            out = side * normal
            received = irradiance * dr.exp(-self.extinction * light.at(point + LIFT * edge * out, active))
            cosine = dr.maximum(dr.dot(normal, direction), 0.0)
            view = direction if lamp.at_camera else -along
            mirrored = dr.maximum(dr.dot(2.0 * cosine * normal - direction, view), 0.0)
            gloss = side * cosine * received
            lobes = [
                0.5 * (n + 2.0) * dr.select(mirrored > 0.0, dr.power(dr.maximum(mirrored, 1e-8), n), 0.0) * gloss
                for n in exponents
            ]
            ambient = sky.on_surface(point + SKY_LIFT * sky.edge * out, out, active)
            return [ambient, received * dr.lerp(0.25, cosine, side), *lobes]

        return reflect if self.medium.asymmetry is None else scatter
