"""The details that a photo's zone can show, neither finer than its pixels nor coarser than itself."""

from __future__ import annotations

import math

from voldetail.detail import bounds
from voldetail.errors import InputError
from voldetail.fit.ranges import MEDIUM_ROUGHNESS, ROUGHNESS, SOLID_ROUGHNESS
from voldetail.fit.space import Space
from voldetail.render.build import edge_of
from voldetail.results import Target
from voldetail.setup.setup import Setup
from voldetail.setup.view import view_of

SMALLEST_CELL = 3.0
"""Pixels a cell must span: smaller ones cannot be told from pixel noise."""

LARGEST_CELL = 0.6
"""Share of the zone that a cell may span: larger ones leave too few to have statistics."""

DEEPEST = 0.12
"""Share of the zone that a volume's relief may rise: what is deeper is seldom meant, and its grid takes minutes. Of clouds,
0.07 and 0.09 were found with more allowed."""

FINEST_OCTAVE = 1.6
"""Pixels a cell of the finest octave must span, near the sampling limit of the mesh's one vertex a pixel."""


def space_of(setup: Setup, target: Target) -> Space:
    """Return the space of details that the zone of ``target`` can show.

    Raises InputError for a zone so small a part of its photo that no detail is fine enough.
    """
    view = view_of(setup.camera, target.shape, target.zone, setup.photo.resolution)
    lowest, highest = bounds("noise.scale")
    # What shows no finer than a pixel, or than a cell of the grid that a volume is baked to.
    cell = edge_of(setup, view) if setup.mode == "volume" else 0.0
    grain = max(view.pixel, cell)
    shown = max(view.rows, view.columns) * view.pixel
    coarsest = max(1.0 / (LARGEST_CELL * shown), lowest)
    finest = min(1.0 / (SMALLEST_CELL * grain), highest)
    if not coarsest < finest:
        raise InputError(
            f"The zone of {target.zone[2]} x {target.zone[3]} pixels is too small a part of its photo of"
            f" {target.shape[1]} x {target.shape[0]}: crop the photo, or use a larger --zone."
        )
    return Space(
        domain=setup.domain,
        scale=(coarsest, finest),
        finest=1.0 / (FINEST_OCTAVE * grain),
        amplitude=setup.amplitude,
        plain=setup.fit.solver == "paper",
        mode=setup.mode,
        medium=setup.medium,
        roughness=MEDIUM_ROUGHNESS if setup.medium else SOLID_ROUGHNESS if setup.mode == "volume" else ROUGHNESS,
        highest=min(bounds("relief.amplitude")[1], shown * DEEPEST if setup.mode == "volume" else math.inf),
        cell=cell,
    )
