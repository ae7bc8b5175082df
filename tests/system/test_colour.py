"""The colour of a detail: on every shape, lit and path-traced, in a fit, and as a texture of Mitsuba's."""

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter

from tests.system.scenes import detail, setup
from voldetail.apply import relight, render
from voldetail.backend import mitsuba
from voldetail.detail import (
    ColourChannel,
    ColourTexture,
    Detail,
    DetailColour,
    detail_from,
    detail_from_text,
    detail_to_text,
    load_detail,
    with_values,
)
from voldetail.errors import InputError
from voldetail.fit import FitResult, fit
from voldetail.fit.colour import PENALTIES
from voldetail.image import Photo, luminance, save_image
from voldetail.render.build import build
from voldetail.render.plugins.colour import colour_dict
from voldetail.render.unit_components import components
from voldetail.setup.fit_settings import FitSettings
from voldetail.setup.lamp import Lamp
from voldetail.setup.light import Light, lamp_of
from voldetail.setup.photo import PhotoSetup
from voldetail.setup.setup import Setup
from voldetail.texture import analyse, colour_at, picture

LIGHT = Light(direction=(0.5, 0.3, 0.7))
SIDE = 64
SIZE = (72, 72)
FLAT = ColourChannel(weights=(0.0,), curve=(0.25,) * 10)
CONSTANT = ColourTexture(channels=(FLAT, FLAT, FLAT), texels=(8, 8), encoding="linear")
QUARTER_TO_ONE = (4.0, 4.0, 4.0)


def stains(seed: int = 1, side: int = 128) -> NDArray[np.float32]:
    """Red and blue stains of a few pixels."""
    field = gaussian_filter(np.random.default_rng(seed).standard_normal((side, side)), 3, mode="wrap")
    field = field / field.std()
    level = 0.4 * np.exp(0.4 * field)
    return np.stack([level, np.full_like(level, 0.4), 0.16 / level], axis=-1).clip(0, 1).astype(np.float32)


def coloured(
    texture: ColourTexture, gain: tuple[float, float, float] = (2.5, 2.5, 2.5), driver: str = "noise", **values: Any
) -> Detail:
    heights = tuple(np.linspace(0.05, 0.95, 10).tolist()) if driver in ("height", "hollow") else ()
    colour = DetailColour(driver=driver, texels_per_unit=32.0, gain=gain, heights=heights, texture=texture)  # type: ignore[arg-type]
    return detail(**values).model_copy(update={"colour": colour})


STAINED = coloured(analyse(stains()))


@pytest.mark.parametrize("shape", ["plane", "sphere", "cylinder"])
@pytest.mark.parametrize("shading", ["phong", "principled"])
def test_a_colour_of_one_changes_nothing(shape: str, shading: Any) -> None:
    options = {"size": SIZE, "shading": shading, "samples": 16, "light": LIGHT}
    plain, same = (render(d, shape, **options) for d in (detail(), coloured(CONSTANT, QUARTER_TO_ONE)))
    np.testing.assert_allclose(plain, same, rtol=2e-3, atol=2e-4)


@pytest.mark.parametrize("driver", ["noise", "height", "hollow", "cell"])
def test_lit_and_traced_show_the_same_colour(driver: str) -> None:
    what = coloured(analyse(stains()), driver=driver, relief__amplitude=0.02)
    lit = render(what, "plane", size=SIZE, light=LIGHT)
    traced = render(what, "plane", size=SIZE, light=LIGHT, shading="principled", samples=64)
    ratio = [np.log(np.maximum(p[..., 0], 1e-3) / np.maximum(p[..., 2], 1e-3)) for p in (lit, traced)]
    assert ratio[0].std() > 0.2
    # Light that bounces between stains draws them a little together.
    assert np.corrcoef(ratio[0].ravel(), ratio[1].ravel())[0, 1] > 0.97
    assert ratio[1].std() == pytest.approx(ratio[0].std(), rel=0.15)


@pytest.mark.parametrize("key", ["reflectance.height_albedo", "reflectance.cell_albedo", "reflectance.speckle"])
def test_grey_patterns_are_path_traced_too(key: str) -> None:
    what = with_values(detail(relief__amplitude=0.005), {key: 0.6, "reflectance.speckle_scale": 8.0})
    lit = luminance(render(what, "plane", size=SIZE, light=LIGHT))
    traced = luminance(render(what, "plane", size=SIZE, light=LIGHT, shading="principled", samples=64))
    assert lit.std() > 0.1 * lit.mean()
    assert np.corrcoef(lit.ravel(), traced.ravel())[0, 1] > 0.9  # the rest is grain


def test_no_albedo_is_over_one() -> None:
    loud = with_values(coloured(analyse(stains()), (9.0, 9.0, 9.0)), {"reflectance.diffuse": 0.9, "relief.amplitude": 0.0})
    scene = build(setup(), (SIDE, SIDE), None)
    scene.update(loud)
    parts = components(scene, Lamp((0.0, 0.0, 1.0)))
    assert parts.diffuse.shape == (SIDE, SIDE, 3)
    assert (0.9 * parts.diffuse).max() <= 1.0 + 1e-5
    assert (0.9 * parts.diffuse).max() > 0.99


def test_height_drives_the_colour() -> None:
    # Bare of shading: the sky alone, on relief so low that it hides nothing.
    values = {"relief__amplitude": 0.001, "reflectance__diffuse": 0.0}
    high, low = (
        render(coloured(analyse(stains()), driver=driver, **values), "plane", size=SIZE) for driver in ("height", "hollow")
    )
    ratio = [np.log(p[..., 0] / p[..., 2]) for p in (high, low)]
    assert np.corrcoef(ratio[0].ravel(), ratio[1].ravel())[0, 1] < -0.7


def test_a_larger_detail_has_larger_stains() -> None:
    def size_of(scale: float) -> float:
        made = render(STAINED, "plane", size=(128, 128), scale=scale)
        ratio = np.log(made[..., 0] / made[..., 2])
        return float(ratio.std() / np.diff(ratio, axis=1).std())

    assert size_of(2.0) == pytest.approx(2.0 * size_of(1.0), rel=0.25)


def test_solid_matter_has_colour_and_a_medium_has_none() -> None:
    solid = with_values(STAINED, {"relief.amplitude": 0.05}).model_copy(update={"mode": "volume"})
    made = render(solid, "sphere", size=SIZE)
    inside = luminance(made) > 0.05
    assert np.log(made[inside][:, 0] / made[inside][:, 2]).std() > 0.2
    with pytest.raises(InputError, match="colour"):
        with_values(STAINED, {"medium.thickness": 0.3})


def test_relit_frames_keep_their_colour() -> None:
    frames = [p for _, _, p in relight(STAINED, azimuths=[0.0, 180.0], elevations=[50.0], size=SIZE)]
    ratio = [np.log(p[..., 0] / p[..., 2]).ravel() for p in frames]
    assert np.corrcoef(*ratio)[0, 1] > 0.99


def test_the_file_holds_the_colour() -> None:
    again = detail_from_text(detail_to_text(STAINED))
    assert again.colour is not None
    assert STAINED.colour is not None
    np.testing.assert_allclose(again.colour.texture.channels[0].weights, STAINED.colour.texture.channels[0].weights, rtol=1e-6)
    assert '"colour"' not in detail_to_text(detail())


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"driver": "height"}, "needs 10 heights"),
        ({"heights": (0.5,) * 10}, "no heights"),
        ({"texels_per_unit": 0.0}, "texels_per_unit"),
        ({"driver": "depth"}, "driver"),
        ({"gain": (1.0, -1.0, 1.0)}, "gain"),
    ],
)
def test_wrong_colours_are_refused(change: dict[str, Any], words: str) -> None:
    data = STAINED.model_dump()
    data["colour"] = {**data["colour"], **change}
    with pytest.raises(InputError, match=words) as refused:
        detail_from(data)
    assert "\n" not in str(refused.value)


def photo() -> Photo:
    """A photo of bumps with stains that have nothing to do with them."""
    scene = build(setup(SIDE, light=LIGHT), (SIDE, SIDE), None)
    scene.update(detail(noise__scale=6.0, relief__amplitude=0.04))
    light = components(scene, lamp_of(LIGHT)).luminance(0.1, 0.6, 0.0, 16.0)
    return Photo(pixels=(light[..., None] * stains(5, SIDE) * 2.0).astype(np.float32), sha256="ab" * 32)


def found(colour: str) -> FitResult:
    asked = Setup(
        photo=PhotoSetup(path="stains.png", resolution=SIDE, zone=(0, 0, SIDE, SIDE)),
        light=LIGHT,
        colour=colour,  # type: ignore[arg-type]
        fit=FitSettings(evaluations=40, metric="published"),
    )
    return fit(asked, photo=photo())


def test_a_fit_learns_the_stains() -> None:
    result = found("by-example")
    assert result.detail.colour is not None
    assert result.detail.colour.driver == "noise"
    own, made = (np.log(p[..., 0] / p[..., 2]) for p in (photo().pixels, result.coloured))
    assert made.std() == pytest.approx(own.std(), rel=0.35)
    assert result.coloured.reshape(-1, 3).mean(axis=0) == pytest.approx(photo().pixels.reshape(-1, 3).mean(axis=0), rel=0.25)
    assert result.detail.provenance is not None
    assert result.detail.provenance.settings["colour"] == {"chosen": "by-example", "distances": {}}


def test_auto_says_what_it_tried() -> None:
    result = found("auto")
    assert result.detail.provenance is not None
    told: Any = result.detail.provenance.settings["colour"]
    assert set(told["distances"]) == {"none", "noise", "height", "hollow", "cell"}
    assert told["chosen"] != "none"
    best = min(told["distances"], key=lambda driver: told["distances"][driver] * PENALTIES.get(driver, 1.0))
    assert told["chosen"] == {"noise": "by-example", "hollow": "height"}.get(best, best)


def test_none_is_one_tint() -> None:
    assert found("none").detail.colour is None


def test_a_command_asks_for_a_colour(tmp_path: Any, capsys: Any) -> None:
    from voldetail.cli import main

    save_image(tmp_path / "stains.png", photo().pixels)
    base = ["fit", str(tmp_path / "stains.png"), "--light", "30,50", "--evaluations", "30", "--resolution", "64"]
    assert main([*base, "--colour", "by-example", "-o", str(tmp_path / "out")]) == 0
    assert load_detail(tmp_path / "out" / "detail.json").colour is not None
    capsys.readouterr()
    assert main([*base, "--colour", "sepia", "-o", str(tmp_path / "no")]) == 2
    assert "sepia" in capsys.readouterr().err
    assert main([*base, "--colour", "cell", "--look", "medium", "-o", str(tmp_path / "no")]) == 2
    assert "displaced surfaces" in capsys.readouterr().err


@pytest.mark.parametrize("mapping", ["solid", "uv"])
def test_mitsuba_sees_the_texture(mapping: str) -> None:
    mi = mitsuba()
    texture = analyse(stains())
    made = mi.load_dict(colour_dict(texture, 20.0, mapping))
    si = mi.SurfaceInteraction3f()
    random = np.random.default_rng(3)
    si.p, si.uv = mi.Point3f(*random.uniform(-1, 1, (3, 50))), mi.Point2f(*random.uniform(0, 1, (2, 50)))
    si.n = mi.Normal3f(0.0, 0.0, 1.0)
    place = tuple(si.p) if mapping == "solid" else tuple(si.uv)
    expected = np.stack([np.asarray(v) for v in colour_at(texture, tuple(v * 20.0 for v in place))])
    np.testing.assert_allclose(np.asarray(made.eval(si)), expected, atol=1e-5)


def test_mitsuba_renders_it_on_a_shape_without_coordinates() -> None:
    mi = mitsuba()
    texture = analyse(stains())
    scene = mi.load_dict({
        "type": "scene", "sky": {"type": "constant"},
        "ball": {"type": "sphere", "bsdf": {"type": "diffuse", "reflectance": colour_dict(texture, 800.0)}},
    })  # fmt: skip
    sensor = mi.load_dict({
        "type": "orthographic", "to_world": mi.ScalarTransform4f().look_at([0, 0, 4], [0, 0, 0], [0, 1, 0]),
        "film": {"type": "hdrfilm", "width": 64, "height": 64, "pixel_format": "rgb", "rfilter": {"type": "box"}},
    })  # fmt: skip
    integrator = mi.load_dict({"type": "direct"})
    made = np.asarray(mi.render(scene, sensor=sensor, integrator=integrator, spp=16))[20:44, 20:44].reshape(-1, 3)
    # Under an even sky a convex shape is as bright as its albedo.
    wanted = picture(texture, (256, 256)).reshape(-1, 3)
    assert made.mean(axis=0) == pytest.approx(wanted.mean(axis=0), rel=0.1)
    with pytest.raises(InputError, match="mapping"):
        colour_dict(texture, 1.0, "cube")
