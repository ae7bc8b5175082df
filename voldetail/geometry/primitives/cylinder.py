"""A cylinder about the y axis, the usual way a trunk or a column stands in a photo."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import trimesh

from voldetail.geometry import signed_distance
from voldetail.geometry.primitives.primitive import Floats, Primitive, Skeleton

SECTIONS = 96
"""Sides of the prism that is refined; points on its chords lie between cos(pi / SECTIONS) and 1 away from the axis."""

ON_CHORD = math.cos(math.pi / SECTIONS) * 0.999
BELOW_RIM = 1 - 1e-9


class Cylinder(Primitive):
    """A closed cylinder, its radii along x and z and its height those of its extent."""

    convex = True

    def skeleton(self) -> Skeleton:
        """Return a prism, its sides cut across so that its triangles are about as high as they are wide.

        Left as long as the cylinder is high, they would be split lengthwise all the same, and end as slivers.
        """
        shape = trimesh.creation.cylinder(radius=1.0, height=2.0, sections=SECTIONS)
        # trimesh's axis is z; ours is y.
        turned = shape.vertices[:, [0, 2, 1]] * np.array([1.0, 1.0, -1.0])
        shape = trimesh.Trimesh(turned * self.half, shape.faces, process=False)
        return Skeleton(*_cut_across(shape.vertices, shape.vertex_normals, shape.faces.astype(np.int64), self._rows()))

    def _rows(self) -> int:
        side = 2 * math.pi * math.sqrt(float(self.half[0] ** 2 + self.half[2] ** 2) / 2) / SECTIONS
        return max(1, round(self.extent[1] / side))

    def on_surface(self, positions: Floats, normals: Floats) -> tuple[Floats, Floats]:
        """Return points of the side put back on it, with its gradient; those of the ends keep theirs, (0, +-1, 0)."""
        half = self.half
        radial = positions[:, [0, 2]] / half[[0, 2]]
        radius = np.linalg.norm(radial, axis=1)
        side = (radius > ON_CHORD) & (np.abs(positions[:, 1]) < half[1] * BELOW_RIM)
        positions, normals = positions.copy(), normals.copy()
        positions[np.ix_(side, [0, 2])] = radial[side] / radius[side, None] * half[[0, 2]]
        normals[side] = 0.0
        normals[np.ix_(side, [0, 2])] = radial[side] / radius[side, None] / half[[0, 2]]
        end = ~side & (radius < ON_CHORD)
        normals[end] = np.sign(positions[end]) * (0.0, 1.0, 0.0)
        return positions, normals

    def parameters(self, positions: Floats, uv: Floats | None) -> Floats:
        """Return the way around, from the side that faces the viewer, and the height."""
        around = np.arctan2(positions[:, 0], positions[:, 2]) * self.extent[0] / 2
        return np.stack([around, positions[:, 1]], axis=1)

    def area(self) -> float:
        """Return that of the ends and of a side whose rim is at most that of the circle with the mean square radius."""
        w, h, d = self.extent
        return math.pi * (w * d / 2 + h * math.sqrt((w * w + d * d) / 2))

    def distance(self) -> signed_distance.Distance:
        """Return the distance to the cylinder."""
        return signed_distance.cylinder((float(self.half[0]), float(self.half[1]), float(self.half[2])))


def _cut_across(positions: Floats, normals: Floats, faces: np.ndarray, rows: int) -> tuple[Floats, Floats, np.ndarray]:
    """Return the prism with its upright sides cut into ``rows`` rings of quads; its ends stay as they are."""
    top, bottom = positions[:, 1].max(), positions[:, 1].min()
    upright = np.ptp(positions[faces][:, :, 1], axis=1) > 0
    lower = np.flatnonzero(positions[:, 1] == bottom)
    lower = lower[np.hypot(positions[lower, 0], positions[lower, 2]) > 0]
    rim = lower[np.argsort(np.arctan2(positions[lower, 0], positions[lower, 2]))]
    upper = np.flatnonzero(positions[:, 1] == top)
    # The vertex above each of the rim's.
    match = upper[[int(np.argmin(np.abs(positions[upper][:, [0, 2]] - positions[i, [0, 2]]).sum(axis=1))) for i in rim]]
    rings = [rim]
    for row in range(1, rows):
        share = row / rows
        rings.append(len(positions) + np.arange(len(rim)))
        positions = np.concatenate([positions, (1 - share) * positions[rim] + share * positions[match]])
        normals = np.concatenate([normals, (1 - share) * normals[rim] + share * normals[match]])
    rings.append(match)
    quads = []
    for below, above in pairwise(rings):
        right_below, right_above = np.roll(below, -1), np.roll(above, -1)
        quads += [np.stack([below, right_below, right_above], axis=1), np.stack([below, right_above, above], axis=1)]
    return positions, normals, np.concatenate([faces[~upright], *quads]).astype(np.int64)


PRIMITIVE = Cylinder
