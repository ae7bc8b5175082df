"""Volumes through the whole program: fitted, saved, put on other shapes, and what is refused on the way."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh

from voldetail.apply import gallery, relight, render, volumes
from voldetail.apply.onmesh import Picture
from voldetail.cli import main
from voldetail.detail import Detail, load_detail, rounded, save_detail, with_values
from voldetail.errors import InputError
from voldetail.fit import FitResult, fit
from voldetail.fit.fitter import coloured
from voldetail.fit.identifiability import NUMBERS
from voldetail.fit.objective import Objective
from voldetail.fit.target import make_target
from voldetail.image import Photo, load_photo, luminance
from voldetail.render.build import build
from voldetail.render.unit_components import components
from voldetail.setup.fit_settings import FitSettings
from voldetail.setup.light import lamp_of, parse_light
from voldetail.setup.photo import PhotoSetup
from voldetail.setup.setup import Setup

SIDE = 64
BLUE = (0.12, 0.2, 0.4548)  # luminance 0.2
CLOUD = with_values(
    Detail(seed=9),
    {
        "noise.scale": 3.0, "noise.last_neighbour": 50, "noise.envelope": "gaussian", "relief.amplitude": 0.25,
        "medium.thickness": 0.35, "medium.exponent": 5.0, "medium.extinction": 25.0, "medium.asymmetry": 0.5,
        "reflectance.ambient": 0.3, "reflectance.diffuse": 0.8,
    },
)  # fmt: skip
STONE = with_values(Detail(mode="volume", seed=9), {"noise.scale": 5.0, "noise.last_neighbour": 2, "relief.amplitude": 0.12})


def wanted(look: str, evaluations: int = 24, **fields: Any) -> Setup:
    given = {
        "photo": PhotoSetup(path="made.png", resolution=SIDE, zone=(0, 0, SIDE, SIDE)), "light": parse_light("120,40"),
        "mode": "volume", "look": look, "seed": 3, "fit": FitSettings(evaluations=evaluations, metric="published"),
    }  # fmt: skip
    return Setup(**{**given, **fields})


def photo_of(detail: Detail, setup: Setup) -> Photo:
    seen = build(setup, (SIDE, SIDE), None)
    seen.update(detail)
    parts = components(seen, lamp_of(setup.light), subsamples=2, shininess=(16.0,))
    pixels = parts.colour(detail.reflectance) + (1.0 - parts.covered[..., None]) * np.float32(BLUE)
    return Photo(pixels=pixels.astype(np.float32), sha256="ab" * 32)


@pytest.fixture(scope="module")
def cloud() -> FitResult:
    setup = wanted("medium")
    return fit(setup, photo=photo_of(CLOUD, setup))


def test_a_fitted_medium_is_whole(cloud: FitResult) -> None:
    detail = cloud.detail
    assert detail.mode == "volume"
    assert detail.medium is not None
    assert rounded(detail) == detail
    assert [told.key for told in cloud.identifiability] == list(NUMBERS)
    for told in cloud.identifiability:
        assert told.least <= told.low <= told.value <= told.high <= told.most
    assert detail.provenance is not None
    assert detail.provenance.settings["background"] == pytest.approx(cloud.background, rel=1e-3)


def test_the_sky_behind_a_cloud_is_blue_and_the_cloud_is_not() -> None:
    setup = wanted("medium")
    target = make_target(setup, photo_of(CLOUD, setup))
    objective = Objective(target, build(setup, target.shape, target.zone), specular=False)
    seen, behind = coloured(target, objective.evaluate(CLOUD))
    reflectance = seen.detail.reflectance
    # No pixel is sky alone, so its blue is a little less than it was.
    assert behind == pytest.approx(BLUE, rel=0.3)
    assert reflectance.tint == pytest.approx((1.0, 1.0, 1.0), abs=0.05)
    # The same seed: the picture itself comes back, though beam and sky stand for each other where a cloud is as soft as this.
    assert seen.picture == pytest.approx(target.luminance, abs=0.03)


def test_the_pictures_of_a_report_show_the_sky_through(cloud: FitResult) -> None:
    pictures = gallery(cloud)
    for picture in (pictures.sphere, pictures.mesh):
        assert picture[0, 0] == pytest.approx(cloud.background, rel=1e-3)
    assert pictures.fitted == pytest.approx(cloud.coloured, abs=0.1)
    assert luminance(cloud.coloured) == pytest.approx(cloud.picture, abs=0.02)
    assert cloud.picture.mean() == pytest.approx(float(luminance(cloud.target.pixels).mean()), rel=0.15)


def test_solid_matter_is_fitted_and_has_no_pattern_of_albedo() -> None:
    setup = wanted("surface")
    found = fit(setup, photo=photo_of(STONE, setup))
    assert found.detail.mode == "volume"
    assert found.detail.medium is None
    assert found.heights is not None
    assert found.detail.reflectance.speckle == found.detail.reflectance.cell_albedo == 0.0
    assert found.background == (0.0, 0.0, 0.0)


def covered(picture: Picture) -> float:
    return float((luminance(picture) > 0.01).mean())


def test_solid_matter_on_a_sphere_is_larger_than_it_and_lit() -> None:
    said: list[str] = []
    flat = with_values(STONE, {"noise.curve": (0.0,) * 11, "reflectance.ambient": 0.0})
    options: dict[str, Any] = {"light": parse_light("0,90"), "size": (96, 96)}
    ball = render(flat, "sphere", tell=said.append, **options)
    assert "cells" in said[0]
    assert "MB" in said[0]
    rough = render(with_values(STONE, {"reflectance.ambient": 0.0}), "sphere", **options)
    assert covered(rough) > 1.02 * covered(ball)
    # A matt ball lit from the viewer: Kd times the cosine, half a radius from the middle.
    half = (1.0 + STONE.relief.amplitude) * 1.05
    column = round(48 + 0.5 / half * 48)
    assert ball[48, column, 1] == pytest.approx(0.5 * np.sqrt(0.75), rel=0.04)


def test_by_tiles_it_looks_the_same(monkeypatch: pytest.MonkeyPatch) -> None:
    whole = render(STONE, "sphere", size=(72, 72))
    monkeypatch.setattr(volumes, "BUDGET", 235 << 20)
    said: list[str] = []
    tiled = render(STONE, "sphere", size=(72, 72), tell=said.append)
    assert "blocks" in said[0]
    assert tiled == pytest.approx(whole, abs=5e-3)


def test_a_marched_cloud_is_as_bright_as_a_path_traced_one() -> None:
    options: dict[str, Any] = {"size": (40, 40), "light": parse_light("120,40")}
    marched = render(CLOUD, "sphere", **options)
    traced = render(CLOUD, "sphere", shading="principled", samples=24, **options)
    assert marched.mean() == pytest.approx(float(traced.mean()), rel=0.12)
    blocks = [p.reshape(10, 4, 10, 4, 3).mean(axis=(1, 3, 4)).ravel() for p in (marched, traced)]
    assert np.corrcoef(*blocks)[0, 1] > 0.97


def test_a_cloud_may_be_lit_from_behind_and_stone_not() -> None:
    frames = list(relight(CLOUD, "sphere", azimuths=[0.0], elevations=[40.0, -40.0], size=(48, 48)))
    front, back = (float(picture.mean()) for _, _, picture in frames)
    assert 0.0 < back < front
    with pytest.raises(InputError, match="behind the surface"):
        render(STONE, "sphere", light=parse_light("0,-40"), size=(32, 32))


def test_a_medium_that_takes_too_much_gets_larger_cells(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(volumes, "MARCHED_BYTES", 400_000)
    said: list[str] = []
    picture = render(CLOUD, "sphere", size=(64, 64), tell=said.append)
    assert "times as large as wanted, to stay within 2048 MB" in said[0]
    assert covered(picture) > 0.3


@pytest.fixture
def files(tmp_path: Path) -> Path:
    save_detail(tmp_path / "cloud.json", CLOUD)
    save_detail(tmp_path / "stone.json", STONE)
    trimesh.Trimesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]]).export(tmp_path / "open.ply")
    return tmp_path


def test_commands_make_and_show_a_cloud(files: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = files / "fit"
    words = ["fit", "skimage:grass", "--light", "60,40", "--look", "medium", "--zone", "100,100,96,96", "--resolution", "64"]
    assert main([*words, "--evaluations", "20", "-o", str(out)]) == 0
    said = capsys.readouterr().out
    assert "Of the medium: " in said
    assert load_detail(out / "detail.json").medium is not None
    picture = files / "cloud.png"
    shown = ["render", str(out / "detail.json"), "sphere", "--size", "48x48", "-o", str(picture)]
    assert main([*shown, "--background", "photo"]) == 0
    assert "cells" in capsys.readouterr().err
    assert load_photo(picture).pixels[0, 0].max() > 0.0
    assert main(["show", str(files / "cloud.json")]) == 0
    assert "Extinction" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("words", "says"),
    [
        (["render", "{}/stone.json", "{}/open.ply"], "open.ply is not closed, so it has no inside to fill"),
        (["render", "{}/cloud.json", "{}/open.ply"], "open.ply is not closed"),
        (["render", "{}/stone.json", "sphere", "--background", "photo"], "this detail names none"),
        (["render", "{}/cloud.json", "sphere", "--background", "1,2"], "--background '1,2' is not understood"),
        (["render", "{}/cloud.json", "sphere", "--background", "-1"], "out of range"),
        (["fit", "skimage:grass", "--light", "60,40", "--mode", "solid"], "--mode solid: mode = 'solid' is not known"),
        (["fit", "skimage:grass", "--light", "60,40", "--mode", "volume", "--domain", "surface"], 'leave the domain "solid"'),
        (["fit", "skimage:grass", "--light", "60,40", "--mode", "displacement", "--look", "medium"], 'needs the mode "volume"'),
        (["fit", "skimage:grass", "--light", "auto", "--look", "medium"], "what is seen is a medium"),
        (["fit", "skimage:grass", "--light", "60,40", "--mode", "volume", "--proxy", "{}/open.ply"], "is not closed"),
    ],
)
def test_bad_input_is_one_sentence(words: list[str], says: str, files: Path, capsys: pytest.CaptureFixture[str]) -> None:
    given = [word.format(files) for word in words]
    assert main([*given, "-o", str(files / ("out.png" if words[0] == "render" else "out"))]) == 2
    said = capsys.readouterr().err
    assert says in said
    assert "Traceback" not in said
    assert not (files / "out.png").exists()
    assert not (files / "out" / "detail.json").exists()
