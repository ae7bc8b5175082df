"""Pictures of a surface or a volume: the only caller of Mitsuba's renderer and tracer.

Under one light and a uniform sky the picture is linear in the three coefficients (GD10 section 7; DESIGN section 4):

    I = Ka A + Kd D + Ks S_n

A: share of the sky that is seen, cosine-weighted; 1 on a bare plane. D: E max(0, n . l) V. Both carry the factor by
which albedo varies with height, grain and colour. S_n: the modified Phong lobe (n + 2) / 2 cos^n(alpha) E max(0, n . l) V,
alpha between the view and the mirrored light; E irradiance over pi, V the visibility of the light. Sample positions are
a fixed grid in each pixel: no grain, so the metric never sees any.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import drjit as dr
import numpy as np
from numpy.typing import NDArray

from voldetail.backend import mitsuba
from voldetail.detail import Reflectance
from voldetail.render.heightfield import HeightField
from voldetail.render.marched import MarchedVolume
from voldetail.render.mesh_surface import TracedMesh
from voldetail.render.traced import path_integrator, sensor_of
from voldetail.render.traced_medium import TracedVolume
from voldetail.setup.lamp import Lamp

SHININESS = (16.0, 64.0)
"""Exponents whose lobes are rendered for the reflectance solve; a factor of 4 apart, about 2 in the lobe's width. A
broader lobe could not be told from diffuse light."""


@dataclass(frozen=True)
class Components:
    """Unit components of a picture, each (H, W) float32; specular holds one picture for each exponent of ``shininess``.

    ambient and diffuse are (H, W, 3) where the surface has a colour of its own.
    covered: the share of each pixel that the surface fills, 0 to 1.
    """

    ambient: NDArray[np.float32]
    diffuse: NDArray[np.float32]
    specular: NDArray[np.float32]
    shininess: tuple[float, ...]
    covered: NDArray[np.float32]

    def luminance(self, ambient: float, diffuse: float, specular: float, shininess: float) -> NDArray[np.float32]:
        """Return Ka A + Kd D + Ks S for an exponent that was rendered."""
        picture = ambient * self.ambient + diffuse * self.diffuse + self._gloss(specular, shininess)
        return np.asarray(picture, dtype=np.float32)

    def _gloss(self, specular: float, shininess: float) -> NDArray[np.float32]:
        if specular <= 0:
            return np.zeros_like(self.covered)
        return np.asarray(specular * self.specular[self.shininess.index(shininess)], dtype=np.float32)

    def colour(self, reflectance: Reflectance, behind: float | tuple[float, float, float] = 0.0) -> NDArray[np.float32]:
        """Return the picture (H, W, 3) under ``reflectance``: its tint colours all but the highlight.

        behind: a number or a colour, seen as far as a pixel is not covered.
        """
        tint = np.asarray(reflectance.tint, dtype=np.float32)
        matt = reflectance.ambient * self.ambient + reflectance.diffuse * self.diffuse
        if matt.ndim == 2:
            matt = matt[..., None]
        gloss = self._gloss(reflectance.specular, reflectance.shininess)
        through = (1.0 - self.covered[..., None]) * np.asarray(behind, dtype=np.float32)
        return np.asarray(matt * tint + gloss[..., None] + through, dtype=np.float32)


def components(
    surface: HeightField | TracedMesh | MarchedVolume,
    lamp: Lamp,
    *,
    subsamples: int = 2,
    shininess: tuple[float, ...] = SHININESS,
) -> Components:
    """Return the unit components of the surface as it was last updated, ``subsamples`` squared samples a pixel.

    Of a volume: what is covered is 1 - its transmittance; a medium that scatters has lobes of 0.
    """
    if isinstance(surface, MarchedVolume):
        covered, ambient, diffuse, *lobes = surface.march(lamp, subsamples, shininess)
        pictures = [covered], [ambient], [diffuse], lobes
    else:
        pictures = _reflected(surface, lamp, subsamples, shininess)
    dr.eval(pictures)
    shape = (surface.view.rows, surface.view.columns)
    covered, ambient, diffuse, lobes = ([_pool(np.asarray(p), shape, subsamples) for p in part] for part in pictures)
    specular = np.stack(lobes) if shininess else np.zeros((0, *shape), dtype=np.float32)
    return Components(_channels(ambient), _channels(diffuse), specular, shininess, covered[0])


def _channels(pictures: list[NDArray[np.float32]]) -> NDArray[np.float32]:
    """Return one picture (H, W), or three as (H, W, 3)."""
    return pictures[0] if len(pictures) == 1 else np.stack(pictures, axis=-1)


def _reflected(
    surface: HeightField | TracedMesh, lamp: Lamp, subsamples: int, shininess: tuple[float, ...]
) -> tuple[list[Any], list[Any], list[Any], list[Any]]:
    """Return covered, ambient, diffuse (one or three channels) and a lobe for each of ``shininess`` of a surface's samples."""
    mi = mitsuba()
    points, normals, sky, seen, albedo = surface.samples(subsamples)
    direction, distance, irradiance = lamp.at(points)
    cosine = dr.maximum(dr.dot(normals, direction), 0.0)
    lit = surface.lit(points, normals, direction, distance)
    received = dr.select(seen & lit, cosine * irradiance, 0.0)
    view = direction if lamp.at_camera else surface.towards_viewer
    mirrored = dr.maximum(dr.dot(2.0 * cosine * normals - direction, view), 0.0)
    lobes = []
    for exponent in shininess:
        n = dr.opaque(mi.Float, exponent)
        lobe = dr.select(mirrored > 0.0, dr.power(dr.maximum(mirrored, 1e-8), n), 0.0)
        lobes.append(0.5 * (n + 2.0) * lobe * received)
    covered = dr.select(seen, 1.0, dr.zeros(mi.Float, dr.width(points)))
    channels = albedo if isinstance(albedo, tuple) else (albedo,)
    ambient = [dr.select(seen, sky * factor, 0.0) for factor in channels]
    return [covered], ambient, [received * factor for factor in channels], lobes


def _pool(samples: NDArray[np.float32], shape: tuple[int, int], subsamples: int) -> NDArray[np.float32]:
    """Return the mean over each pixel's samples."""
    rows, columns = shape
    blocks = samples.reshape(rows, subsamples, columns, subsamples)
    # Sums of strided slices: ten times faster than a mean over two axes of a few elements.
    total = sum(blocks[:, i, :, j] for i in range(subsamples) for j in range(subsamples))
    return np.asarray(total * np.float32(1.0 / subsamples**2), dtype=np.float32)


def traced_picture(
    surface: TracedMesh | TracedVolume, samples: int, background: float | tuple[float, float, float], seed: int = 0
) -> NDArray[np.float32]:
    """Return the path-traced picture (H, W, 3) of a surface or volume whose scene holds its lights.

    What shows behind it is ``background``, a number or a colour: the environment lights the object and is not itself shown.
    """
    sensor = sensor_of(surface.view)
    integrator = surface.integrator if isinstance(surface, TracedVolume) else path_integrator()
    picture = np.asarray(mitsuba().render(surface.scene, sensor=sensor, integrator=integrator, spp=samples, seed=seed))
    colour, covered = picture[..., :3], picture[..., 3:4]
    return np.asarray(colour + (1.0 - covered) * np.asarray(background, dtype=np.float32), dtype=np.float32)
