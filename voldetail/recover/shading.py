"""The unit components of a recovered relief under the photo's light, by blocks, so that memory does not grow with the photo."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from voldetail.backend import mitsuba
from voldetail.render.heightfield import MARGIN, HeightField
from voldetail.render.unit_components import Components, components
from voldetail.setup.lamp import Lamp
from voldetail.setup.view import View

BLOCK = 1024
"""Pixels a side of a block: some 400 MB."""

REACH = 48
"""Pixels beyond a block from which relief may cast shadows into it."""

SHININESS = (8.0, 32.0, 128.0)
"""Exponents whose lobes are tried."""


@dataclass(frozen=True, eq=False)
class Shading:
    """ambient, diffuse (H, W), specular (K, H, W): the unit components A, D and S_n of GD10 section 7 for albedo 1."""

    ambient: NDArray[np.float32]
    diffuse: NDArray[np.float32]
    specular: NDArray[np.float32]


def shading_of(height: NDArray[np.float32], lamp: Lamp, view: View, shininess: tuple[float, ...] = SHININESS) -> Shading:
    """Return the unit components of ``height`` (H, W), in scene units at the pixels of ``view``, under ``lamp``."""
    rows, columns = height.shape
    ambient, diffuse = np.empty_like(height), np.empty_like(height)
    specular = np.empty((len(shininess), rows, columns), np.float32)
    for top in range(0, rows, BLOCK):
        for left in range(0, columns, BLOCK):
            bottom, right = min(top + BLOCK, rows), min(left + BLOCK, columns)
            # One block is the whole photo where it fits: nothing lies beyond.
            t, b = max(0, top - REACH), min(rows, bottom + REACH)
            first, end = max(0, left - REACH), min(columns, right + REACH)
            found = _block(height[t:b, first:end], lamp, _part(view, t, b, first, end), shininess)
            inner = slice(top - t, bottom - t), slice(left - first, right - first)
            part = slice(top, bottom), slice(left, right)
            ambient[part], diffuse[part] = found.ambient[inner], found.diffuse[inner]
            specular[(slice(None), *part)] = found.specular[(slice(None), *inner)]
    return Shading(ambient, diffuse, specular)


def _part(view: View, top: int, bottom: int, left: int, right: int) -> View:
    """Return the window of ``view`` between those rows and columns."""
    step = view.pixel
    return View(
        left=view.left + left * step, right=view.left + right * step, bottom=view.top - bottom * step,
        top=view.top - top * step, columns=right - left, rows=bottom - top,
    )  # fmt: skip


def _block(height: NDArray[np.float32], lamp: Lamp, view: View, shininess: tuple[float, ...]) -> Components:
    field = HeightField(view)
    # The field's vertices are the corners of pixels: each has the mean of the four about it, and the margin what is mirrored.
    around = np.pad(height, MARGIN + 1, mode="symmetric" if min(height.shape) > MARGIN else "edge")
    corners = 0.25 * (around[:-1, :-1] + around[1:, :-1] + around[:-1, 1:] + around[1:, 1:])
    corners = corners[1 : 1 + field.rows, 1 : 1 + field.columns]
    field.raise_to(mitsuba().Float(np.ascontiguousarray(corners, np.float32).ravel()))
    return components(field, lamp, subsamples=1, shininess=shininess)
