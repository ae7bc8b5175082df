"""The displaced shape itself, as triangles for other programs."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from voldetail.apply.onmesh import on_shape, proxy_of
from voldetail.backend import mitsuba
from voldetail.detail.photo_relief import AnyDetail, domain_of
from voldetail.errors import InputError
from voldetail.field.relief import relief_and_albedo
from voldetail.geometry.proxy import make_proxy


def displaced_mesh(
    detail: AnyDetail,
    shape: str | Path,
    *,
    edge: float,
    scale: float = 1.0,
    rotation: tuple[float, float, float] = (0.0, 0.0, 0.0),
) -> tuple[NDArray[np.float32], NDArray[np.uint32]]:
    """Return vertices (V, 3) and faces (F, 3) of ``shape`` displaced by ``detail``, P' = P + A_d R(P) N_P (GD10 section 6).

    edge: the longest that a triangle of the bare shape is, in scene units, in which all is. Raises InputError for a volume, which
    displaces nothing, and a shape that cannot be used.
    """
    if detail.mode != "displacement":
        raise InputError("The detail is a volume and displaces no surface; export it as densities, with the suffix .vol.")
    mi = mitsuba()
    proxy = proxy_of(shape, rotation)
    detail = on_shape(detail, proxy)
    bare = make_proxy(proxy, edge, domain_of(detail))
    domain = tuple(mi.Float(np.ascontiguousarray(bare.domain[:, axis])) for axis in range(3))
    normals = tuple(mi.Float(np.ascontiguousarray(v)) for v in bare.own_normals.T)
    relief, _ = relief_and_albedo(detail, domain, scale, spacing=edge, normals=normals)
    height = relief.numpy() * (detail.relief.amplitude * scale)
    return (bare.positions + height[:, None] * bare.normals).astype(np.float32), bare.faces
