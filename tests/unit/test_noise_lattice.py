"""The lattice of feature points: reference bits, exactness of the nearest ones, evaluation order."""

import itertools
from types import ModuleType
from typing import Any

import numpy as np
import pytest
from noise_reference import feature_points, hash_words
from scipy.spatial import cKDTree

from voldetail.backend import mitsuba

mi: ModuleType = mitsuba()  # before Dr.Jit is imported, which would pick an LLVM of its own

from voldetail.noise.lattice import (  # noqa: E402
    FOURTH_POINT_RADIUS,
    cell_hash,
    feature_point,
    nearest_points,
    search_table,
)

SALT = 20100504


def columns(x: np.ndarray) -> tuple[Any, ...]:
    return tuple(mi.Float(np.ascontiguousarray(x[:, axis])) for axis in range(x.shape[1]))


def nearest(x: np.ndarray, needed: int = 4) -> tuple[np.ndarray, np.ndarray]:
    """Distances (N, 4) and cells (N, 4, d) of the package's four nearest points."""
    distances, indices, around = nearest_points(columns(x), mi.UInt32(SALT), needed)
    offsets, _ = search_table(x.shape[1], FOURTH_POINT_RADIUS[x.shape[1]])
    own = np.stack([v.numpy() for v in around.own], -1)
    side = np.stack([v.numpy() for v in around.side], -1)
    table = offsets[:, : x.shape[1]]
    cells = own[:, None] + table[np.stack([i.numpy() for i in indices], -1)] * side[:, None]
    return np.stack([d.numpy() for d in distances], -1), cells


def check_against_tree(x: np.ndarray, workers: int = 2) -> None:
    """Compare all four ranks with a k-d tree over every cell that could matter."""
    x = x.astype(np.float32)
    low, high = np.floor(x.min(0)).astype(int) - 3, np.floor(x.max(0)).astype(int) + 4
    grids = np.meshgrid(*(np.arange(a, b) for a, b in zip(low, high, strict=True)), indexing="ij")
    cells = np.stack(grids, -1).reshape(-1, x.shape[1])
    # Relative to `low`, so that the tree's own arithmetic is exact far from the origin.
    tree = cKDTree(feature_points(cells, SALT)[0] - low)
    expected, found = tree.query(x.astype(np.float64) - low, k=5, workers=workers)
    distances, found_cells = nearest(x)
    assert np.abs(distances - expected[:, :4]).max() < 2e-6
    # Two points at the same distance to within rounding may trade ranks; nothing else may differ.
    gap = np.diff(expected, axis=1)
    tied = gap < 2e-6
    tied = np.concatenate([tied[:, :1], tied[:, 1:] | tied[:, :-1]], axis=1)
    same = (found_cells == cells[found[:, :4]]).all(-1)
    assert same[~tied].all()
    assert tied.mean() < 1e-3


def test_hash_words_are_these() -> None:
    # The literals come from this, in Python's own integers:
    #   def pcg4d(*v):
    #       M = 2**32
    #       v = [(c * 1664525 + 1013904223) % M for c in v]
    #       for again in (True, False):
    #           v[0] = (v[0] + v[1] * v[3]) % M; v[1] = (v[1] + v[2] * v[0]) % M
    #           v[2] = (v[2] + v[0] * v[1]) % M; v[3] = (v[3] + v[1] * v[2]) % M
    #           if again: v = [c ^ (c >> 16) for c in v]
    #       return v
    #   cells = (0, 0, 0, 0), (1, -2, 3, 7), (-100000, 99999, 0, 2**32 - 1)
    #   [pcg4d(*(c % 2**32 for c in cell)) for cell in cells]
    expected = [
        [251852841, 760645481, 850445371, 3542436074],
        [3632712099, 2030375249, 192093169, 1318283050],
        [913095719, 4117335261, 2467473902, 1496240377],
    ]
    cells = np.array([[0, 0, 0], [1, -2, 3], [-100000, 99999, 0]], np.int32)
    salts = np.array([0, 7, 2**32 - 1], np.uint32)
    words = cell_hash(*(mi.UInt32(cells[:, a].astype(np.uint32)) for a in range(3)), mi.UInt32(salts))
    assert np.stack([w.numpy() for w in words], -1).tolist() == expected
    for cell, salt, row in zip(cells, salts, expected, strict=True):
        assert hash_words(cell[None].astype(np.int64), int(salt))[0].tolist() == row


def test_points_lie_in_their_cells_uniformly() -> None:
    n = 50
    cells = np.array(list(itertools.product(range(-n, n), range(-n, n), range(4))), np.int32)
    position, _ = feature_point(tuple(mi.Int32(cells[:, a].copy()) for a in range(3)), mi.UInt32(SALT), 3, mi.Float)
    jitter = np.stack([p.numpy() for p in position], -1)
    assert jitter.min() >= 0.0
    assert jitter.max() < 1.0
    counts, _ = np.histogramdd(jitter, bins=4, range=[(0, 1)] * 3)
    expected = len(cells) / 64
    chi_square = ((counts - expected) ** 2 / expected).sum()
    assert chi_square < 103.4  # 99.9 % of chi-square with 63 degrees of freedom
    assert np.abs(np.corrcoef(jitter.T) - np.eye(3)).max() < 0.02
    neighbours = jitter.reshape(2 * n, 2 * n, 4, 3)
    assert abs(np.corrcoef(neighbours[1:].ravel(), neighbours[:-1].ravel())[0, 1]) < 0.02


@pytest.mark.parametrize(("dims", "side"), [(2, 300.0), (3, 40.0)])
def test_a_million_random_points_against_a_tree(dims: int, side: float) -> None:
    check_against_tree(np.random.default_rng(dims).uniform(-side / 2, side / 2, (1_000_000, dims)))


@pytest.mark.parametrize("dims", [2, 3])
@pytest.mark.parametrize("origin", [0, -40, 100_000, -100_000])
def test_corners_edges_centres_and_far_cells(dims: int, origin: int) -> None:
    nudges = (-1e-6, 0.0, 1e-6) if origin in (0, -40) else (0.0,)
    special = [base + nudge for base in (0.0, 0.25, 0.5, 0.7, 1.0) for nudge in nudges]
    local = np.array(list(itertools.product(special, repeat=dims)))
    cells = np.array(list(itertools.product(range(-2, 2), repeat=dims)))
    check_against_tree((local[:, None] + cells).reshape(-1, dims) + origin)


@pytest.mark.parametrize("needed", [1, 2, 3])
def test_fewer_ranks_are_still_exact(needed: int) -> None:
    x = np.random.default_rng(4).uniform(-20, 20, (50_000, 3)).astype(np.float32)
    assert np.array_equal(nearest(x, needed)[0][:, :needed], nearest(x)[0][:, :needed])


@pytest.mark.parametrize(("dims", "worst"), [(2, 1.3 * 2**0.5), (3, 3.5**0.5)])
def test_no_position_is_farther_from_its_fourth_point(dims: int, worst: float) -> None:
    # Points at the far corner of every cell: the fourth smallest of those distances is the worst there is.
    grid = np.linspace(0.5, 1.0, 11)
    x = np.stack(np.meshgrid(*[grid] * dims), -1).reshape(-1, 1, dims)
    low = np.array(list(itertools.product(range(-2, 3), repeat=dims)))
    far = np.linalg.norm(np.maximum(abs(x - low), abs(x - low - 1)), axis=-1)
    fourth = np.sort(far, axis=1)[:, 3].max()
    assert fourth == pytest.approx(worst, abs=1e-9)
    assert fourth < FOURTH_POINT_RADIUS[dims]


@pytest.mark.parametrize("dims", [2, 3])
@pytest.mark.parametrize("radius", [1.118, 1.8, 1.84, 1.88, 2.0])
def test_the_table_holds_every_cell_within_its_radius(dims: int, radius: float) -> None:
    grid = np.linspace(0.5, 1.0, 6)
    x = np.stack(np.meshgrid(*[grid] * dims), -1).reshape(-1, 1, dims)
    low = np.array(list(itertools.product(range(-4, 5), repeat=dims)))
    near = np.linalg.norm(np.maximum(np.maximum(low - x, x - low - 1), 0.0), axis=-1).min(0)
    offsets, bounds = search_table(dims, radius)
    listed = {tuple(row[:dims]): float(bound) for row, bound in zip(offsets.tolist(), bounds, strict=True)}
    for cell, distance in zip(map(tuple, low.tolist()), near, strict=True):
        if distance < radius - 1e-6:
            assert listed[cell] == pytest.approx(distance, abs=1e-6)
    assert (np.diff(bounds) >= 0).all()
