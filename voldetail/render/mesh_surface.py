"""Any proxy as a Mitsuba scene of one mesh, displaced or the surface of a volume: the general way to see a relief."""

from __future__ import annotations

import math
from typing import Any

import drjit as dr
import numpy as np
from numpy.typing import NDArray

from voldetail.backend import mitsuba
from voldetail.detail.photo_relief import AnyDetail
from voldetail.field.albedo import diffuse_of, factor_of, factors_of
from voldetail.field.hypertexture import Hypertexture
from voldetail.field.relief import relief_and_albedo
from voldetail.geometry.isosurface import Isosurface
from voldetail.geometry.proxy import Proxy
from voldetail.render.plugins.phong import VERTEX_ALBEDO
from voldetail.render.rays import rays_of
from voldetail.setup.view import View

SKY_RAYS = 32
"""Directions in which the sky is looked for, the same for every point: smooth shading without grain."""

GOLDEN_ANGLE = math.pi * (3.0 - math.sqrt(5.0))
SHAPE = "detail"


class TracedMesh:
    """A mesh traced by Mitsuba, seen through ``view``, in a scene with its ``emitters``."""

    def __init__(
        self,
        view: View,
        *,
        one_sided_sky: bool = False,
        bsdf: dict[str, Any] | None = None,
        emitters: dict[str, Any] | None = None,
    ) -> None:
        mi = mitsuba()
        self.view, self.one_sided_sky = view, one_sided_sky
        self._bsdf, self._emitters = bsdf, emitters or {}
        self.albedo: Any = None
        self.towards_viewer: Any = mi.Vector3f(0.0, 0.0, 1.0)

    def _load(
        self, positions: Any, faces: NDArray[np.integer[Any]], normals: Any = None, diffuse: tuple[Any, ...] | None = None
    ) -> None:
        """Load the scene of a mesh: positions (and normals, else Mitsuba's own) as flat arrays, faces (F, 3).

        diffuse: the vertices' albedo, where the BSDF takes it from them.
        """
        mi = mitsuba()
        self._faces = tuple(mi.UInt32(np.ascontiguousarray(faces[:, corner])) for corner in range(3))
        properties = mi.Properties()
        if self._bsdf is not None:
            properties["bsdf"] = mi.load_dict(self._bsdf)
        # With vertex normals, though none are given: else Mitsuba makes none anew and every face is shaded flat.
        count = dr.width(positions) // 3, len(faces)
        mesh = mi.Mesh(SHAPE, *count, has_vertex_normals=True, props=properties)
        parameters = mi.traverse(mesh)
        parameters["vertex_positions"] = positions
        parameters["faces"] = mi.UInt32(np.ascontiguousarray(faces).ravel())
        parameters.update()
        if normals is not None:
            # After the positions, whose change makes Mitsuba compute its own.
            parameters["vertex_normals"] = normals
            parameters.update()
        if diffuse is not None:
            mesh.add_attribute(VERTEX_ALBEDO, 3, dr.ravel(mi.Color3f(*diffuse)))
        self.scene = mi.load_dict({"type": "scene", "embree_use_robust_intersections": True, SHAPE: mesh, **self._emitters})

    def _diffuse(self, detail: AnyDetail) -> tuple[Any, ...] | None:
        """Return the albedo of the vertices where a BSDF is to take it from them."""
        return None if self._bsdf is None or self.albedo is None else diffuse_of(detail, self.albedo)

    def rays(self, subsamples: int) -> Any:
        """Return the camera rays of a regular grid of samples, row by row."""
        return rays_of(self.view, subsamples)

    def samples(self, subsamples: int) -> tuple[Any, Any, Any, Any, Any]:
        """Return (points, unit normals towards the viewer, sky visibility, seen at all, albedo factor), row by row."""
        ray = self.rays(subsamples)
        hit = self.scene.ray_intersect(ray)
        seen = hit.is_valid()
        # A proxy may be seen from its back (an open mesh): shade the side that is seen.
        normals = dr.select(dr.dot(hit.sh_frame.n, ray.d) > 0.0, -hit.sh_frame.n, hit.sh_frame.n)
        geometric = dr.select(dr.dot(hit.n, ray.d) > 0.0, -hit.n, hit.n)
        dr.eval(hit.p, normals, geometric, seen)
        self.towards_viewer = -ray.d
        self._geometric = geometric
        sky = self._sky(hit.p, normals, geometric, seen)
        return hit.p, normals, sky, seen, self._albedo_at(hit, seen)

    def _albedo_at(self, hit: Any, seen: Any) -> Any:
        """Return the albedo factor of the vertices, interpolated at the hits."""
        corners = [dr.gather(type(face), face, hit.prim_index, seen) for face in self._faces]
        u, v = hit.uv.x, hit.uv.y
        found = []
        for factor in factors_of(self.albedo):
            a, b, c = (dr.gather(type(factor), factor, corner, seen) for corner in corners)
            found.append(a * (1.0 - u - v) + b * u + c * v)
        return factor_of(found)

    def _offset(self, points: Any, geometric: Any) -> Any:
        # A hundredth of a pixel off the surface, and never less than single precision can tell apart.
        return points + geometric * max(0.01 * self.view.pixel, 1e-5)

    def _sky(self, points: Any, normals: Any, geometric: Any, seen: Any) -> Any:
        """Return the cosine-weighted share of the sky that each point sees, over fixed directions about its normal."""
        mi = mitsuba()
        frame = mi.Frame3f(normals)
        origin = self._offset(points, geometric)
        total = dr.zeros(mi.Float, dr.width(points))
        for index in range(SKY_RAYS):
            radius = math.sqrt((index + 0.5) / SKY_RAYS)
            turn = index * GOLDEN_ANGLE
            local = dr.opaque(mi.Float, radius * math.cos(turn)), dr.opaque(mi.Float, radius * math.sin(turn))
            up = dr.opaque(mi.Float, math.sqrt(1.0 - radius * radius))
            direction = frame.to_world(mi.Vector3f(local[0], local[1], up))
            free = seen & ~self.scene.ray_test(mi.Ray3f(origin, direction), seen)
            if self.one_sided_sky:
                free &= direction.z > 0.0
            total += dr.select(free, 1.0, 0.0)
            dr.eval(total)
        return total * (1.0 / SKY_RAYS)

    def lit(self, points: Any, normals: Any, direction: Any, distance: Any) -> Any:
        """Return whether nothing stands between the samples and the light."""
        mi = mitsuba()
        ray = mi.Ray3f(self._offset(points, self._geometric), direction)
        ray.maxt = dr.minimum(distance, 1e8)
        return ~self.scene.ray_test(ray)


class MeshSurface(TracedMesh):
    """A proxy displaced along its normals, P' = P + A_d R(P) N_P (GD10 section 6), traced by Mitsuba.

    The scene is loaded once; `update` moves the vertices, and Mitsuba makes the vertex normals anew.
    """

    def __init__(
        self,
        proxy: Proxy,
        view: View,
        *,
        scale: float = 1.0,
        one_sided_sky: bool = False,
        bsdf: dict[str, Any] | None = None,
        emitters: dict[str, Any] | None = None,
    ) -> None:
        super().__init__(view, one_sided_sky=one_sided_sky, bsdf=bsdf, emitters=emitters)
        mi = mitsuba()
        self.proxy, self.scale = proxy, scale
        self._positions = mi.Point3f(np.ascontiguousarray(proxy.positions.T))
        self._normals = mi.Vector3f(np.ascontiguousarray(proxy.normals.T))
        self._domain = tuple(mi.Float(np.ascontiguousarray(proxy.domain[:, axis])) for axis in range(3))
        # Of the bare shape, in the frame of the domain: what stands upright on which coordinate plane.
        self._own_normals = tuple(mi.Float(np.ascontiguousarray(v)) for v in proxy.own_normals.T)
        self._parameters: Any = None

    def update(self, detail: AnyDetail) -> None:
        """Displace the mesh by the relief of ``detail``."""
        mi = mitsuba()
        relief, self.albedo = relief_and_albedo(
            detail, self._domain, self.scale, spacing=self.view.pixel, normals=self._own_normals
        )
        height = relief * dr.opaque(mi.Float, detail.relief.amplitude * self.scale)
        positions = dr.ravel(self._positions + height * self._normals)
        # Left unevaluated, the noise would be computed again by each consumer of the vertices.
        dr.eval(positions, self.albedo)
        if self._parameters is None:
            # Loaded with the first relief: a hierarchy over the bare proxy would be built for nothing.
            self._load(positions, self.proxy.faces, diffuse=self._diffuse(detail))
            self._parameters = mi.traverse(self.scene)
            self._key = next(key for key, _ in self._parameters if key.endswith("vertex_positions"))
        else:
            self._parameters[self._key] = positions
            self._parameters.update()


class VolumeSurface(TracedMesh):
    """The surface of solid matter that a volumetric detail makes, traced by Mitsuba, with normals from its density."""

    def __init__(
        self,
        texture: Hypertexture,
        surface: Isosurface,
        view: View,
        *,
        one_sided_sky: bool = False,
        bsdf: dict[str, Any] | None = None,
        emitters: dict[str, Any] | None = None,
    ) -> None:
        super().__init__(view, one_sided_sky=one_sided_sky, bsdf=bsdf, emitters=emitters)
        mi = mitsuba()
        points = tuple(mi.Float(np.ascontiguousarray(surface.vertices[:, axis])) for axis in range(3))
        detail = texture.detail
        normals = None
        if detail.colour is not None:
            own = surface.normals @ texture.shell.turn.astype(np.float32)
            normals = tuple(mi.Float(np.ascontiguousarray(own[:, axis])) for axis in range(3))
        _, self.albedo = relief_and_albedo(detail, texture.shell.own(points), texture.scale, spacing=view.pixel, normals=normals)
        dr.eval(self.albedo)
        self._load(mi.Float(surface.vertices.ravel()), surface.faces, mi.Float(surface.normals.ravel()), self._diffuse(detail))
