"""Phong reflection as a Mitsuba BSDF plugin, ``voldetail_phong``: the local lighting model of GD10 section 6.

Modified Phong (Lewis, "Making Shaders More Physically Plausible", 1993; Lafortune and Willems, "Using the
Modified Phong Reflectance Model for Physically Based Rendering", 1994):

    f(wi, wo) = Kd / pi + Ks (n + 2) / (2 pi) max(0, cos alpha)^n        on the upper side, 0 below

    Kd     diffuse albedo, a colour or texture                 n       shininess, 0 or more
    Ks     specular albedo, reached at normal incidence        alpha   angle from wo to the mirrored wi

Reciprocal, and it reflects at most Kd + Ks. Sampled as Lafortune and Willems do: the diffuse lobe by the
cosine, the other by cos^n alpha about the mirror direction, with density (n + 1) / (2 pi) cos^n alpha.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import cache
from typing import Any

import drjit as dr

from voldetail.backend import mitsuba

PLUGIN = "voldetail_phong"
VERTEX_ALBEDO = "vertex_albedo"
"""Attribute of a mesh that holds its vertices' albedo."""

DIELECTRIC_SPECULAR = 0.08
"""Normal reflectance of Mitsuba's and Disney's `principled` at specular = 1 (Burley, 2012)."""

LOBE_FLOOR = 0.05
"""Least probability of either lobe that is not black: keeps weights bounded where one is much the darker."""


@cache
def register() -> str:
    """Make ``voldetail_phong`` known to Mitsuba, once, and return its name; call before a scene is loaded."""
    mi = mitsuba()
    mi.register_bsdf(PLUGIN, _plugin(mi))
    return PLUGIN


Diffuse = Sequence[float] | dict[str, Any]
"""A colour, or the Mitsuba dictionary of a texture."""


def vertex_diffuse() -> dict[str, Any]:
    """Return the Mitsuba dictionary of an albedo that a mesh's vertices carry."""
    return {"type": "mesh_attribute", "name": VERTEX_ALBEDO}


def _texture(diffuse: Diffuse) -> dict[str, Any]:
    return diffuse if isinstance(diffuse, dict) else {"type": "rgb", "value": [float(c) for c in diffuse]}


def phong_dict(diffuse: Diffuse, specular: float, shininess: float) -> dict[str, Any]:
    """Return the Mitsuba dictionary of the plugin, registered if it was not."""
    return {"type": register(), "diffuse": _texture(diffuse), "specular": float(specular), "shininess": float(shininess)}


def principled_equivalent(diffuse: Diffuse, specular: float, shininess: float) -> dict[str, Any]:
    """Return the Mitsuba dictionary of a `principled` BSDF that comes near Kd = ``diffuse``, Ks and n.

    Roughness: the peaks are made equal at normal incidence, where GGX has F D(0) / 4 = F / (4 pi alpha^2) and
    Phong Ks (n + 2) / (2 pi), so alpha = sqrt(1 / (2 n + 4)). For large n that is the usual sqrt(2 / (p + 2))
    of Walter et al., "Microfacet Models for Refraction through Rough Surfaces", 2007, section 5.2, with p = 4
    n, as the half vector turns half as fast as the mirror direction. `principled` squares its roughness, so
    roughness is sqrt(alpha). Specular: its lobe reflects F = 0.08 x specular at normal incidence, so specular
    = Ks / 0.08.

    Limits: Ks above 0.08 is cut there (a brighter dielectric does not exist, and a metal has no diffuse
    part). GGX is narrower at half height (0.77 of the angle) and has longer tails. Towards grazing angles
    `principled` brightens (Fresnel) where Phong darkens, and its diffuse part changes there with the
    roughness: the albedo of
    Kd = 0.4, Ks = 0.04 is the same at normal incidence, but 0.52 to 0.61 for 0.41 at 15 degrees of elevation.
    """
    alpha = math.sqrt(1.0 / (2.0 * shininess + 4.0))
    return {
        "type": "principled",
        "base_color": _texture(diffuse),
        "roughness": math.sqrt(alpha),
        "specular": min(max(specular / DIELECTRIC_SPECULAR, 0.0), 1.0),
    }


def _plugin(mi: Any) -> type:
    """Return the class; Mitsuba's own base class exists only once a variant is set."""

    class Phong(mi.BSDF):
        """Modified Phong; ``diffuse`` a spectrum or texture, ``specular`` and ``shininess`` floats."""

        def __init__(self, props: Any) -> None:
            super().__init__(props)
            self.diffuse = props.get_texture("diffuse", 0.5)
            self.specular = mi.Float(props.get("specular", 0.0))
            self.shininess = mi.Float(props.get("shininess", 10.0))
            front = mi.BSDFFlags.FrontSide
            diffuse, glossy = mi.BSDFFlags.DiffuseReflection | front, mi.BSDFFlags.GlossyReflection | front
            self.m_components = [diffuse, glossy]
            self.m_flags = diffuse | glossy

        def traverse(self, callback: Any) -> None:
            callback.put("diffuse", self.diffuse, mi.ParamFlags.Differentiable)
            callback.put("specular", self.specular, mi.ParamFlags.Differentiable)
            callback.put("shininess", self.shininess, mi.ParamFlags.Differentiable)

        def to_string(self) -> str:
            return f"Phong[diffuse={self.diffuse}, specular={self.specular}, shininess={self.shininess}]"

        def sample(self, ctx: Any, si: Any, sample1: Any, sample2: Any, active: Any = True) -> tuple[Any, Any]:
            chance, _ = self._chance_of_diffuse(ctx, si, active)
            take_diffuse = sample1 < chance
            lobe = mi.warp.square_to_cosine_hemisphere(sample2)
            # About the mirror direction: cos alpha = u^(1 / (n + 1)).
            cosine = dr.power(sample2.x, 1.0 / (self.shininess + 1.0))
            s, c = dr.sincos(2.0 * dr.pi * sample2.y)
            sine = dr.safe_sqrt(1.0 - cosine * cosine)
            glossy = mi.Frame3f(mi.reflect(si.wi)).to_world(mi.Vector3f(sine * c, sine * s, cosine))
            bs = mi.BSDFSample3f()
            bs.wo = dr.select(take_diffuse, lobe, glossy)
            bs.eta = 1.0
            bs.sampled_component = dr.select(take_diffuse, mi.UInt32(0), mi.UInt32(1))
            bs.sampled_type = dr.select(
                take_diffuse,
                mi.UInt32(int(mi.BSDFFlags.DiffuseReflection)),
                mi.UInt32(int(mi.BSDFFlags.GlossyReflection)),
            )
            bs.wo = dr.detach(bs.wo)
            value, bs.pdf = self.eval_pdf(ctx, si, bs.wo, active)
            bs.pdf = dr.detach(bs.pdf)
            valid = active & (bs.pdf > 0.0)
            return bs, dr.select(valid, value / bs.pdf, 0.0)

        def eval(self, ctx: Any, si: Any, wo: Any, active: Any = True) -> Any:
            return self.eval_pdf(ctx, si, wo, active)[0]

        def pdf(self, ctx: Any, si: Any, wo: Any, active: Any = True) -> Any:
            return self.eval_pdf(ctx, si, wo, active)[1]

        def eval_pdf(self, ctx: Any, si: Any, wo: Any, active: Any = True) -> tuple[Any, Any]:
            cos_i, cos_o = mi.Frame3f.cos_theta(si.wi), mi.Frame3f.cos_theta(wo)
            above = active & (cos_i > 0.0) & (cos_o > 0.0)
            with_diffuse, with_glossy = self._enabled(ctx)
            chance, albedo = self._chance_of_diffuse(ctx, si, above)
            n = self.shininess
            # 0^0 is 1 and its slope finite only away from zero, hence the floor; cos^n is 0 there for all n
            # of use.
            alpha = dr.maximum(dr.dot(mi.reflect(si.wi), wo), 0.0)
            lobe = dr.select(alpha > 0.0, dr.power(dr.maximum(alpha, 1e-6), n), 0.0)
            value = mi.Spectrum(0.0)
            density = mi.Float(0.0)
            if with_diffuse:
                value += albedo * dr.inv_pi
                density += chance * cos_o * dr.inv_pi
            if with_glossy:
                value += self.specular * (n + 2.0) * (0.5 * dr.inv_pi) * lobe
                density += (1.0 - chance) * (n + 1.0) * (0.5 * dr.inv_pi) * lobe
            return dr.select(above, value * cos_o, 0.0), dr.select(above, density, 0.0)

        def eval_diffuse_reflectance(self, si: Any, active: Any = True) -> Any:
            return self.diffuse.eval(si, active)

        def _enabled(self, ctx: Any) -> tuple[bool, bool]:
            return (
                ctx.is_enabled(mi.BSDFFlags.DiffuseReflection, 0),
                ctx.is_enabled(mi.BSDFFlags.GlossyReflection, 1),
            )

        def _chance_of_diffuse(self, ctx: Any, si: Any, active: Any) -> tuple[Any, Any]:
            """Return (probability of sampling the diffuse lobe, its albedo)."""
            albedo = self.diffuse.eval(si, active)
            with_diffuse, with_glossy = self._enabled(ctx)
            if not (with_diffuse and with_glossy):
                return mi.Float(1.0 if with_diffuse else 0.0), albedo
            kd, ks = dr.detach(dr.mean(albedo)), dr.detach(self.specular)
            chance = dr.clip(kd / dr.maximum(kd + ks, 1e-8), LOBE_FLOOR, 1.0 - LOBE_FLOOR)
            return dr.select(ks <= 0.0, 1.0, dr.select(kd <= 0.0, 0.0, chance)), albedo

    return Phong
