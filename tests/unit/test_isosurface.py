"""The surface of a density as a closed mesh."""

from __future__ import annotations

from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest
import trimesh
from numpy.typing import NDArray

from voldetail.backend import mitsuba

mi: ModuleType = mitsuba()  # before Dr.Jit is imported, which would pick an LLVM of its own

from voldetail.detail import Detail  # noqa: E402
from voldetail.errors import InputError  # noqa: E402
from voldetail.field.hypertexture import Hypertexture  # noqa: E402
from voldetail.field.shell import Shell, make_shell  # noqa: E402
from voldetail.field.shell_plan import plan_shell  # noqa: E402
from voldetail.geometry.density_grid import DensityGrid  # noqa: E402
from voldetail.geometry.isosurface import Isosurface, isosurface, surface_cost  # noqa: E402
from voldetail.setup.proxy import ProxySetup  # noqa: E402


def shell_of(edge: float = 0.05, amplitude: float = 0.0, **fields: Any) -> Shell:
    return make_shell(plan_shell(ProxySetup(**fields), edge, 3 * edge, amplitude))


def texture_of(edge: float, amplitude: float, scale: float = 4.0, **fields: Any) -> Hypertexture:
    detail = Detail.model_validate({"noise": {"scale": scale}, "relief": {"amplitude": amplitude}})
    return Hypertexture(shell_of(edge, amplitude, **fields), detail)


def grid_of(density: NDArray[Any]) -> DensityGrid:
    nz, ny, nx = density.shape
    return DensityGrid(mi.Float(density.astype(np.float32).ravel()), (nz, ny, nx), (1.0, 2.0, 3.0), 0.5)


def mesh_of(surface: Isosurface) -> trimesh.Trimesh:
    mesh = trimesh.Trimesh(surface.vertices, surface.faces, process=False)
    assert mesh.is_watertight
    assert mesh.is_winding_consistent
    assert mesh.area_faces.min() > 0
    assert len(np.unique(surface.vertices, axis=0)) == len(surface.vertices)
    assert len(np.unique(surface.faces)) == len(surface.vertices)
    assert np.linalg.norm(surface.normals, axis=1) == pytest.approx(1.0, abs=1e-5)
    assert (surface.vertices.dtype, surface.faces.dtype, surface.normals.dtype) == (np.float32, np.uint32, np.float32)
    return mesh


@pytest.mark.parametrize("kind", ["sphere", "ellipsoid", "box", "cylinder"])
def test_the_volume_is_the_shapes(kind: str) -> None:
    shell = shell_of(kind=kind, position=(0.3, -0.2, 0.1))
    w, h, d = shell.plan.proxy.extent
    share = {"sphere": np.pi / 6, "ellipsoid": np.pi / 6, "box": 1.0, "cylinder": np.pi / 4}[kind]
    mesh = mesh_of(isosurface(shell.bake()))
    assert mesh.volume == pytest.approx(share * w * h * d, rel=0.01)
    assert mesh.center_mass == pytest.approx((0.3, -0.2, 0.1), abs=0.01)


def test_a_spheres_normals_and_points() -> None:
    shell = shell_of(kind="sphere", position=(0.3, -0.2, 0.1))

    def outward(points: tuple[Any, ...]) -> tuple[Any, ...]:
        return shell.distance(shell.own(points))[1]

    # The density's own gradient, and the grid's differences, which a shell of three cells is thin for.
    for surface, most, mean in ((isosurface(shell.bake(), outward=outward), 0.05, 0.03), (isosurface(shell.bake()), 2.0, 1.0)):
        mesh_of(surface)
        radius = surface.vertices - np.array([0.3, -0.2, 0.1])
        assert np.linalg.norm(radius, axis=1) == pytest.approx(1.0, abs=0.1 * 0.05)  # a tenth of a cell
        cosine = (surface.normals * radius).sum(axis=1) / np.linalg.norm(radius, axis=1)
        degrees = np.degrees(np.arccos(np.clip(cosine, -1, 1)))
        assert degrees.max() < most
        assert degrees.mean() < mean


def test_a_level_of_the_profile_is_an_offset_of_the_surface() -> None:
    # d = 1 - 3 u^2 + 2 u^3 is 0.84375 at u = 0.25 and 0.15625 at u = 0.75: a quarter of the thickness below and above.
    shell = shell_of(edge=0.04, kind="sphere")
    for level, radius in ((0.84375, 1 - 0.03), (0.15625, 1 + 0.03)):
        vertices = isosurface(shell.bake(), level).vertices
        assert np.linalg.norm(vertices, axis=1).mean() == pytest.approx(radius, abs=0.003)


def test_a_hypertexture_is_closed_with_normals_along_its_gradient() -> None:
    texture = texture_of(0.03, 0.2, kind="sphere")
    surface = isosurface(texture.bake(), texture.level, texture.outward_at)
    mesh = mesh_of(surface)
    points = tuple(mi.Float(np.ascontiguousarray(surface.vertices[:, axis])) for axis in range(3))
    # The vertices are on the surface of the noise itself, within a part of a cell.
    height = np.abs(texture.height_at(points).numpy()) / 0.03
    assert np.median(height) < 0.1
    outward = np.stack([v.numpy() for v in texture.outward_at(points)], axis=1)
    outward /= np.linalg.norm(outward, axis=1, keepdims=True)
    assert np.abs(surface.normals - outward).max() < 1e-4
    assert np.median((surface.normals * mesh.vertex_normals).sum(axis=1)) > np.cos(np.radians(10.0))
    # Displacement could not do this: somewhere the surface faces the middle of the ball.
    radial = surface.vertices / np.linalg.norm(surface.vertices, axis=1, keepdims=True)
    assert ((surface.normals * radial).sum(axis=1) < -0.2).mean() > 0.01


def test_a_slab_is_closed_at_the_box_with_the_normals_of_the_cut() -> None:
    texture = texture_of(0.05, 0.1, kind="plane", size=(1.0, 1.0, 0.0))
    surface = isosurface(texture.bake(), texture.level, texture.outward_at)
    mesh = mesh_of(surface)
    grid = texture.bake()
    bottom = surface.vertices[:, 2] < grid.lower[2] + 0.2 * 0.05
    inner = bottom & (np.abs(surface.vertices[:, :2]) < 0.4).all(axis=1)
    assert inner.sum() > 100
    assert surface.normals[inner] == pytest.approx(np.tile([0, 0, -1], (inner.sum(), 1)), abs=1e-4)
    solid = float((grid.array() > 0.5).sum()) * 0.05**3
    assert mesh.volume == pytest.approx(solid, rel=0.05)
    assert (mesh.bounds[0] > np.array(grid.lower) - 0.5 * 0.05).all()
    assert (mesh.bounds[1] < np.array(grid.upper) + 0.5 * 0.05).all()


def test_a_mesh_comes_back(tmp_path: Path) -> None:
    torus = trimesh.creation.torus(0.7, 0.3, major_sections=64, minor_sections=32)
    torus.export(tmp_path / "torus.ply")
    torus = mesh_of(isosurface(shell_of(edge=0.04, kind="mesh", mesh=tmp_path / "torus.ply").bake()))
    assert torus.volume == pytest.approx(2 * np.pi**2 * 0.7 * 0.3**2, rel=0.02)
    assert torus.euler_number == 0  # one hole


def test_positions_are_those_of_the_grid() -> None:
    density = np.zeros((5, 6, 7))
    density[1:4, 2:4, 2:6] = 1.0
    mesh = mesh_of(isosurface(grid_of(density)))
    # Half way between the middles of a full cube and of an empty one: on the cubes' sides.
    assert mesh.bounds[0] == pytest.approx((1.0 + 2 * 0.5, 2.0 + 2 * 0.5, 3.0 + 1 * 0.5))
    assert mesh.bounds[1] == pytest.approx((1.0 + 6 * 0.5, 2.0 + 4 * 0.5, 3.0 + 4 * 0.5))
    assert mesh.volume > 0


def test_crumbs_and_bubbles_are_dropped_and_islands_kept() -> None:
    z, y, x = np.meshgrid(*(np.arange(40) + 0.5,) * 3, indexing="ij")

    def ball(cx: float, cy: float, cz: float, radius: float) -> NDArray[Any]:
        return np.clip(radius - np.sqrt((x - cx) ** 2 + (y - cy) ** 2 + (z - cz) ** 2) + 0.5, 0.0, 1.0)

    large, island, crumb, bubble = ball(14, 14, 14, 11), ball(32, 32, 32, 5), ball(33, 8, 8, 1.2), ball(14, 14, 14, 1.3)
    grid = grid_of(np.maximum(np.maximum(large, island), crumb) - bubble)
    assert [mesh_of(isosurface(grid, least_island=share)).body_count for share in (0.0, 0.01, 0.2)] == [4, 2, 1]
    assert [isosurface(grid, least_island=share).dropped for share in (0.0, 0.01, 0.2)] == [0, 2, 3]


def test_densities_at_the_level_leave_no_faces_without_area() -> None:
    density = np.zeros((6, 6, 6))
    density[2:4, 2:4, 2:4] = 1.0
    density[2:4, 2:4, 4] = 0.5
    density[1, 2, 2] = 0.5
    mesh_of(isosurface(grid_of(density)))


@pytest.mark.parametrize("values", ["a saddle", "0 and 1"])
def test_two_cubes_that_close_the_same_side_leave_it_open(values: str) -> None:
    # Marching cubes closes a side with a saddle from both of its cubes, with the same faces or across; found by search.
    density = np.array([
        [[0.2941, 0.9486, 0.9996], [0.1466, 0.8063, 0.4606]], [[0.5429, 0.3256, 0.8351], [0.9078, 0.1163, 0.1797]],
    ])  # fmt: skip
    if values == "0 and 1":
        density = (np.random.default_rng(3).random((20, 20, 20)) > 0.5).astype(np.float64)
    else:
        density = np.pad(density, 2)
    mesh_of(isosurface(grid_of(density), 0.5, least_island=0.0))


def test_noise_of_every_kind_is_closed() -> None:
    mesh_of(isosurface(grid_of(np.random.default_rng(8).random((20, 21, 22))), 0.5, least_island=0.0))


@pytest.mark.parametrize(
    ("level", "words"),
    [
        (0.0, "level of a surface is 0; it has to be over 0 and under 1"),
        (1.0, "level of a surface is 1; it"),
        (0.7, "no surface at the level 0.7: the densest point of the grid has 0.6; use a lower level"),
    ],
)
def test_what_has_no_surface_is_refused(level: float, words: str) -> None:
    with pytest.raises(InputError, match=words):
        isosurface(grid_of(np.full((3, 3, 3), 0.6)), level)


def test_the_cost_is_known_before_and_kept_to() -> None:
    grid = shell_of(kind="sphere").bake()
    count, byte_count = surface_cost(grid)
    # Ambiguous cubes get a vertex more in their middles.
    assert len(isosurface(grid, least_island=0.0).vertices) == pytest.approx(count, rel=0.03)
    with pytest.raises(InputError, match=rf"A surface of {count} vertices needs \d+ MB, more than the 1 MB allowed: bake"):
        isosurface(grid, budget=1 << 20)
    assert len(isosurface(grid, budget=byte_count).vertices)
