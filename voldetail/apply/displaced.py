"""The displaced shape itself, as triangles for other programs."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from voldetail.apply.onmesh import proxy_of
from voldetail.backend import mitsuba
from voldetail.detail import Detail
from voldetail.errors import InputError
from voldetail.field.relief import relief_at
from voldetail.geometry.proxy import make_proxy


def displaced_mesh(
    detail: Detail, shape: str | Path, *, edge: float, scale: float = 1.0, rotation: tuple[float, float, float] = (0.0, 0.0, 0.0)
) -> tuple[NDArray[np.float32], NDArray[np.uint32]]:
    """Return vertices (V, 3) and faces (F, 3) of ``shape`` displaced by ``detail``, P' = P + A_d R(P) N_P (GD10 section 6).

    edge: the longest that a triangle of the bare shape is, in scene units, in which all is. Raises InputError for a volume, which
    displaces nothing, and a shape that cannot be used.
    """
    if detail.mode != "displacement":
        raise InputError("The detail is a volume and displaces no surface; export it as densities, with the suffix .vol.")
    mi = mitsuba()
    bare = make_proxy(proxy_of(shape, rotation), edge, detail.noise.domain)
    domain = tuple(mi.Float(np.ascontiguousarray(bare.domain[:, axis])) for axis in range(3))
    height = relief_at(detail, domain, scale).numpy() * (detail.relief.amplitude * scale)
    return (bare.positions + height[:, None] * bare.normals).astype(np.float32), bare.faces
