"""The marcher against closed forms, its order of convergence, and that it has neither grain nor second compilations."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from tests.unit.densities import Array, cloud, sampled, slab, sphere
from voldetail.backend import mitsuba
from voldetail.field.medium import Medium
from voldetail.fit.reflectance import solve
from voldetail.geometry.density_grid import DensityGrid
from voldetail.render import marched
from voldetail.render.marched import MarchedVolume
from voldetail.render.unit_components import Components, components
from voldetail.setup.lamp import Lamp
from voldetail.setup.view import View

VIEW = View(-1.1, 1.1, -1.1, 1.1, 48, 48)
MIDDLE = View(-0.2, 0.2, -0.2, 0.2, 8, 8)
OBLIQUE = Lamp(direction=(0.48, 0.36, 0.8))
PARTS = ("covered", "ambient", "diffuse", "specular")


def look(grid: DensityGrid, medium: Medium, lamp: Lamp = OBLIQUE, view: View = VIEW, **options: Any) -> Components:
    volume = MarchedVolume(view, step=options.pop("step", marched.STEP))
    volume.fill(grid, medium)
    return components(volume, lamp, **{"subsamples": 1, **options})


def phase(g: float, cosine: float) -> float:
    """Henyey and Greenstein's function times pi, for irradiances in units of pi."""
    return 0.25 * (1 - g * g) / (1 + g * g - 2 * g * cosine) ** 1.5


HEIGHTS: dict[str, tuple[Callable[[Array], Array], float]] = {
    # The density of the height, and its mean.
    "even": (lambda h: 0 * h + 1, 1.0),
    "half": (lambda h: 0 * h + 0.5, 0.5),
    "ramp": (lambda h: h, 0.5),
    "parabola": (lambda h: h * h, 1 / 3),
}


@pytest.mark.parametrize("name", HEIGHTS)
@pytest.mark.parametrize("extinction", [0.2, 2.0, 8.0])
def test_a_slab_lets_through_what_beer_and_lambert_say(name: str, extinction: float) -> None:
    """T = exp(-extinction mean thickness), thickness 1/2."""
    density, mean = HEIGHTS[name]
    covered = look(slab(density), Medium(extinction), view=MIDDLE).covered
    assert np.allclose(1 - covered, math.exp(-extinction * mean * 0.5), rtol=2e-3)


def test_a_way_at_an_angle_is_longer() -> None:
    """Through a perspective camera: T = exp(-extinction thickness / cos)."""
    view = View(-1.5, 1.5, -0.1, 0.1, 60, 4, distance=4.0, perspective=True)
    covered = look(slab(lambda h: 0 * h + 1), Medium(2.0), view=view).covered
    x, y = view.coordinates(1)
    secant = np.sqrt(1 + (x**2 + y**2) / 16).reshape(4, 60)
    assert np.allclose(1 - covered, np.exp(-2.0 * 0.5 * secant), rtol=2e-3)
    assert secant.max() > 1.06


@pytest.mark.parametrize("name", HEIGHTS)
@pytest.mark.parametrize("direction", [(0.0, 0.0, 1.0), (0.48, 0.36, 0.8), (0.0, 0.48, -0.877268)])
@pytest.mark.parametrize("g", [0.0, 0.6, -0.3])
def test_single_scattering_in_a_slab(name: str, direction: tuple[float, float, float], g: float) -> None:
    """D = pi p(cos) integral of exp(-tau) exp(-tau_light / |l_z|) dtau over the slab's depth tau from the viewer.

    From above tau_light = tau, and D = p (1 - exp(-k tau_all)) / k with k = 1 + 1 / l_z; from below tau_light =
    tau_all - tau, and D = p exp(-tau_all / m) (1 - exp(-tau_all (1 - 1 / m))) / (1 - 1 / m) with m = |l_z|. The density
    itself drops out. The light travels along -l and leaves along +z: cos = -l_z.
    """
    density, mean = HEIGHTS[name]
    extinction = 1.5
    depth, m = extinction * mean * 0.5, abs(direction[2])
    k = 1 + 1 / m if direction[2] > 0 else 1 - 1 / m
    wanted = phase(g, -direction[2]) * (1 - math.exp(-k * depth)) / k
    if direction[2] < 0:
        wanted *= math.exp(-depth / m)
    found = look(slab(density), Medium(extinction, g), Lamp(direction=direction), MIDDLE)
    assert np.allclose(found.diffuse, wanted, rtol=5e-3)
    assert not found.specular.any()


@pytest.mark.parametrize("medium", [Medium(4.0), Medium(4.0, 0.4), Medium(30.0)], ids=["shaded", "scattering", "dense"])
@pytest.mark.parametrize("perspective", [False, True])
def test_errors_fall_with_the_square_of_the_step(medium: Medium, perspective: bool) -> None:
    """Mean errors over means, from steps of 1/32 edge; the largest of the six cases, measured:

    step     covered   ambient   diffuse   specular
    2        0.0019    0.0139    0.0232    0.552
    1        0.0008    0.0073    0.0114    0.301
    1/2      0.0004    0.0009    0.0016    0.068
    1/4      0.0001    0.0003    0.0004    0.012
    1/8      0.00002   0.0001    0.0001    0.003
    """
    view = View(-1.1, 1.1, -1.1, 1.1, 32, 32, perspective=perspective)
    grid = cloud(24)
    truth = look(grid, medium, view=view, step=1 / 32)
    steps = (0.5, 0.25, 0.125)
    seen = [look(grid, medium, view=view, step=step) for step in steps]
    for part in PARTS:
        exact = getattr(truth, part)
        if not exact.any():
            continue
        errors = [float(np.abs(getattr(s, part) - exact).mean() / exact.mean()) for s in seen]
        assert errors[0] < (0.09 if part == "specular" else 0.003), (part, errors)
        if errors[-1] > 1e-5:  # rounding
            assert errors[0] / errors[2] > 2 ** (2 * 1.5), (part, errors)


def test_a_solid_has_no_rings_where_steps_meet_its_surface() -> None:
    """Fixed steps cut a hard surface in rings; at half a cell they are below what 8 bits show of a shaded ball.

    Largest differences in D from steps of 1/16, cells of optical thickness 4: at 1/4 0.0009, at 1/2 0.0037, at 1 0.018.
    """
    grid, medium, view = sphere(48), Medium(4.0 * 24), View(-1.0, 1.0, -1.0, 1.0, 48, 48, perspective=True)
    fine, usual, coarse = (look(grid, medium, view=view, step=step, subsamples=2) for step in (1 / 16, 0.5, 1.0))
    assert np.abs(usual.diffuse - fine.diffuse).max() < 0.007
    assert np.abs(coarse.diffuse - fine.diffuse).max() > 0.01


def test_skipping_empty_blocks_changes_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    # Single cells, some of which lie right behind an empty block.
    cells = np.random.default_rng(2).random((40, 40, 40)) < 0.001
    grid = sampled(lambda x, y, z: cells, (40, 40, 40), edge=2 / 40)
    for view in (VIEW, View(-1.1, 1.1, -1.1, 1.1, 48, 48, perspective=True)):
        skipped = look(grid, Medium(20.0), view=view)
        with monkeypatch.context() as patch:
            patch.setattr(marched.Emptiness, "ahead", lambda self, p, d: (mitsuba().Bool(False), mitsuba().Float(0.0)))
            walked = look(grid, Medium(20.0), view=view)
        for part in PARTS:
            assert np.allclose(getattr(skipped, part), getattr(walked, part), atol=1e-4), part


def test_rays_that_end_early_miss_less_than_the_cutoff(monkeypatch: pytest.MonkeyPatch) -> None:
    early = look(cloud(24), Medium(40.0))
    monkeypatch.setattr(marched, "CUTOFF", 1e-9)
    late = look(cloud(24), Medium(40.0))
    for part in PARTS:
        assert np.abs(getattr(early, part) - getattr(late, part)).max() < 2e-3 * getattr(late, part).max(), part


def test_a_picture_is_the_same_to_the_bit_whatever_was_seen_before() -> None:
    volume = MarchedVolume(VIEW)
    once, again = [], []
    for kept in (once, again):
        volume.fill(cloud(24), Medium(5.0))
        kept.append(components(volume, OBLIQUE))
        volume.fill(sphere(16), Medium(50.0, 0.3))
        components(volume, Lamp(position=(1.0, 1.0, 3.0)))
    for part in PARTS:
        assert np.array_equal(getattr(once[0], part), getattr(again[0], part)), part


def test_a_second_look_with_other_numbers_compiles_nothing() -> None:
    import drjit as dr

    volume = MarchedVolume(VIEW)

    def seen(extinction: float, asymmetry: float | None, cells: int, lamp: Lamp) -> None:
        volume.fill(cloud(cells), Medium(extinction, asymmetry))
        components(volume, lamp, shininess=(16.0 + extinction,))

    for asymmetry, other in ((None, None), (0.3, -0.2)):
        seen(5.0, asymmetry, 24, OBLIQUE)
        with dr.scoped_set_flag(dr.JitFlag.KernelHistory):
            dr.kernel_history_clear()
            seen(7.0, other, 28, Lamp(direction=(-0.6, 0.0, 0.8), strength=2.0))
            kernels = [entry for entry in dr.kernel_history() if entry["type"] == dr.KernelType.JIT]
        assert kernels
        # Not even read from the disk, where an earlier run of this test may have left it.
        assert all(kernel["cache_hit"] and not kernel["cache_disk"] for kernel in kernels)


def test_nothing_covers_nothing() -> None:
    seen = look(sampled(lambda x, y, z: 0 * x), Medium(5.0))
    assert all(not getattr(seen, part).any() for part in PARTS)


def test_the_reflectance_of_a_volume_is_solved_as_a_surface_s() -> None:
    seen = look(cloud(32), Medium(60.0))
    mask = seen.covered > 0.999
    assert mask.sum() > 400
    photo = seen.luminance(0.2, 0.6, 0.04, 16.0)
    found = solve(photo, seen, mask)
    assert (found.ambient, found.diffuse, found.specular) == pytest.approx((0.2, 0.6, 0.04), abs=0.02)
    medium = look(cloud(32), Medium(60.0, 0.3))
    found = solve(medium.luminance(0.7, 0.7, 0.0, 16.0), medium, mask)
    assert (found.ambient, found.diffuse, found.specular) == pytest.approx((0.7, 0.7, 0.0), abs=0.02)
