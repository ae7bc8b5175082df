"""The height field and the mesh are two ways to see one relief; and what both must show in closed form."""

import math
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from tests.system.scenes import SIDE, detail, setup
from voldetail.backend import mitsuba
from voldetail.detail import Detail
from voldetail.geometry.proxy import make_proxy, seen_part
from voldetail.metric import describe, distance
from voldetail.render import heightfield, mesh_surface
from voldetail.render.build import SHADOW_REACH, build
from voldetail.render.heightfield import HeightField
from voldetail.render.mesh_surface import MeshSurface
from voldetail.render.unit_components import Components, components
from voldetail.setup.camera import CameraSetup
from voldetail.setup.lamp import Lamp
from voldetail.setup.light import direction_of
from voldetail.setup.proxy import ProxySetup
from voldetail.setup.view import View

WAYS = [True, False]
NAMES = {True: "height field", False: "mesh"}
SHAPE, ZONE = (128, 160), (20, 40, 64, 64)  # off the middle of the photo, where a mistake in placing would show
LAMPS = {
    "high": Lamp(direction=direction_of(30, 45)),
    "low": Lamp(direction=direction_of(200, 15)),
    "flash": Lamp(position=(0.2, 0.1, 1.5), at_camera=True),
}
SHININESS = (4.0, 16.0, 64.0)
FLAT, RAISED = (0.0,) * 11, (1.0,) * 11

two_ways = pytest.mark.parametrize("fast", WAYS, ids=lambda fast: NAMES[fast])


def look(what: Detail, lamp: Lamp, fast: bool, subsamples: int = 2, **fields: Any) -> Components:
    seen = build(setup(domain=what.noise.domain, **fields), SHAPE, ZONE, fast=fast)
    assert isinstance(seen, HeightField if fast else MeshSurface)
    seen.update(what)
    return components(seen, lamp, subsamples=subsamples, shininess=SHININESS)


def apart(a: NDArray[np.float32], b: NDArray[np.float32]) -> float:
    """Return the mean difference in units of the mean."""
    return float(np.abs(a - b).mean() / b.mean())


# Measured at 96 pixels over seven details: the largest over the lamps, with a factor of 2 or so for the coarser grid.
# The height field interpolates normals between pixels, so its highlights are flatter where the relief is finest.
@pytest.mark.parametrize(
    ("values", "diffuse", "ambient", "broad"),
    [
        ({}, 0.01, 0.025, 0.04),
        ({"noise__octaves": 3}, 0.04, 0.03, 0.10),
        ({"noise__stripe_frequency": 1.0, "noise__stripe_spread": 1.0}, 0.03, 0.04, 0.07),
        ({"noise__domain": "surface"}, 0.01, 0.03, 0.03),
        ({"reflectance__height_albedo": 0.4, "reflectance__cell_albedo": 0.3}, 0.015, 0.025, 0.04),
    ],
    ids=["bumps", "octaves", "stripes", "surface", "pigment"],
)
def test_both_ways_show_the_same(values: dict[str, Any], diffuse: float, ambient: float, broad: float) -> None:
    what = detail(**values)
    for name, lamp in LAMPS.items():
        one, other = (look(what, lamp, fast, resolution=96) for fast in WAYS)
        assert one.covered.min() == other.covered.min() == 1.0
        assert apart(one.diffuse, other.diffuse) < diffuse, name
        assert np.corrcoef(one.diffuse.ravel(), other.diffuse.ravel())[0, 1] > 0.995, name
        assert apart(one.ambient, other.ambient) < ambient, name
        assert apart(one.specular[0], other.specular[0]) < broad, name
        for lobe in range(len(SHININESS)):
            assert np.corrcoef(one.specular[lobe].ravel(), other.specular[lobe].ravel())[0, 1] > 0.92, name


def test_a_moved_plane_takes_its_noise_along_both_ways() -> None:
    moved = {"proxy": ProxySetup(position=(0.3, -0.2, 0.1))}
    one, other = (look(detail(), LAMPS["high"], fast, **moved) for fast in WAYS)
    assert apart(one.diffuse, other.diffuse) < 0.02
    assert apart(one.diffuse, look(detail(), LAMPS["high"], True).diffuse) > 0.05


@two_ways
@pytest.mark.parametrize(("azimuth", "elevation"), [(0.0, 90.0), (75.0, 40.0), (250.0, 8.0)])
def test_a_flat_relief_in_closed_form(fast: bool, azimuth: float, elevation: float) -> None:
    lamp = Lamp(direction=direction_of(azimuth, elevation), strength=0.8)
    for curve in (FLAT, RAISED):
        seen = look(detail(noise__curve=curve), lamp, fast)
        sine = math.sin(math.radians(elevation))  # n . l, and the cosine between the view and the mirrored light
        assert seen.covered == pytest.approx(1.0)
        assert seen.ambient == pytest.approx(1.0, abs=1e-4)
        assert seen.diffuse == pytest.approx(0.8 * sine, rel=1e-4)
        for n, lobe in zip(seen.shininess, seen.specular, strict=True):
            assert lobe == pytest.approx(0.8 * (n + 2) / 2 * sine**n * sine, rel=1e-3, abs=1e-6)


@two_ways
def test_a_flat_relief_under_a_near_lamp_in_closed_form(fast: bool) -> None:
    lamp = Lamp(position=(-0.4, 0.1, 0.9), strength=1.3, at_camera=True)
    flat = look(detail(noise__curve=FLAT), lamp, fast, subsamples=1)
    view = build(setup(), SHAPE, ZONE).view
    x, y = view.coordinates(1)
    assert flat.diffuse.ravel() == pytest.approx(lamp.on_plane(x, y), rel=1e-4)
    # The view is along the light, so the mirrored light makes twice the angle to the normal with it.
    cosine = 0.9 / np.sqrt((x + 0.4) ** 2 + (y - 0.1) ** 2 + 0.9**2)
    mirrored = np.maximum(2 * cosine**2 - 1, 0)
    assert flat.specular[1].ravel() == pytest.approx(9 * mirrored**16 * flat.diffuse.ravel(), rel=2e-3, abs=1e-5)


@two_ways
def test_albedo_goes_with_height_and_grain(fast: bool) -> None:
    lamp = Lamp(direction=(0.0, 0.0, 1.0))
    for curve, factor in ((FLAT, 0.7), (RAISED, 1.3)):
        seen = look(detail(noise__curve=curve, reflectance__height_albedo=0.3), lamp, fast)
        assert seen.diffuse == pytest.approx(factor, rel=1e-4)
        assert seen.ambient == pytest.approx(factor, rel=1e-4)
        assert seen.specular[0] == pytest.approx(3.0, rel=1e-3)  # the highlight is not the pigment's
    grains = look(detail(noise__curve=FLAT, reflectance__cell_albedo=0.4, noise__scale=6.0), lamp, fast).diffuse
    assert grains.min() >= 0.6 - 1e-4
    assert grains.max() <= 1.4 + 1e-4
    assert grains.max() - grains.min() > 0.5
    flat_parts = np.abs(np.diff(grains, axis=1)) < 1e-5
    assert flat_parts.mean() > 0.6  # constant in each cell


@pytest.fixture
def step(monkeypatch: pytest.MonkeyPatch) -> None:
    """Relief 1 left of x = 0 and 0 right of it, instead of noise."""

    def relief(what: Detail, domain: tuple[Any, ...], scale: float = 1.0, **options: Any) -> Any:
        return mitsuba().Float(np.where(np.array(domain[0]) < 0, 1.0, 0.0).astype(np.float32)), None

    monkeypatch.setattr(heightfield, "relief_and_albedo", relief)
    monkeypatch.setattr(mesh_surface, "relief_and_albedo", relief)


@two_ways
@pytest.mark.parametrize("elevation", [20.0, 35.0, 50.0])
@pytest.mark.usefixtures("step")
def test_the_shadow_of_a_step_is_as_long_as_geometry_says(fast: bool, elevation: float) -> None:
    height = 0.15
    lamp = Lamp(direction=direction_of(180.0, elevation))  # from the left, over the step
    seen = build(setup(), (SIDE, SIDE), None, fast=fast)
    seen.update(detail(relief__amplitude=height))
    low = components(seen, lamp, subsamples=4).diffuse[:, SIDE // 2 + 1 :]
    level = math.sin(math.radians(elevation))
    assert low[:, -3:] == pytest.approx(level, rel=1e-3)
    dark = (1 - low / level).sum(axis=1) + 2  # in pixels; the step's own slope and the pixel at its foot counted
    expected = height / math.tan(math.radians(elevation)) / seen.view.pixel
    # The height field walks in steps of a pixel and may pass over the very edge: up to a pixel too short. The mesh's
    # vertices lie elsewhere than the pixels' corners: half a pixel. (Measured: -0.86 to 0.57.)
    assert dark == pytest.approx(expected, abs=1.0)
    away = components(seen, Lamp(direction=direction_of(0.0, elevation)), subsamples=2).diffuse
    assert away[:, SIDE // 2 + 2 :] == pytest.approx(level, rel=1e-3)  # lit from the right: no shadow


@two_ways
@pytest.mark.usefixtures("step")
def test_what_stands_behind_a_near_lamp_casts_no_shadow(fast: bool) -> None:
    # The lamp is lower than the step and on the low side, so the step is beyond it as seen from the right.
    lamp = Lamp(position=(0.3, 0.0, 0.05))
    seen = build(setup(), (SIDE, SIDE), None, fast=fast)
    seen.update(detail(relief__amplitude=0.15))
    x, y = seen.view.coordinates(1)
    right = (x > 0.4) & (np.abs(y) < 0.3)
    diffuse = components(seen, lamp, subsamples=1).diffuse.ravel()
    assert diffuse[right] == pytest.approx(lamp.on_plane(x, y)[right], rel=1e-3)


@two_ways
def test_twice_the_same(fast: bool) -> None:
    surfaces = [build(setup(), SHAPE, ZONE, fast=fast) for _ in range(2)]
    pictures = []
    for seen in surfaces:
        seen.update(detail(noise__scale=4.0))
        seen.update(detail())  # what was there before leaves no trace
        pictures.append(components(seen, LAMPS["low"]))
    one, other = pictures
    # The mesh's normals are summed by several threads in any order (measured: 6e-5); the height field's are not.
    tolerance = 0.0 if fast else 1e-3
    for name in ("ambient", "diffuse", "specular"):
        assert np.abs(getattr(one, name) - getattr(other, name)).max() <= tolerance


@two_ways
def test_there_is_no_grain_to_be_measured(fast: bool) -> None:
    seen = build(setup(), SHAPE, ZONE, fast=fast)
    seen.update(detail())
    counts = (1, 2, 3, 5)
    one, two, three, most = (
        components(seen, LAMPS["high"], subsamples=n, shininess=SHININESS).luminance(0.1, 0.5, 0.05, SHININESS[1]) for n in counts
    )
    like = describe(most, metric="published")
    floor = distance(like, describe(other_seed(seen), like=like))
    assert floor > 1.0
    # Measured: 0.04, 0.004 and 0.002 for the mesh, a tenth of that for the height field; another seed: 5.5 to 5.8.
    assert distance(like, describe(one, like=like)) < 0.05 * floor
    assert distance(like, describe(two, like=like)) < 0.01 * floor
    assert distance(like, describe(three, like=like)) < 0.01 * floor


def other_seed(seen: HeightField | MeshSurface) -> NDArray[np.float32]:
    seen.update(detail().model_copy(update={"seed": 5}))
    return components(seen, LAMPS["high"], shininess=SHININESS).luminance(0.1, 0.5, 0.05, SHININESS[1])


def test_every_ray_finds_a_closed_surface() -> None:
    # Rays through the edges and corners of triangles, where they are aligned with the pixels, must not slip through.
    for resolution in (64, 96, 100):
        seen = build(setup(resolution), SHAPE, ZONE, fast=False)
        seen.update(detail())
        for subsamples in (1, 2, 4):
            assert components(seen, LAMPS["high"], subsamples=subsamples, shininess=()).covered.min() == 1.0


def test_the_mesh_is_smooth_between_its_faces() -> None:
    # A coarse ball, seen large: flat faces would give some hundred values, smooth normals as many as pixels.
    seen = build(setup(proxy=ProxySetup(kind="sphere")), (SIDE, SIDE), None)
    assert isinstance(seen, MeshSurface)
    seen.update(detail(noise__curve=FLAT))
    view = seen.view
    close = View(-0.02, 0.02, -0.02, 0.02, 48, 48, view.distance)
    seen.view = close
    lit = components(seen, Lamp(direction=direction_of(0.0, 45.0)), subsamples=1)
    x, y = (v.reshape(48, 48) for v in close.coordinates(1))
    expected = (x + np.sqrt(1 - x**2 - y**2)) * math.sqrt(0.5)
    assert lit.diffuse == pytest.approx(expected, abs=2e-3)


def test_a_sphere_in_closed_form() -> None:
    seen = build(setup(proxy=ProxySetup(kind="sphere")), (96, 96), None)
    seen.update(detail(noise__curve=FLAT))
    direction = direction_of(60.0, 30.0)
    lit = components(seen, Lamp(direction=direction), subsamples=3)
    x, y = (v.reshape(SIDE, SIDE) for v in seen.view.coordinates(1))
    inside = np.hypot(x, y) < 0.93
    normal = np.stack([x, y, np.sqrt(np.maximum(1 - x**2 - y**2, 0))])
    expected = np.maximum(np.tensordot(direction, normal, 1), 0)
    assert np.abs(lit.diffuse - expected)[inside].mean() < 0.003
    assert lit.covered[inside].min() == 1.0
    assert lit.covered.mean() == pytest.approx(math.pi / 4, abs=0.005)
    assert lit.ambient[inside] == pytest.approx(1.0, abs=0.02)  # nothing hides the sky from a ball
    assert (lit.diffuse[np.hypot(x, y) > 1.05] == 0).all()


def test_a_perspective_camera_sees_a_flat_plane_alike() -> None:
    camera = CameraSetup(kind="perspective", field_of_view=50.0)
    tilted = setup(proxy=ProxySetup(kind="plane", size=(8.0, 8.0, 0.0), rotation=(0.0, 30.0, 0.0)), camera=camera)
    seen = build(tilted, (SIDE, SIDE), None)
    seen.update(detail(noise__curve=FLAT))
    lit = components(seen, Lamp(direction=(0.0, 0.0, 1.0)))
    assert lit.covered.min() == 1.0
    assert lit.diffuse == pytest.approx(math.cos(math.radians(30.0)), abs=1e-3)
    assert lit.ambient == pytest.approx(lit.ambient.mean(), abs=1e-3)


def test_heights_from_elsewhere_look_as_those_of_a_detail() -> None:
    raised, given = build(setup(), SHAPE, ZONE), build(setup(), SHAPE, ZONE)
    assert isinstance(raised, HeightField)
    assert isinstance(given, HeightField)
    raised.update(detail())
    given.update(detail(reflectance__cell_albedo=0.3))  # an albedo that the new heights must not keep
    given.raise_to(mitsuba().Float(np.asarray(raised.z)))
    for lamp in LAMPS.values():
        assert np.array_equal(components(given, lamp).diffuse, components(raised, lamp).diffuse)
        assert np.array_equal(components(given, lamp).ambient, components(raised, lamp).ambient)


def test_a_ramp_faces_away_from_where_it_rises() -> None:
    ramp = build(setup(), SHAPE, ZONE)
    assert isinstance(ramp, HeightField)
    ramp.raise_to(0.5 * ramp.x)  # to the right, by one half
    light = direction_of(180, 60)
    wanted = (-0.5 * light[0] + light[2]) / math.hypot(0.5, 1.0)
    assert components(ramp, Lamp(direction=light)).diffuse == pytest.approx(wanted, abs=1e-5)


@pytest.mark.parametrize("kind", ["sphere", "cylinder"])
def test_the_part_of_a_proxy_that_is_seen_looks_like_the_whole(kind: str) -> None:
    view = View(-0.1, 0.5, 0.1, 0.7, 64, 64)
    whole = make_proxy(ProxySetup(kind=kind), view.pixel)  # type: ignore[arg-type]
    part = seen_part(whole, view, SHADOW_REACH, convex=True)
    assert len(part.faces) < 0.4 * len(whole.faces)
    lamp, pictures = Lamp(direction=(0.6, 0.5, 0.62)), []
    for proxy in (whole, part):
        surface = MeshSurface(proxy, view)
        surface.update(detail(noise__scale=6.0, relief__amplitude=0.06))
        seen = components(surface, lamp, shininess=SHININESS)
        pictures.append(np.stack([seen.diffuse, seen.covered, seen.specular[0], seen.ambient]))
    assert pictures[1][:3] == pytest.approx(pictures[0][:3], abs=1e-3)
    # Of the sky, a few of each place's rays that passed behind what is seen met the rest.
    assert pictures[1][3] == pytest.approx(pictures[0][3], abs=0.05)
    assert pictures[1][3].mean() == pytest.approx(pictures[0][3].mean(), abs=0.003)
