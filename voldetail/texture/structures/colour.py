"""The colour of a two-tone structure at any point of a plane or a surface, on Dr.Jit arrays.

    colour(x) = decode((1 - s) zero + s one),      s = (s_a(R_-rotation x) - low) / (high - low), held in [0, 1]

(GKHF14 equations 2 and 3, see `detail.structure_texture`.) A structure is of the plane. On a surface without parameters it is
seen from three sides, s = sum_i w_i s(x_i) with the planes of `noise.triplanar` and w_i = n_i^8 / sum_j n_j^8: steeper weights
than a noise needs, since two structures blended are neither. Nothing is averaged over a pixel: the models' edges are a texel
wide, so a texel should not be less than a pixel.
"""

from __future__ import annotations

from math import cos, sin
from typing import Any

import drjit as dr

from voldetail.detail.structure_texture import StructureTexture
from voldetail.errors import InputError
from voldetail.noise.triplanar import PLANES
from voldetail.records.refusal import shown
from voldetail.texture.decoding import decoded
from voldetail.texture.structures.model import StructureModel
from voldetail.texture.structures.models import MODELS

SHARPNESS = 3
"""Doublings of the exponent of a normal's part: n^8."""


def checked_structure(texture: StructureTexture, where: str = "The structure") -> tuple[StructureModel, dict[str, float]]:
    """Return the model of a texture and all of its parameters. Raises InputError for an unknown model and for parameters that
    it has not or that are out of range."""
    model = MODELS.get(texture.model)
    if model is None:
        raise InputError(f"{where} is of the model {shown(texture.model)}, which is not known; use one of {', '.join(MODELS)}.")
    return model, model.checked(texture.parameters)


def structure_colour(
    texture: StructureTexture, points: tuple[Any, ...], normals: tuple[Any, ...] | None = None
) -> tuple[Any, Any, Any]:
    """Return the linear colour, three Dr.Jit floats in 0 to 1, at ``points`` in texels: 2 coordinates, or 3 on a surface.

    normals: of the surface at 3 coordinates; without them it is seen along z. Raises InputError as `checked_structure` does.
    """
    model, values = checked_structure(texture)
    c, s = cos(texture.rotation), sin(texture.rotation)
    low, high = texture.span

    def at(x: Any, y: Any) -> Any:
        own = model.evaluate(c * x + s * y, c * y - s * x, values, texture.seed)
        return dr.clip((own - low) * (1.0 / (high - low)), 0.0, 1.0)

    if len(points) == 2 or normals is None:
        share = at(points[0], points[1])
    else:
        weights = _weights(normals)
        share = sum(w * at(points[a], points[b]) for w, (a, b) in zip(weights, PLANES, strict=True))
    ends = zip(texture.zero, texture.one, strict=True)
    red, green, blue = (dr.clip(decoded(zero + share * (one - zero)), 0.0, 1.0) for zero, one in ends)
    return red, green, blue


def _weights(normals: tuple[Any, ...]) -> list[Any]:
    """Weights of the three planes, of sum 1; a normal of length 0 counts as (0, 0, 1)."""
    largest = dr.maximum(dr.maximum(dr.abs(normals[0]), dr.abs(normals[1])), dr.abs(normals[2]))
    flat = largest == 0.0
    # Divided by the largest part first: the eighth power of a short normal would underflow.
    parts = [dr.abs(n) / dr.select(flat, 1.0, largest) for n in normals]
    parts[2] = dr.select(flat, 1.0, parts[2])
    for _ in range(SHARPNESS):
        parts = [dr.square(part) for part in parts]
    total = sum(parts)
    return [part / total for part in parts]
