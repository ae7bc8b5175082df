"""The surface of a hypertexture by tiles: the same as that of the whole grid, closed, and in the memory of its surface."""

from __future__ import annotations

import itertools
import tracemalloc
from dataclasses import replace
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest
import trimesh
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from tests.unit.tiled_objects import OBJECTS, SMALL, ball, plan_of, texture_of
from voldetail.backend import mitsuba

mi: ModuleType = mitsuba()  # before Dr.Jit is imported, which would pick an LLVM of its own

import drjit as dr  # noqa: E402

from voldetail.errors import InputError, VoldetailError  # noqa: E402
from voldetail.field import tiled_surface  # noqa: E402
from voldetail.field.hypertexture import Hypertexture  # noqa: E402
from voldetail.field.shell_blocks import SIDE, near_blocks  # noqa: E402
from voldetail.field.shell_plan import BYTES_A_TILED_VERTEX, plan_shell  # noqa: E402
from voldetail.field.tiled_surface import tiled_isosurface  # noqa: E402
from voldetail.geometry.density_grid import DensityGrid  # noqa: E402
from voldetail.geometry.isosurface import Isosurface, isosurface  # noqa: E402
from voldetail.setup.proxy import ProxySetup  # noqa: E402


def whole(texture: Hypertexture) -> Isosurface:
    return isosurface(texture.bake(), texture.level, texture.outward_at)


def closed(surface: Isosurface) -> trimesh.Trimesh:
    mesh = trimesh.Trimesh(surface.vertices, surface.faces, process=False)
    assert mesh.is_watertight
    assert mesh.is_winding_consistent
    assert len(np.unique(surface.faces)) == len(surface.vertices)
    assert np.linalg.norm(surface.normals, axis=1) == pytest.approx(1.0, abs=1e-5)
    assert (surface.vertices.dtype, surface.faces.dtype, surface.normals.dtype) == (np.float32, np.uint32, np.float32)
    return mesh


def assert_same(found: Isosurface, expected: Isosurface, edge: float, cells: float = 1e-4) -> None:
    """As many vertices and faces, each vertex within ``cells`` of its own counterpart, with its normal."""
    first, second = closed(found), closed(expected)
    assert len(found.vertices) == len(expected.vertices)
    assert len(found.faces) == len(expected.faces)
    assert found.dropped == expected.dropped
    assert first.volume == pytest.approx(second.volume, rel=1e-5)
    distance, index = cKDTree(found.vertices).query(expected.vertices)
    assert distance.max() < cells * edge
    assert len(np.unique(index)) == len(index)
    cosine = (found.normals[index] * expected.normals).sum(axis=1)
    assert np.quantile(cosine, 0.999) > 1 - 1e-6  # noise has creases, and a box has edges, on which a vertex may lie
    assert np.mean(cosine < 0.999) < 1e-3


@pytest.mark.parametrize("name", OBJECTS)
def test_tiles_are_the_whole(name: str, tmp_path: Path) -> None:
    plan = plan_of(name, tmp_path)
    assert not plan.blocks
    texture = texture_of(plan)
    tiled = texture_of(plan_of(name, tmp_path, budget=SMALL, tiles=True))
    assert tiled.shell.plan.blocks > 3
    # The distances to a mesh are interpolated on the whole grid, and exact here.
    assert_same(tiled_isosurface(tiled), whole(texture), plan.edge, 2e-3 if name == "mesh" else 1e-4)


def test_a_level_an_exponent_and_crumbs_are_those_of_the_whole() -> None:
    texture = texture_of(plan_of("sphere", Path(), amplitude=0.2), 8.0, 2.5)
    grid = texture.bake()
    assert texture.level < 0.2
    assert_same(tiled_isosurface(texture), isosurface(grid, texture.level, texture.outward_at), 0.02)
    for least in (0.0, 0.5):
        found = tiled_isosurface(texture, 0.6, least_island=least)
        assert_same(found, isosurface(grid, 0.6, texture.outward_at, least_island=least), 0.02)
        assert (found.dropped > 0) == (least > 0)


@pytest.mark.parametrize("size", [(2.0, 2.0, 0.2), (0.2, 2.0, 2.0)])
@pytest.mark.parametrize("values", ["any", "0 and 1"])
def test_any_densities_are_joined(values: str, size: tuple[float, float, float], monkeypatch: pytest.MonkeyPatch) -> None:
    # Random: every case of marching cubes at the seams; of 0 and 1 alone: faces back to back in the cubes' sides.
    texture = texture_of(plan_shell(ProxySetup(kind="box", size=size), 0.03, 0.09))
    shape = texture.shell.plan.shape
    assert sorted(shape)[1] > SIDE + 2
    density = np.random.default_rng(4).random(shape, dtype=np.float32)
    if values == "0 and 1":
        density = (density > 0.5).astype(np.float32)
    padded = np.pad(density, (1, 2 * SIDE))

    def baked(texture: Hypertexture, blocks: NDArray[np.int64]) -> Any:
        for first in blocks.tolist():
            z, y, x = (slice(number + 1, number + 2 + SIDE) for number in first)
            yield tuple(first), texture, padded[z, y, x].copy()

    every = np.stack(np.meshgrid(*(np.arange(-1, n, SIDE) for n in shape), indexing="ij"), axis=-1).reshape(-1, 3)
    monkeypatch.setattr(tiled_surface, "_baked", baked)
    monkeypatch.setattr(tiled_surface, "near_blocks", lambda plan: every)
    grid = DensityGrid(mi.Float(density.ravel()), shape, texture.shell.plan.lower, texture.shell.plan.edge)
    found = tiled_isosurface(texture, 0.5, least_island=0.0)
    expected = isosurface(grid, 0.5, texture.outward_at, least_island=0.0)
    assert len(found.vertices) > 50_000
    assert_same(found, expected, texture.shell.plan.edge)


@pytest.mark.parametrize("name", OBJECTS)
def test_a_block_has_the_densities_of_the_whole_to_the_bit(name: str, tmp_path: Path) -> None:
    texture = texture_of(plan_of(name, tmp_path, 0.03))
    density = np.pad(texture.bake().array(), ((1, 40), (1, 40), (1, 40)))
    for first in ((-1, -1, -1), (3, 20, 17), tuple(n - 20 for n in texture.shell.plan.shape)):
        block = np.array(texture.bake_block(first, 33)).reshape(33, 33, 33)  # type: ignore[arg-type]
        z, y, x = (slice(number + 1, number + 34) for number in first)
        expected = density[z, y, x]
        assert np.array_equal(block[: expected.shape[0], : expected.shape[1], : expected.shape[2]], expected)


@pytest.mark.parametrize("name", OBJECTS)
def test_what_is_left_out_has_no_surface(name: str, tmp_path: Path) -> None:
    plan = plan_of(name, tmp_path, 0.012, 0.03)
    texture = texture_of(plan)
    padded = np.pad(texture.bake().array(), (1, SIDE))
    near = {tuple(first) for first in near_blocks(plan).tolist()}
    out = 0
    for first in np.ndindex(*(-(-(n + 1) // SIDE) for n in plan.shape)):
        start = tuple(number * SIDE - 1 for number in first)
        if start not in near:
            z, y, x = (slice(number + 1, number + 2 + SIDE) for number in start)
            assert np.ptp(padded[z, y, x]) == 0.0
            out += 1
    assert out or name == "slab"


def test_blocks_go_with_the_surface_and_not_with_the_volume() -> None:
    counts = [len(near_blocks(plan_of("sphere", Path(), 1.0 / n, 0.0, budget=1 << 50))) for n in (200, 400, 800)]
    # Of the volume it would be 8 times as many.
    assert [b / a < 5 for a, b in itertools.pairwise(counts)] == [True, True]
    assert counts[-1] > 500


def test_no_array_is_as_large_as_the_grid(monkeypatch: pytest.MonkeyPatch) -> None:
    texture = ball(0.01, amplitude=0.05)
    sizes = []
    bake = Hypertexture.bake_block

    def spied(self: Hypertexture, first: tuple[int, int, int], side: int, distance: Any = None) -> Any:
        sizes.append(side)
        return bake(self, first, side, distance)

    monkeypatch.setattr(Hypertexture, "bake_block", spied)
    tiled_isosurface(ball(0.05))  # what is loaded once is not counted
    tracemalloc.start()
    surface = tiled_isosurface(texture)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    block = 60 * (SIDE + 1) ** 3  # bytes for each of its middles: densities, normals and their copies
    assert peak < BYTES_A_TILED_VERTEX * len(surface.vertices) + block
    assert 3 * peak < 24 * texture.shell.plan.cells  # what the whole grid's surface takes for its cells alone
    assert set(sizes) == {SIDE + 1}


def test_other_blocks_and_other_numbers_compile_nothing(tmp_path: Path) -> None:
    for name in ("ellipsoid", "mesh"):
        first, second = (texture_of(plan_of(name, tmp_path, *numbers)) for numbers in ((0.03,), (0.025, 0.12)))
        for texture in (first, second):
            with dr.scoped_set_flag(dr.JitFlag.KernelHistory):
                dr.kernel_history_clear()
                baked = sum(1 for _ in tiled_surface._baked(texture, near_blocks(texture.shell.plan)))
                kernels = [entry for entry in dr.kernel_history() if entry["type"] == dr.KernelType.JIT]
        assert len(kernels) > baked > 4
        assert all(entry["cache_hit"] for entry in kernels)


def test_progress_is_told_block_by_block() -> None:
    texture, told = ball(), []
    tiled_isosurface(texture, on_progress=lambda done, total: told.append((done, total)))
    count = len(near_blocks(texture.shell.plan))
    assert told == [(done, count) for done in range(1, count + 1)]


def test_a_surface_that_outgrows_its_budget_is_refused_on_the_way() -> None:
    texture, told = ball(), []
    with pytest.raises(InputError, match=r"its surface has \d+ vertices, and needs more than the 200 MB allowed: use an edge"):
        tiled_isosurface(texture, on_progress=lambda done, total: told.append(done), budget=200 << 20)
    assert len(told) < len(near_blocks(texture.shell.plan))


@pytest.mark.parametrize(
    ("level", "words"), [(0.0, "level of a surface is 0; it has to be over 0"), (1.0, "level of a surface is 1; it")]
)
def test_levels_without_a_surface_are_refused(level: float, words: str) -> None:
    with pytest.raises(InputError, match=words):
        tiled_isosurface(ball(0.05), level)


def test_densities_below_the_level_are_refused() -> None:
    plan = plan_shell(ProxySetup(kind="box", size=(1.0, 1.0, 0.1)), 0.033, 0.099, 0.0)
    texture = texture_of(replace(plan, lower=(plan.lower[0], plan.lower[1], plan.lower[2] + 0.01)))
    densest = float(texture.bake().array().max())
    assert densest < 0.999
    with pytest.raises(InputError, match=rf"no surface at the level 0\.999: the densest point of the grid has {densest:.3g}"):
        tiled_isosurface(texture, 0.999)


def test_a_mesh_thinner_than_the_shell_is_refused(tmp_path: Path) -> None:
    trimesh.creation.box((2.0, 2.0, 0.1)).export(tmp_path / "sheet.ply")
    plan = plan_shell(ProxySetup(kind="mesh", mesh=tmp_path / "sheet.ply"), 0.04, 0.2, 0.05)
    with pytest.raises(InputError, match="so nothing of it would be solid"):
        tiled_isosurface(texture_of(replace(plan, blocks=1)))


def test_a_hole_is_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    texture = ball()
    every = near_blocks(texture.shell.plan)
    monkeypatch.setattr(tiled_surface, "near_blocks", lambda plan: every[1:])
    with pytest.raises(VoldetailError, match="a hole between two blocks"):
        tiled_isosurface(texture)
