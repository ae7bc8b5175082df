"""Refined meshes: short edges, no cracks, the same surface."""

import numpy as np
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from voldetail.geometry.tessellate import split_long_edges
from voldetail.geometry.topology import crosses, edges, signed_volume

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
PLANE = (np.array([[-1.0, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]]), np.array([[0, 1, 2], [0, 2, 3]]))


def arrays(mesh: trimesh.Trimesh) -> tuple[Floats, Ints]:
    return np.asarray(mesh.vertices, dtype=np.float64), np.asarray(mesh.faces, dtype=np.int64)


CLOSED = {
    "box": arrays(trimesh.creation.box(extents=(2, 1, 0.3))),
    "ball": arrays(trimesh.creation.icosphere(subdivisions=1)),
    "thin cone": arrays(trimesh.creation.cone(radius=0.4, height=2.0, sections=7)),
    "ring": arrays(trimesh.creation.torus(1.0, 0.2, major_sections=9, minor_sections=5)),
}


def longest(points: Floats, faces: Ints) -> float:
    ends = points[faces]
    return float(np.linalg.norm(ends - np.roll(ends, 1, axis=1), axis=2).max())


def area(points: Floats, faces: Ints) -> float:
    return float(np.linalg.norm(crosses(points, faces), axis=1).sum() / 2)


@pytest.mark.parametrize("name", CLOSED)
@pytest.mark.parametrize("length", [0.5, 0.13, 0.05])
def test_closed_meshes_stay_closed_and_the_same(name: str, length: float) -> None:
    points, faces = CLOSED[name]
    assert edges(faces).closed
    fine, split = split_long_edges(points, faces, length)
    assert longest(fine, split) <= length
    assert edges(split).closed  # each edge joins exactly two faces, wound alike
    assert len(np.unique(split)) == len(fine)
    assert area(fine, split) == pytest.approx(area(points, faces), rel=1e-9)
    assert signed_volume(fine, split) == pytest.approx(signed_volume(points, faces), rel=1e-9)
    assert len(split) > len(faces)


@settings(max_examples=60, deadline=None, derandomize=True)
@given(st.integers(0, 2**32 - 1), st.floats(0.15, 1.5))
def test_any_bumpy_ball_stays_closed(seed: int, length: float) -> None:
    points, faces = CLOSED["ball"]
    points = points * np.random.default_rng(seed).uniform(0.3, 2.0, (len(points), 1))
    fine, split = split_long_edges(points, faces, length)
    assert longest(fine, split) <= length
    assert edges(split).closed
    assert area(fine, split) == pytest.approx(area(points, faces), rel=1e-9)


def test_every_edge_inside_a_plane_has_two_faces_and_the_border_stays_straight() -> None:
    fine, split = split_long_edges(*PLANE, 0.11)
    sides = edges(split).sides
    assert set(np.unique(sides)) == {1, 2}
    border = np.count_nonzero(sides == 1)
    assert border == pytest.approx(8 / longest_on_border(fine), rel=1e-9)
    assert len(fine) - len(sides) + len(split) == 1  # Euler: one disc
    assert area(fine, split) == pytest.approx(4.0)
    assert (crosses(fine, split)[:, 2] > 0).all()


def longest_on_border(points: Floats) -> float:
    bottom = np.sort(points[points[:, 1] == -1.0, 0])
    return float(np.diff(bottom).max())


def test_short_edges_are_left_alone() -> None:
    fine, split = split_long_edges(*PLANE, 3.0)
    assert fine is PLANE[0]
    assert (split == PLANE[1]).all()


def test_other_columns_follow_along_the_edges() -> None:
    points, faces = PLANE
    table = np.concatenate([points, points[:, :1] * 3 + points[:, 1:2] + 7], axis=1)
    fine, _ = split_long_edges(table, faces, 0.3)
    assert fine[:, 3] == pytest.approx(fine[:, 0] * 3 + fine[:, 1] + 7)


def test_the_limit_on_faces_is_kept() -> None:
    points, faces = CLOSED["ball"]
    fine, split = split_long_edges(points, faces, 0.001, limit=5000)
    assert 1000 < len(split) <= 5000
    assert edges(split).closed
    assert longest(fine, split) > 0.001
