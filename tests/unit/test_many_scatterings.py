"""All orders of scattering against what is known: thin, white, black; and that it has no grain and compiles once."""

import math
from itertools import pairwise
from typing import Any

import numpy as np
import pytest

from tests.unit.densities import cloud, sampled, slab
from tests.unit.test_marched import HEIGHTS, MIDDLE, OBLIQUE, VIEW, look
from voldetail.errors import InputError
from voldetail.field.medium import Medium
from voldetail.render.many_scatterings import Diffusion, of_a_half
from voldetail.render.marched import MarchedVolume
from voldetail.render.unit_components import components
from voldetail.setup.lamp import Lamp
from voldetail.setup.view import View


@pytest.mark.parametrize("g", [0.0, 0.6, -0.3])
@pytest.mark.parametrize("albedo", [0.3, 1.0])
@pytest.mark.parametrize("direction", [(0.48, 0.36, 0.8), (0.0, 0.48, -0.877268)])
def test_in_a_thin_medium_it_is_one_scattering_times_the_albedo(
    g: float, albedo: float, direction: tuple[float, float, float]
) -> None:
    """Optical thickness 0.002. Sideways a slab is thicker, so that its second order does not vanish as fast."""
    grid, lamp = slab(HEIGHTS["even"][0]), Lamp(direction=direction)
    once = look(grid, Medium(0.004, g), lamp, MIDDLE)
    many = look(grid, Medium(0.004, g, albedo), lamp, MIDDLE)
    assert np.allclose(many.diffuse, albedo * once.diffuse, rtol=0.01)
    assert np.allclose(many.ambient, albedo * once.ambient, rtol=0.01)
    assert once.diffuse.min() > 0


@pytest.mark.parametrize("extinction", [0.3, 3.0, 30.0])
@pytest.mark.parametrize("g", [0.0, 0.8, -0.4])
@pytest.mark.parametrize("perspective", [False, True])
def test_a_white_furnace_is_white(extinction: float, g: float, perspective: bool) -> None:
    """Albedo 1 under a sky of radiance 1: as bright as what is covered, whatever the density."""
    view = View(-1.0, 1.0, -1.0, 1.0, 24, 24, perspective=perspective)
    seen = look(cloud(24), Medium(extinction, g, 1.0), view=view)
    inside = seen.covered > 0.02
    assert inside.sum() > 50
    assert np.allclose(seen.ambient[inside], seen.covered[inside], rtol=0.02)


@pytest.mark.parametrize("g", [0.0, 0.7])
def test_what_the_box_cuts_is_white_in_a_white_furnace_too(g: float) -> None:
    assert np.allclose(look(slab(HEIGHTS["ramp"][0]), Medium(20.0, g, 1.0), view=MIDDLE).ambient, 1.0, atol=0.02)


@pytest.mark.parametrize("g", [0.0, 0.6, -0.3])
def test_a_black_medium_scatters_nothing(g: float) -> None:
    seen = look(cloud(24), Medium(6.0, g, 0.0))
    assert not seen.ambient.any()
    assert not seen.diffuse.any()
    assert seen.covered.max() > 0.9


@pytest.mark.parametrize("g", [0.0, 0.85])
def test_it_is_brighter_the_higher_the_albedo_and_much_brighter_than_one_scattering(g: float) -> None:
    pictures = [look(cloud(24), Medium(15.0, g, albedo)) for albedo in (0.2, 0.5, 0.8, 0.95, 1.0)]
    for part in ("ambient", "diffuse"):
        means = [float(getattr(p, part).mean()) for p in pictures]
        assert all(low < 0.95 * high for low, high in pairwise(means)), (part, means)
        assert means[-1] > 2 * float(getattr(look(cloud(24), Medium(15.0, g)), part).mean())


def test_the_far_side_of_a_thick_cloud_is_not_black() -> None:
    """One scattering behind optical thickness 12 is exp(-12) of the light; all of them, about one over it."""
    grid, behind = slab(HEIGHTS["even"][0]), Lamp(direction=(0.0, 0.6, -0.8))
    once = look(grid, Medium(24.0, 0.0), behind, MIDDLE).diffuse.mean()
    many = look(grid, Medium(24.0, 0.0, 1.0), behind, MIDDLE).diffuse.mean()
    assert once < 1e-3
    assert 0.02 < many < 0.2


def test_it_is_linear_in_the_light_and_the_same_to_the_bit_again() -> None:
    grid, medium = cloud(24), Medium(8.0, 0.5, 0.95)
    one, again = (look(grid, medium) for _ in range(2))
    twice = look(grid, medium, Lamp(direction=OBLIQUE.direction, strength=2.0))
    assert np.array_equal(one.diffuse, again.diffuse)
    assert np.array_equal(one.ambient, again.ambient)
    assert np.allclose(twice.diffuse, 2 * one.diffuse, rtol=1e-4)


def test_a_lamp_far_away_is_a_distant_one() -> None:
    direction = np.array([0.48, 0.36, 0.8])
    x, y, z = 400 * direction
    # Strength is on the plane that faces the light at its foot: see Lamp.
    near = Lamp(position=(x, y, z), strength=1 / 0.8**2)
    one, other = (look(cloud(24), Medium(8.0, 0.5, 0.95), lamp).diffuse for lamp in (OBLIQUE, near))
    assert np.allclose(one, other, rtol=0.02, atol=1e-4)


def test_half_a_sky_gives_less_than_all_of_it_even_if_the_medium_is_white() -> None:
    def seen(one_sided: bool) -> float:
        volume = MarchedVolume(MIDDLE, one_sided_sky=one_sided)
        volume.fill(slab(HEIGHTS["even"][0]), Medium(4.0, 0.0, 1.0))
        return float((lambda c: c.ambient / c.covered)(components(volume, OBLIQUE)).mean())

    assert seen(False) == pytest.approx(1.0, abs=0.02)
    assert 0.5 < seen(True) < 0.9


def test_a_second_look_with_other_numbers_compiles_nothing() -> None:
    import drjit as dr

    volume = MarchedVolume(VIEW)

    def seen(extinction: float, asymmetry: float, albedo: float, cells: int, lamp: Lamp) -> None:
        volume.fill(cloud(cells), Medium(extinction, asymmetry, albedo))
        components(volume, lamp, shininess=(16.0 + extinction,))

    seen(5.0, 0.3, 0.9, 24, OBLIQUE)
    with dr.scoped_set_flag(dr.JitFlag.KernelHistory):
        dr.kernel_history_clear()
        for numbers in ((7.0, -0.2, 0.8, 28), (11.0, 0.0, 1.0, 27), (3.0, 0.85, 0.0, 33)):
            seen(*numbers, Lamp(direction=(-0.6, 0.0, 0.8), strength=2.0))
        kernels = [entry for entry in dr.kernel_history() if entry["type"] == dr.KernelType.JIT]
    assert kernels
    # Not even read from the disk, where an earlier run of this test may have left it.
    assert all(kernel["cache_hit"] and not kernel["cache_disk"] for kernel in kernels)


def test_the_diffusion_between_two_faces_is_the_closed_form() -> None:
    """Lost sigma f = D f'' beside a source at one end of a rod: f falls as cosh((L - x) / l), l^2 = D / (lost sigma)."""
    n, edge, sigma, lost = 64, 0.05, 40.0, 5e-4
    diffusion = Diffusion(np.full(n, sigma, np.float32), np.full(n, lost, np.float32), (n, 1, 1), edge)
    source = np.zeros(n, np.float32)
    source[0] = 1.0
    found = diffusion.solve(source)
    way = math.sqrt(1 / (3 * sigma) / (sigma * lost))
    x = (np.arange(n) + 0.5) * edge
    wanted = np.cosh((n * edge - x) / way)
    assert np.allclose(found[2:] / found[2], wanted[2:] / wanted[2], atol=0.02)
    assert float((sigma * lost * found).sum()) == pytest.approx(1.0, rel=0.02)


@pytest.mark.parametrize("g", [0.0, 0.3, 0.85, -0.6])
def test_the_light_of_half_of_all_directions_is_turned_as_integrated(g: float) -> None:
    cosine = (np.arange(20000) + 0.5) / 20000
    ahead = float((0.5 * (1 - g * g) / (1 + g * g - 2 * g * cosine) ** 1.5).mean())
    assert 0.5 + 0.75 * of_a_half(g) == pytest.approx(ahead, abs=1e-4)


@pytest.mark.parametrize(
    ("given", "named"),
    [({"albedo": 1.2}, "from 0 to 1"), ({"albedo": -0.1}, "from 0 to 1"), ({"albedo": math.nan}, "from 0 to 1"),
     ({"albedo": 0.5, "asymmetry": None}, "an asymmetry too")],
)  # fmt: skip
def test_an_albedo_that_cannot_be_is_refused(given: dict[str, Any], named: str) -> None:
    with pytest.raises(InputError, match=named):
        Medium(**{"extinction": 1.0, "asymmetry": 0.0, **given})


def test_an_empty_grid_is_not_seen() -> None:
    seen = look(sampled(lambda x, y, z: 0 * x), Medium(5.0, 0.3, 0.9))
    assert not seen.covered.any()
    assert not seen.ambient.any()
