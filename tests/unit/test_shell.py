"""The density of an object about its surface: distances, the grid and its cost."""

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

import drjit as dr  # noqa: E402

from voldetail.errors import InputError  # noqa: E402
from voldetail.field.shell import Shell, make_shell  # noqa: E402
from voldetail.field.shell_plan import DEFAULT_BUDGET, plan_shell  # noqa: E402
from voldetail.geometry import signed_distance  # noqa: E402
from voldetail.geometry.mesh_distance import mesh_distance, squared_distances, winding_numbers  # noqa: E402
from voldetail.geometry.primitives.primitive import primitive_of  # noqa: E402
from voldetail.setup.proxy import ProxySetup  # noqa: E402

RNG = np.random.default_rng(5)
POINTS = RNG.uniform(-1.6, 1.6, (4000, 3))


def columns(points: NDArray[Any]) -> tuple[Any, ...]:
    return tuple(mi.Float(np.ascontiguousarray(points[:, axis])) for axis in range(3))


def evaluated(distance: signed_distance.Distance, points: NDArray[Any] = POINTS) -> tuple[NDArray[Any], NDArray[Any]]:
    s, n = distance(columns(points))
    return s.numpy(), np.stack([v.numpy() for v in n], axis=1)


def shell_of(edge: float = 0.05, thickness: float = 0.2, amplitude: float = 0.0, **fields: Any) -> Shell:
    return make_shell(plan_shell(ProxySetup(**fields), edge, thickness, amplitude))


def saved(tmp_path: Path, mesh: trimesh.Trimesh, name: str = "mesh.ply") -> Path:
    mesh.export(tmp_path / name)
    return tmp_path / name


SHAPES: dict[str, signed_distance.Distance] = {
    "sphere": signed_distance.ellipsoid((0.9, 0.9, 0.9)),
    "ellipsoid": signed_distance.ellipsoid((1.0, 0.5, 0.3)),
    "flat": signed_distance.ellipsoid((1.0, 1.0, 0.05)),
    "box": signed_distance.box((1.0, 0.6, 0.4)),
    "cylinder": signed_distance.cylinder((0.7, 1.0, 0.7)),
    "oval": signed_distance.cylinder((0.9, 1.0, 0.5)),
    "torus": primitive_of(ProxySetup(kind="torus", size=(1.8, 1.8, 0.6))).distance(),
}


@pytest.mark.parametrize("name", SHAPES)
def test_the_closest_point_is_on_the_surface_and_the_direction_a_unit(name: str) -> None:
    s, n = evaluated(SHAPES[name])
    assert np.linalg.norm(n, axis=1) == pytest.approx(1.0, abs=1e-5)
    foot, _ = evaluated(SHAPES[name], POINTS - s[:, None] * n)
    assert np.abs(foot).max() < 3e-6


@pytest.mark.parametrize("name", SHAPES)
def test_a_distance_never_changes_faster_than_one_moves(name: str) -> None:
    other = RNG.permutation(POINTS)
    gap = np.abs(evaluated(SHAPES[name])[0] - evaluated(SHAPES[name], other)[0])
    assert (gap <= np.linalg.norm(POINTS - other, axis=1) + 1e-5).all()
    assert gap.max() > 0.5


def test_distances_to_a_torus_by_hand() -> None:
    # R = 0.6, r = 0.3. Over the tube's middle, in the hole's middle, beyond the rim along (3, 4, 0) / 5, inside the tube.
    points = np.array([[0.6, 0.0, 0.5], [0.0, 0.0, 0.8], [0.72, 0.96, 0.0], [0.0, -0.7, 0.0]])
    s, n = evaluated(SHAPES["torus"], points)
    assert s == pytest.approx([0.2, 0.7, 0.3, -0.2], abs=1e-6)
    assert n[2] == pytest.approx([0.6, 0.8, 0.0], abs=1e-6)


def test_distances_to_an_ellipsoid_are_those_of_an_optimiser() -> None:
    # from scipy.optimize import minimize
    # q = lambda a, b: np.array([np.cos(a) * np.cos(b), .5 * np.sin(a) * np.cos(b), .3 * np.sin(b)])
    # for p in ([.9, .4, .5], [.3, .1, .1], [-.2, 1.2, .0]):
    #     print(min(minimize(lambda t: np.linalg.norm(q(*t) - p), x0, tol=1e-14, method="Nelder-Mead").fun
    #               for x0 in np.random.default_rng(0).uniform(-3, 3, (20, 2))))
    points = np.array([[0.9, 0.4, 0.5], [0.3, 0.1, 0.1], [-0.2, 1.2, 0.0]])
    s, _ = evaluated(SHAPES["ellipsoid"], points)
    assert s == pytest.approx([0.4226472614, -0.1770143702, 0.7074197572], abs=2e-6)


@pytest.mark.parametrize("name", SHAPES)
def test_the_direction_is_the_slope_of_the_distance(name: str) -> None:
    s, n = evaluated(SHAPES[name])
    near = np.abs(s) < (0.02 if name == "flat" else 0.2)
    steps = np.eye(3) * 1e-3
    slope = np.stack([
        (evaluated(SHAPES[name], POINTS + d)[0] - evaluated(SHAPES[name], POINTS - d)[0]) / 2e-3 for d in steps
    ], axis=1)  # fmt: skip
    error = np.linalg.norm(slope - n, axis=1)[near]
    assert near.sum() > 20
    # Along the edges of a box, and where its sides are equally close, a difference is between two directions.
    assert np.quantile(error, 0.95) < 5e-3


def test_a_mesh_has_the_distances_of_the_shape_it_is_made_of() -> None:
    mesh, edge, shape = trimesh.creation.box((2.0, 1.2, 0.8)), 0.06, (22, 28, 42)
    lower = (-1.251, -0.843, -0.657)
    found = mesh_distance(np.asarray(mesh.vertices), np.asarray(mesh.faces), lower, shape, edge, (0.15, 0.2))
    z, y, x = np.meshgrid(*(np.arange(count) for count in shape), indexing="ij")
    middles = (np.stack([x, y, z], axis=-1).reshape(-1, 3) + 0.5) * edge + lower
    exact = np.clip(evaluated(signed_distance.box((1.0, 0.6, 0.4)), middles)[0], -0.15, 0.2)
    error = np.abs(found.ravel() - exact) / edge
    assert error.max() < 5e-3  # where the closest triangle was not among the candidates
    assert np.quantile(error, 0.99) < 1e-4


def test_distances_to_triangles_are_those_of_trimesh() -> None:
    corners, points, index = RNG.normal(size=(50, 3, 3)), RNG.normal(size=(300, 3)) * 2, RNG.integers(0, 50, (300, 4))
    found = np.sqrt(squared_distances(points, corners, index))
    for rank in range(4):
        closest = trimesh.triangles.closest_point(corners[index[:, rank]], points)
        assert found[:, rank] == pytest.approx(np.linalg.norm(points - closest, axis=1), abs=1e-5)


def test_bodies_that_overlap_are_one_and_a_hollow_is_outside() -> None:
    first, second = (trimesh.creation.icosphere(2, 4.0).apply_translation([x, 8.3, 8.1]) for x in (6.2, 10.4))
    hollow = trimesh.creation.icosphere(1, 1.5).apply_translation([5.2, 8.3, 8.1])
    hollow.invert()
    mesh = trimesh.util.concatenate([first, second, hollow])
    winding = winding_numbers(np.asarray(mesh.vertices), np.asarray(mesh.faces), (17, 17, 17))
    assert [int(winding[8, 8, x]) for x in (0, 3, 5, 8, 11, 16)] == [0, 1, 0, 2, 1, 0]


def test_columns_through_vertices_and_edges_count_once() -> None:
    # All vertices and edges on whole numbers, where the columns are.
    mesh = trimesh.creation.box((4.0, 4.0, 4.0)).subdivide().subdivide().apply_translation([4.0, 4.0, 4.0])
    winding = winding_numbers(np.asarray(mesh.vertices), np.asarray(mesh.faces), (9, 9, 9))
    assert (winding[3:6, 3:6, 3:6] == 1).all()
    assert set(np.unique(winding)) == {0, 1}
    assert winding[:2].sum() == 0
    assert winding[7:].sum() == 0


def test_interpolated_distances_are_linear_between_the_middles() -> None:
    shape, lower, edge = (4, 5, 6), (0.1, -0.2, 0.3), 0.25
    z, y, x = np.meshgrid(*(np.arange(count) for count in shape), indexing="ij")
    plane = 0.3 * ((x + 0.5) * edge + lower[0]) - 0.4 * ((y + 0.5) * edge + lower[1]) + 1.2 * ((z + 0.5) * edge + lower[2])
    inside = np.asarray(lower) + edge * RNG.uniform(1.6, 2.4, (200, 3))
    s, n = evaluated(signed_distance.gridded(mi.Float(plane.ravel()), shape, lower, edge), inside)
    assert s == pytest.approx(inside @ [0.3, -0.4, 1.2], abs=1e-5)
    assert n == pytest.approx(np.tile(np.array([0.3, -0.4, 1.2]) / 1.3, (200, 1)), abs=1e-4)


@pytest.mark.parametrize("kind", ["plane", "sphere", "ellipsoid", "box", "cylinder", "torus"])
def test_density_falls_from_one_to_zero_over_the_shell_and_is_half_on_the_surface(kind: str) -> None:
    shell = shell_of(kind=kind, rotation=(20, 30, 0), position=(0.1, 0.2, -0.3))
    grid = shell.bake()
    density, index = grid.array().ravel(), dr.arange(mi.UInt32, shell.plan.cells)
    own = shell.own(shell.middles(index))
    s = shell.distance(own)[0].numpy()
    member = np.broadcast_to(np.asarray(shell.within(own)), s.shape)
    assert density.min() == 0.0
    assert density.max() == 1.0
    assert (density[(s < -0.1001) & member] == 1.0).all()
    assert (density[(s > 0.1001) | ~member] == 0.0).all()
    order = np.argsort(s[member])
    assert (np.diff(density[member][order]) <= 1e-6).all()
    x = np.linspace(-0.2, 0.2, 401)
    profile, slope = shell.profile(mi.Float(x)).numpy(), shell.slope(mi.Float(x)).numpy()
    assert profile[200] == pytest.approx(0.5, abs=1e-6)
    assert np.gradient(profile, x) == pytest.approx(slope, abs=0.06)  # continuous: no step of the slope at the shell's ends
    assert np.abs(np.diff(slope)).max() < 0.16


def test_a_mesh_turned_and_moved_is_where_its_proxy_is(tmp_path: Path) -> None:
    path = saved(tmp_path, trimesh.creation.box((2.0, 1.2, 0.8)))
    place: dict[str, Any] = {"rotation": (20, 30, 40), "position": (0.1, 0.2, 0.3)}
    box = shell_of(kind="box", size=(2.0, 1.2, 0.8), **place)
    mesh = shell_of(kind="mesh", mesh=path, **place)
    points = columns(POINTS * 0.7)
    difference = mesh.density_at(points).numpy() - box.density_at(points).numpy()
    assert np.sqrt(np.mean(difference**2)) < 0.02  # the grid rounds the box's edges
    assert np.abs(difference).max() < 0.2


def test_the_plan_says_what_it_takes_before_it_does() -> None:
    plan = plan_shell(ProxySetup(kind="sphere"), 0.02, 0.06, 0.1)
    assert plan.shape == (115, 115, 115)  # ceil((2 + 2 (0.1 + 0.03 + 0.02)) / 0.02) = 115 of edge 0.02
    assert plan.cells == plan.shape[0] ** 3
    assert plan.sentence.startswith("115 x 115 x 115 cells of 0.02 scene units, ")
    assert plan.byte_count > 4 * plan.cells
    finer = plan_shell(ProxySetup(kind="sphere"), 0.01, 0.06, 0.1)
    assert finer.byte_count > plan.byte_count
    assert finer.seconds > 4 * plan.seconds


def test_a_second_bake_with_other_numbers_compiles_nothing() -> None:
    shell_of(kind="ellipsoid", size=(2.0, 1.4, 1.0)).bake()
    with dr.scoped_set_flag(dr.JitFlag.KernelHistory):
        dr.kernel_history_clear()
        shell_of(edge=0.06, thickness=0.3, kind="ellipsoid", size=(1.8, 1.5, 1.1), position=(0.1, 0.0, 0.2)).bake()
        kernels = [entry for entry in dr.kernel_history() if entry["type"] == dr.KernelType.JIT]
    assert kernels
    assert all(entry["cache_hit"] for entry in kernels)


@pytest.mark.parametrize(
    ("numbers", "words"),
    [
        ((0.0, 0.1, 0.0), "edge is 0; it has to be a length over 0"),
        ((float("nan"), 0.1, 0.0), "edge is nan"),
        ((0.05, 0.0, 0.0), "thickness is 0; it has to be a length over 0"),
        ((0.05, 0.1, -0.1), "amplitude is -0.1; it has to be 0 scene units or more"),
        ((0.05, 0.06, 0.0), "use a thickness of at least 0.1 or an edge of at most 0.03"),
        ((0.05, 2.0, 0.0), "as much as the sphere itself at its thinnest (2), so nothing of it would be solid"),
    ],
)
def test_bad_lengths_are_refused(numbers: tuple[float, float, float], words: str) -> None:
    with pytest.raises(InputError) as refused:
        plan_shell(ProxySetup(kind="sphere"), *numbers)
    assert words in str(refused.value)


def test_a_grid_beyond_the_budget_says_what_would_do() -> None:
    with pytest.raises(InputError) as refused:
        plan_shell(ProxySetup(kind="sphere"), 0.001, 0.05, 0.1)
    text = str(refused.value)
    assert f"more than the {DEFAULT_BUDGET / 2**20:.0f} MB allowed" in text
    edge = float(text.split("use an edge of at least ")[1].split(",")[0])
    budget = int(text.split("or allow ")[1].split(" MB")[0]) * 2**20
    assert plan_shell(ProxySetup(kind="sphere"), edge, 0.05, 0.1).byte_count <= DEFAULT_BUDGET
    assert plan_shell(ProxySetup(kind="sphere"), 0.001, 0.05, 0.1, budget).byte_count <= budget


def test_a_grid_beyond_all_budgets_is_refused_too() -> None:
    for edge in (1e-5, 1e-200):
        with pytest.raises(InputError, match=r"use an edge of at least 0\.00\d+, or allow \d+ MB"):
            plan_shell(ProxySetup(kind="sphere"), edge, 0.05)
    with pytest.raises(InputError, match=r"the program alone takes 191 MB, so allow more"):
        plan_shell(ProxySetup(kind="sphere"), 0.02, 0.05, budget=1000)


def test_an_open_mesh_is_refused(tmp_path: Path) -> None:
    box = trimesh.creation.box((1.0, 1.0, 1.0))
    box.update_faces(np.arange(len(box.faces)) > 1)
    with pytest.raises(InputError, match=r"is not closed, so it has no inside to fill: close its holes"):
        shell_of(kind="mesh", mesh=saved(tmp_path, box))


def test_a_mesh_thinner_than_the_shell_is_refused(tmp_path: Path) -> None:
    path = saved(tmp_path, trimesh.creation.box((2.0, 2.0, 0.2)))
    with pytest.raises(InputError, match=r"its deepest point on the grid is 0\.\d+ below the surface"):
        shell_of(edge=0.04, thickness=0.3, kind="mesh", mesh=path)
