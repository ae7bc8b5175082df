"""The Phong plugin: Mitsuba's own chi-square test, reciprocity, energy, gradients."""

from types import ModuleType
from typing import Any

import numpy as np
import pytest

from voldetail.backend import mitsuba

mi: ModuleType = mitsuba()  # before Dr.Jit is imported, which would pick an LLVM of its own

import drjit as dr  # noqa: E402

from voldetail.render.plugins.phong import phong_dict, principled_equivalent, register  # noqa: E402

PLUGIN = register()


def phong(diffuse: float | list[float], specular: float, shininess: float) -> dict[str, Any]:
    r, g, b = np.broadcast_to(diffuse, 3).tolist()
    return phong_dict((r, g, b), specular, shininess)


def direction(elevation: float, azimuth: float = 20.0) -> Any:
    e, a = np.radians([elevation, azimuth])
    return mi.Vector3f(*map(float, (np.cos(e) * np.cos(a), np.cos(e) * np.sin(a), np.sin(e))))


def interaction(wi: Any) -> Any:
    si = dr.zeros(mi.SurfaceInteraction3f, dr.width(wi))
    si.wi = wi
    return si


def albedo(bsdf: Any, wi: Any, count: int = 1 << 20) -> np.ndarray:
    """Directional albedo, integrated on a grid of the hemisphere without the plugin's own sampling."""
    side = int(count**0.5)
    u = (
        mi.Float(np.tile(np.arange(side) + 0.5, side)) / side,
        mi.Float(np.repeat(np.arange(side) + 0.5, side)) / side,
    )
    wo = mi.warp.square_to_uniform_hemisphere(mi.Point2f(*u))
    value = bsdf.eval(mi.BSDFContext(), interaction(wi), wo)
    return np.array(dr.mean(value, axis=1)).ravel() * 2 * np.pi


def random_directions(count: int, seed: int, whole: bool = False) -> Any:
    rng = np.random.default_rng(seed)
    v = rng.normal(size=(3, count))
    v /= np.linalg.norm(v, axis=0)
    if not whole:
        v[2] = np.abs(v[2])
    return mi.Vector3f(v)


def test_register_twice_is_once() -> None:
    assert register() == register() == "voldetail_phong"


@pytest.mark.parametrize("elevation", [90.0, 45.0, 12.0])
@pytest.mark.parametrize(
    ("kd", "ks", "n"),
    [(0.5, 0.0, 10.0), (0.0, 0.7, 5.0), (0.5, 0.3, 1.0), (0.4, 0.5, 20.0), (0.2, 0.6, 150.0)],
)
def test_sampling_follows_its_density(kd: float, ks: float, n: float, elevation: float) -> None:
    sample, pdf = mi.chi2.BSDFAdapter(PLUGIN, phong(kd, ks, n), wi=direction(elevation))
    test = mi.chi2.ChiSquareTest(
        domain=mi.chi2.SphericalDomain(),
        sample_func=sample,
        pdf_func=pdf,
        sample_dim=3,
        sample_count=200_000,
        res=101,
        ires=16,
        seed=3,
    )
    assert test.run(quiet=True), test.messages


def test_a_wrong_density_would_be_noticed() -> None:
    sample, _ = mi.chi2.BSDFAdapter(PLUGIN, phong(0.4, 0.5, 20.0), wi=direction(45.0))
    _, pdf = mi.chi2.BSDFAdapter(PLUGIN, phong(0.4, 0.5, 22.0), wi=direction(45.0))
    test = mi.chi2.ChiSquareTest(mi.chi2.SphericalDomain(), sample, pdf, sample_dim=3, sample_count=200_000, ires=16)
    assert not test.run(quiet=True)


def test_values_are_the_equation() -> None:
    wi, wo = random_directions(5000, 1), random_directions(5000, 2)
    bsdf = mi.load_dict(phong([0.2, 0.4, 0.6], 0.3, 12.0))
    value = np.array(bsdf.eval(mi.BSDFContext(), interaction(wi), wo))
    a, b = np.array(wi, dtype=np.float64), np.array(wo, dtype=np.float64)
    cosine = np.clip((np.array([[-1], [-1], [1]]) * a * b).sum(0), 0, None)
    expected = np.array([[0.2], [0.4], [0.6]]) / np.pi + 0.3 * 14 / (2 * np.pi) * cosine**12
    assert value == pytest.approx(expected * b[2], abs=1e-5)


def test_reciprocal_and_black_below() -> None:
    wi, wo = random_directions(5000, 3), random_directions(5000, 4)
    bsdf = mi.load_dict(phong([0.2, 0.4, 0.6], 0.3, 12.0))
    there = np.array(bsdf.eval(mi.BSDFContext(), interaction(wi), wo)) / np.array(wo)[2]
    back = np.array(bsdf.eval(mi.BSDFContext(), interaction(wo), wi)) / np.array(wi)[2]
    assert there == pytest.approx(back, rel=1e-4, abs=1e-6)
    wi, wo = random_directions(5000, 5, whole=True), random_directions(5000, 6, whole=True)
    below = (np.array(wi)[2] <= 0) | (np.array(wo)[2] <= 0)
    value, pdf = bsdf.eval_pdf(mi.BSDFContext(), interaction(wi), wo)
    assert below.sum() > 3000
    assert (np.array(value)[:, below] == 0).all()
    assert (np.array(pdf)[below] == 0).all()
    assert (np.array(value)[:, ~below] > 0).all()


def test_the_parts_agree_with_each_other() -> None:
    wi, wo = random_directions(3000, 7), random_directions(3000, 8)
    bsdf, ctx, si = mi.load_dict(phong(0.4, 0.3, 8.0)), mi.BSDFContext(), interaction(wi)
    value, pdf = bsdf.eval_pdf(ctx, si, wo)
    assert dr.all(bsdf.eval(ctx, si, wo) == value, axis=None)
    assert dr.all(bsdf.pdf(ctx, si, wo) == pdf)
    rng = np.random.default_rng(9)
    u = mi.Point2f(rng.random((2, 3000)))
    sample, weight = bsdf.sample(ctx, si, mi.Float(rng.random(3000)), u)
    value, pdf = bsdf.eval_pdf(ctx, si, sample.wo)
    assert np.array(sample.pdf) == pytest.approx(np.array(pdf))
    expected = np.where(np.array(pdf) > 0, np.array(value) / np.maximum(np.array(pdf), 1e-30), 0)
    assert np.array(weight) == pytest.approx(expected, rel=1e-4, abs=1e-6)
    parts = []
    for component in (0, 1):
        ctx.component = component
        parts.append(np.array(bsdf.eval(ctx, si, wo)))
    assert sum(parts) == pytest.approx(np.array(bsdf.eval(mi.BSDFContext(), si, wo)), rel=1e-5)


@pytest.mark.parametrize("n", [0.0, 1.0, 10.0, 100.0])
def test_never_more_light_out_than_in(n: float) -> None:
    bsdf = mi.load_dict(phong(0.4, 0.6, n))
    albedos = [albedo(bsdf, direction(elevation))[0] for elevation in (90, 60, 30, 10, 2)]
    assert max(albedos) <= 1.0 + 1e-3
    assert albedos[0] == pytest.approx(1.0, abs=1e-3)  # Kd + Ks at normal incidence
    assert (np.diff(albedos) < 1e-3).all()  # darker towards grazing, as the model is known for


def test_albedo_of_each_lobe_in_closed_form() -> None:
    assert albedo(mi.load_dict(phong([0.1, 0.5, 0.9], 0.0, 5.0)), direction(90)) == pytest.approx([0.1, 0.5, 0.9], abs=1e-3)
    assert albedo(mi.load_dict(phong(0.0, 0.8, 30.0)), direction(90)) == pytest.approx([0.8] * 3, abs=1e-3)


@pytest.mark.parametrize("name", ["bsdf.diffuse.value", "bsdf.specular", "bsdf.shininess"])
def test_parameters_can_be_updated_and_differentiated(name: str) -> None:
    sphere = {"type": "sphere", "bsdf": {**phong([0.3, 0.4, 0.5], 0.4, 6.0), "id": "bsdf"}}
    scene = mi.load_dict({"type": "scene", "shape": sphere, "light": {"type": "constant"}})
    params = mi.traverse(scene)
    key = next(k for k, _ in params if k.endswith(name.removeprefix("bsdf.")))
    wi, wo = direction(50.0, 20.0), direction(40.0, 215.0)
    start = type(params[key])(params[key])

    def value(offset: Any) -> Any:
        params[key] = start + offset
        params.update()
        return dr.sum(scene.shapes()[0].bsdf().eval(mi.BSDFContext(), interaction(wi), wo), axis=None)

    high, low = (float(value(mi.Float(step))[0]) for step in (1e-2, -1e-2))
    assert high != low
    offset = mi.Float(0.0)
    dr.enable_grad(offset)
    dr.backward(value(offset))
    assert float(dr.grad(offset)[0]) == pytest.approx((high - low) / 2e-2, rel=1e-2)


def highlight(bsdf: Any, angle: float) -> float:
    """The reflectance at ``angle`` degrees from the normal, lit along the normal."""
    value = bsdf.eval(mi.BSDFContext(), interaction(direction(90)), direction(90 - angle))
    return float(value[0][0] / np.cos(np.radians(angle)))


@pytest.mark.parametrize("n", [5.0, 30.0, 200.0])
def test_the_principled_stand_in_comes_near(n: float) -> None:
    kd, ks = 0.4, 0.04
    stand_in, ours = mi.load_dict(principled_equivalent((kd, kd, kd), ks, n)), mi.load_dict(phong(kd, ks, n))
    assert albedo(stand_in, direction(90))[0] == pytest.approx(albedo(ours, direction(90))[0], abs=0.05)
    stand_in, ours = mi.load_dict(principled_equivalent((0, 0, 0), ks, n)), mi.load_dict(phong(0, ks, n))
    assert highlight(stand_in, 0) == pytest.approx(highlight(ours, 0), rel=0.02)
    # cos^n falls to a half at this angle, GGX at 0.77 of it.
    half = float(np.degrees(np.arccos(0.5 ** (1 / n))))
    assert highlight(ours, half) == pytest.approx(highlight(ours, 0) / 2, rel=1e-2)
    assert highlight(stand_in, 0.77 * half) == pytest.approx(highlight(stand_in, 0) / 2, rel=0.1)


def test_the_stand_in_stays_within_bounds() -> None:
    entry = principled_equivalent((0.1, 0.2, 0.3), 0.9, 0.0)
    assert (entry["specular"], entry["roughness"]) == (1.0, pytest.approx(0.5**0.5))
    assert entry["base_color"]["value"] == [0.1, 0.2, 0.3]
    mi.load_dict(entry)


@pytest.mark.parametrize("integrator", ["direct", "path"])
def test_a_white_room_shows_the_albedo(integrator: str) -> None:
    # Two materials, so that the renderer has to call the plugin through its dispatch.
    def square(x: float, bsdf: dict[str, Any]) -> dict[str, Any]:
        place = mi.ScalarTransform4f().translate([x, 0, 0])
        return {"type": "rectangle", "to_world": place, "bsdf": bsdf}

    scene = mi.load_dict(
        {
            "type": "scene",
            "integrator": {"type": integrator},
            "sensor": {
                "type": "orthographic",
                "to_world": mi.ScalarTransform4f().look_at([0, 0, 3], [0, 0, 0], [0, 1, 0]).scale(1.5),
                "film": {"type": "hdrfilm", "width": 16, "height": 16, "rfilter": {"type": "box"}},
            },
            "light": {"type": "constant"},
            "left": square(-1, phong([0.2, 0.4, 0.6], 0.3, 15.0)),
            "right": square(1, phong(0.1, 0.0, 5.0)),
        }
    )
    picture = np.array(mi.render(scene, spp=256, seed=1))
    sides = sorted((picture[4:12, 1:7].mean((0, 1)), picture[4:12, 9:15].mean((0, 1))), key=lambda side: side[0])
    assert sides[0] == pytest.approx([0.1] * 3, abs=2e-3)
    assert sides[1] == pytest.approx([0.5, 0.7, 0.9], abs=1e-2)
