"""Hypertexture: an object's density shifted by the relief function, and its gradient."""

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

from voldetail.detail import Detail  # noqa: E402
from voldetail.errors import InputError  # noqa: E402
from voldetail.field.hypertexture import Hypertexture  # noqa: E402
from voldetail.field.relief import relief_at  # noqa: E402
from voldetail.field.shell import Shell, make_shell  # noqa: E402
from voldetail.field.shell_plan import plan_shell  # noqa: E402
from voldetail.setup.proxy import ProxySetup  # noqa: E402

RNG = np.random.default_rng(6)


def detail_of(amplitude: float = 0.1, **noise: Any) -> Detail:
    return Detail.model_validate({"noise": {"scale": 4.0, **noise}, "relief": {"amplitude": amplitude}})


def shell_of(edge: float = 0.05, thickness: float = 0.15, amplitude: float = 0.2, **fields: Any) -> Shell:
    return make_shell(plan_shell(ProxySetup(**fields), edge, thickness, amplitude))


def columns(points: NDArray[Any]) -> tuple[Any, ...]:
    return tuple(mi.Float(np.ascontiguousarray(points[:, axis])) for axis in range(3))


def rows(vector: tuple[Any, ...]) -> NDArray[Any]:
    return np.stack([v.numpy() for v in vector], axis=1).astype(np.float64)


def test_without_amplitude_the_density_is_the_objects_own() -> None:
    shell = shell_of(kind="ellipsoid")
    assert np.array_equal(Hypertexture(shell, detail_of(0.0)).bake().array(), shell.bake().array())


@pytest.mark.parametrize("kind", ["plane", "sphere", "cylinder"])
def test_density_is_in_range_and_relief_only_adds_matter(kind: str) -> None:
    shell = shell_of(kind=kind)
    before, after = shell.bake().array(), Hypertexture(shell, detail_of(), 1.0).bake().array()
    assert after.min() == 0.0
    assert after.max() == 1.0
    assert (after >= before - 1e-6).all()
    assert after.sum() > 1.02 * before.sum()
    higher = Hypertexture(shell, detail_of(0.2)).bake().array()
    assert (higher >= after - 1e-6).all()


def test_what_is_baked_is_what_is_evaluated() -> None:
    shell = shell_of(kind="box", rotation=(10, 20, 30), position=(0.3, 0.0, -0.2))
    texture = Hypertexture(shell, detail_of(), 2.0)
    points = shell.middles(dr.arange(mi.UInt32, shell.plan.cells))
    assert np.abs(texture.density_at(points).numpy() - texture.bake().array().ravel()).max() < 1e-5


def crossings(texture: Hypertexture, x: NDArray[Any], y: NDArray[Any], z: NDArray[Any]) -> NDArray[Any]:
    """The highest z at which the density passes the level, above each (x, y)."""
    points = np.stack([np.repeat(x, len(z)), np.repeat(y, len(z)), np.tile(z, len(x))], axis=1)
    density = texture.density_at(columns(points)).numpy().reshape(len(x), len(z))
    last = density.shape[1] - 1 - np.argmax(density[:, ::-1] >= texture.level, axis=1)
    here, above = density[np.arange(len(x)), last], density[np.arange(len(x)), last + 1]
    return np.asarray(z[last] + (here - texture.level) / (here - above) * (z[1] - z[0]))


@pytest.mark.parametrize("exponent", [1.0, 2.5])
def test_a_slab_is_the_height_field_to_first_order(exponent: float) -> None:
    # z = A R(x, y, z) and R(x, y, z) = R(x, y, 0) + z dR/dz: the surface is A R(x, y, 0), up to a share that falls with A.
    x, y = RNG.uniform(-0.9, 0.9, (2, 300))
    flat = columns(np.stack([x, y, np.zeros_like(x)], axis=1))
    errors = []
    for amplitude in (0.01, 0.0025):
        texture = Hypertexture(shell_of(kind="plane"), detail_of(amplitude, last_neighbour=50), exponent)
        field = amplitude * relief_at(texture.detail, flat).numpy()
        found = crossings(texture, x, y, np.linspace(-0.002, 0.014, 129))
        errors.append(np.abs(found - field) / amplitude)
        assert np.corrcoef(found, field)[0, 1] > 0.99
    assert np.median(errors[0]) < 0.05
    assert np.median(errors[1]) < 0.4 * np.median(errors[0])


def shifted(shell: Shell, detail: Detail, points: NDArray[Any]) -> NDArray[Any]:
    """GD10's P' = P + A R(P) G(P), G the normalised gradient of density, by numpy from the distance's differences."""
    step = 1e-3
    slope = np.stack([
        shell.distance(columns(points + d))[0].numpy() - shell.distance(columns(points - d))[0].numpy() for d in np.eye(3) * step
    ], axis=1)  # fmt: skip
    inwards = -slope / np.linalg.norm(slope, axis=1, keepdims=True)
    return points + detail.relief.amplitude * relief_at(detail, columns(points)).numpy()[:, None] * inwards


@pytest.mark.parametrize("kind", ["sphere", "ellipsoid", "cylinder", "mesh"])
def test_the_density_is_that_of_the_shifted_point(kind: str, tmp_path: Path) -> None:
    fields: dict[str, Any] = {"kind": kind}
    if kind == "mesh":
        trimesh.creation.icosphere(4).export(tmp_path / "ball.ply")
        fields["mesh"] = tmp_path / "ball.ply"
    shell, detail = shell_of(**fields), detail_of(0.1)
    points = RNG.uniform(-1.1, 1.1, (6000, 3))
    s = shell.distance(columns(points))[0].numpy()
    points = points[(s > -0.1) & (s < 0.2)]
    literal = shell.density_at(columns(shifted(shell, detail, points))).numpy()
    ours = Hypertexture(shell, detail).density_at(columns(points)).numpy()
    assert len(points) > 400
    # About a cylinder's rim some ways cross the middle between side and end: there the two differ, as they should.
    share, most = {"mesh": (0.99, 0.03), "cylinder": (0.9, 2e-3)}.get(kind, (0.99, 2e-3))
    assert np.quantile(np.abs(ours - literal), share) < most
    assert np.mean(literal) > np.mean(shell.density_at(columns(points)).numpy()) + 0.1


def test_a_part_thinner_than_the_shift_gets_no_holes() -> None:
    shell = shell_of(edge=0.02, thickness=0.05, amplitude=0.3, kind="box", size=(1.0, 1.0, 0.1))
    before, after = shell.bake().array(), Hypertexture(shell, detail_of(0.3)).bake().array()
    assert (after[before == 1.0] == 1.0).all()
    # The lookup at P' itself, for comparison: it comes out on the other side.
    middles = rows(shell.middles(dr.arange(mi.UInt32, shell.plan.cells)))[before.ravel() == 1.0]
    assert (shell.density_at(columns(shifted(shell, detail_of(0.3), middles))).numpy() == 0.0).mean() > 0.2


def test_the_share_of_matter_at_a_height_is_the_distribution_of_the_relief() -> None:
    # Where R > z / A there is matter, so its share at z is 1 - F_R(z / A): R from its own points, the density from the grid.
    amplitude, edge = 0.2, 0.02
    shell = shell_of(edge=edge, thickness=0.04, amplitude=amplitude, kind="plane", size=(3.0, 3.0, 0.0))
    texture = Hypertexture(shell, detail_of(amplitude, scale=12.0))
    grid = texture.bake()
    relief = relief_at(texture.detail, columns(np.random.default_rng(9).uniform(-40, 40, (40000, 3)))).numpy()
    heights = grid.lower[2] + (np.arange(grid.shape[0]) + 0.5) * edge
    solid = (grid.array() > texture.level).mean(axis=(1, 2))
    expected = np.array([(relief > z / amplitude).mean() if z > 0 else 1.0 for z in heights])
    assert 0.2 < expected[np.argmin(np.abs(heights - 0.1))] < 0.8
    assert np.abs(solid - expected).max() < 0.03  # some 1300 cells of the noise in each layer


@pytest.mark.parametrize(
    ("kind", "exponent", "noise"),
    [
        ("sphere", 1.0, {"last_neighbour": 50}),
        ("ellipsoid", 2.5, {"last_neighbour": 50, "envelope": "gaussian"}),
        ("box", 0.7, {"first_neighbour": 1, "last_neighbour": 2}),
        ("cylinder", 1.0, {"last_neighbour": 50, "stripe_frequency": 1.5, "stripe_spread": 1.0}),
    ],
)
def test_the_gradient_against_differences(kind: str, exponent: float, noise: dict[str, Any]) -> None:
    texture = Hypertexture(
        shell_of(kind=kind, rotation=(15, 40, 5), position=(0.2, 0.1, 0.0)), detail_of(0.1, octaves=1, **noise), exponent
    )
    points = RNG.uniform(-1.2, 1.2, (3000, 3))
    step = 2e-3
    differences = np.stack([
        (texture.density_at(columns(points + d)).numpy() - texture.density_at(columns(points - d)).numpy()) / (2 * step)
        for d in np.eye(3) * step
    ], axis=1)  # fmt: skip
    density = texture.density_at(columns(points)).numpy()
    inside = (density > 0.05) & (density < 0.95)
    gradient = rows(texture.gradient_at(columns(points)))
    assert inside.sum() > 150
    size = np.linalg.norm(differences, axis=1)
    error = np.linalg.norm(gradient - differences, axis=1) / (size + 0.1 * size[inside].mean())
    assert np.median(error[inside]) < 0.01
    assert np.quantile(error[inside], 0.9) < 0.1  # the noise has creases, a box has edges
    assert (gradient[(density == 0.0) | (density == 1.0)] == 0.0).all()
    # The same direction as the normal's, backwards.
    outward = rows(texture.outward_at(columns(points)))
    cosine = (gradient * outward).sum(axis=1)[inside] / np.linalg.norm(gradient, axis=1)[inside]
    assert cosine == pytest.approx(-np.linalg.norm(outward, axis=1)[inside], rel=1e-3)


def test_the_gradients_of_a_mesh_too(tmp_path: Path) -> None:
    trimesh.creation.icosphere(4).export(tmp_path / "ball.ply")
    place: dict[str, Any] = {"rotation": (15, 40, 5), "position": (0.2, 0.1, 0.0)}
    ball, exact = shell_of(kind="mesh", mesh=tmp_path / "ball.ply", **place), shell_of(kind="sphere", **place)
    detail = detail_of(0.1, last_neighbour=50)
    directions = RNG.normal(size=(500, 3))
    points = columns(directions / np.linalg.norm(directions, axis=1, keepdims=True) * 1.05 + [0.2, 0.1, 0.0])
    found, expected = (rows(Hypertexture(shell, detail).outward_at(points)) for shell in (ball, exact))
    cosine = (found * expected).sum(axis=1) / np.linalg.norm(found, axis=1) / np.linalg.norm(expected, axis=1)
    assert cosine.min() > np.cos(np.radians(2.0))


def test_a_second_bake_with_other_numbers_compiles_nothing() -> None:
    def compiled(number: int) -> int:
        shell = shell_of(edge=0.05 + 0.001 * number, thickness=0.2 + 0.01 * number, kind="sphere")
        texture = Hypertexture(shell, detail_of(0.1 + 0.01 * number, scale=4.0 + number), 1.5 + 0.1 * number, 1.0 + 0.1 * number)
        with dr.scoped_set_flag(dr.JitFlag.KernelHistory):
            dr.kernel_history_clear()
            texture.bake()
            kernels = [entry for entry in dr.kernel_history() if entry["type"] == dr.KernelType.JIT]
        assert len(kernels) >= 2
        return sum(not entry["cache_hit"] for entry in kernels)

    for number in range(2):
        compiled(number)
    assert min(compiled(number) for number in (2, 3)) == 0


def test_what_cannot_be_done_is_refused() -> None:
    shell = shell_of(kind="sphere", amplitude=0.1)
    with pytest.raises(InputError, match=r'noise.domain is "surface": set it to "solid"'):
        Hypertexture(shell, detail_of(0.1, domain="surface"))
    with pytest.raises(InputError, match=r"the shell was planned for 0.1: plan it for an amplitude of 0.2"):
        Hypertexture(shell, detail_of(0.1), scale=2.0)
    for exponent in (0.0, -1.0, float("inf")):
        with pytest.raises(InputError, match=r"exponent d_h of a hypertexture is .*; it has to be over 0"):
            Hypertexture(shell, detail_of(0.1), exponent)
