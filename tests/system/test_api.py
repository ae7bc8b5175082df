"""The Python interface takes texts, files, arrays and records alike, and refuses the rest in a sentence."""

import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh

from voldetail import api
from voldetail.errors import InputError
from voldetail.image import save_png

DETAIL = api.Detail()
SMALL = {"size": (48, 48)}


@pytest.mark.parametrize(
    "light", ["135,40", (135.0, 40.0), [135, 40], api.parse_light("135,40"), api.parse_light("135,40").direction]
)
def test_any_form_of_a_light_gives_the_same_picture(light: Any) -> None:
    assert api.render(DETAIL, "plane", light=light, **SMALL) == pytest.approx(
        api.render(DETAIL, "plane", light=api.parse_light("135,40"), **SMALL), abs=1e-5
    )


def test_any_form_of_a_mesh_gives_the_same_picture(tmp_path: Path) -> None:
    mesh = trimesh.creation.icosphere(subdivisions=3)
    mesh.export(tmp_path / "ball.ply")
    pictures = [
        api.render(DETAIL, shape, light="135,40", **SMALL)
        for shape in (mesh, (mesh.vertices, mesh.faces), tmp_path / "ball.ply", str(tmp_path / "ball.ply"))
    ]
    for picture in pictures[1:]:
        assert picture == pytest.approx(pictures[0], abs=1e-4)
    assert pictures[0].std() > 0.05


def test_a_mesh_in_memory_keeps_its_texture_coordinates() -> None:
    mesh = trimesh.creation.box()
    mesh = mesh.subdivide()
    mesh.visual = trimesh.visual.TextureVisuals(uv=mesh.vertices[:, :2] + 0.5)
    flat = api.Detail.model_validate(DETAIL.model_dump() | {"noise": DETAIL.noise.model_dump() | {"domain": "surface"}})
    with_uv = api.render(flat, mesh, light="135,40", **SMALL)
    without = api.render(flat, (mesh.vertices, mesh.faces), light="135,40", **SMALL)
    assert np.abs(with_uv - without).max() > 0.05  # 1 and 2 scene units a unit of texture coordinates


def test_any_form_of_a_photo_and_a_mask_is_the_same(tmp_path: Path) -> None:
    linear = api.load_photo("skimage:brick").pixels[:80, :96]
    mask = np.zeros((80, 96), bool)
    mask[:, :80] = True
    save_png(tmp_path / "photo.png", linear)
    save_png(tmp_path / "mask.png", mask.astype(np.float32))
    read = api.load_photo(tmp_path / "photo.png")
    eight = np.asarray(__import__("PIL.Image").Image.open(tmp_path / "photo.png"))
    for photo in (str(tmp_path / "photo.png"), read, read.pixels, eight, eight.astype(np.uint16) * 257):
        assert api.load_photo(photo).pixels == pytest.approx(read.pixels, abs=1e-6)
    for form in (tmp_path / "mask.png", mask, mask.astype(np.uint8) * 255, mask.astype(np.float32)):
        assert (api.load_photo(read, form).opaque == mask).all()


def test_a_fit_of_arrays_is_the_fit_of_the_files(tmp_path: Path) -> None:
    pixels = api.load_photo("skimage:gravel").pixels[:96, :96]
    mask = np.ones((96, 96), bool)
    mask[:8] = False
    save_png(tmp_path / "photo.png", pixels)
    save_png(tmp_path / "mask.png", mask.astype(np.float32))
    settings: dict[str, Any] = {"resolution": 64, "fit": {"evaluations": 6}, "colour": "none"}
    of_files = api.fit(tmp_path / "photo.png", "70,50", mask=tmp_path / "mask.png", **settings)
    of_arrays = api.fit(api.load_photo(tmp_path / "photo.png").pixels, "70,50", mask=mask, **settings)
    mixed = api.fit(tmp_path / "photo.png", "70,50", mask=mask, **settings)
    for result in (of_arrays, mixed):
        assert result.distance == pytest.approx(of_files.distance, rel=1e-4)
        assert result.detail.noise == of_files.detail.noise


BAD: dict[str, tuple[Callable[[], object], str]] = {
    "no light": (lambda: api.fit("skimage:gravel"), "A light is needed"),
    "a light of one number": (lambda: api.render(DETAIL, light=(3.0,)), "has 1 numbers"),
    "a light of no kind": (lambda: api.render(DETAIL, light=3), "The light is a int"),  # type: ignore[arg-type]
    "scale 0": (lambda: api.render(DETAIL, scale=0), "scale = 0 is out of range; allowed: a number over 0"),
    "scale below 0": (lambda: api.bake(api.Detail(mode="volume"), scale=-1), "scale = -1 is out of range"),
    "no subsamples": (lambda: api.render(DETAIL, subsamples=0), "subsamples = 0 is out of range"),
    "half a sample": (lambda: api.render(DETAIL, samples=1.5), "samples = 1.5"),
    "rotation of two": (lambda: api.render(DETAIL, rotation=(1, 2)), "three numbers, each -360 to 360 degrees"),
    "rotation of words": (lambda: api.export(DETAIL, "box", "a.ply", rotation="xyz"), "rotation"),
    "size of one": (lambda: api.render(DETAIL, size=(64,)), "size"),
    "size of words": (lambda: api.render(DETAIL, size=("a", "b")), "size"),
    "background of two": (lambda: api.render(DETAIL, background=(0.1, 0.2)), "background"),
    "dark background": (lambda: next(api.relight(DETAIL, azimuths=[0], elevations=[30], background=-1)), "background"),
    "cells": (lambda: api.bake(api.Detail(mode="volume"), cells=4), "cells = 4 is out of range"),
    "scale nan": (lambda: api.render(DETAIL, scale=float("nan")), "scale = nan"),
    "a shape of no kind": (lambda: api.render(DETAIL, "cone"), "The shape 'cone' is not known"),
    "a number for a shape": (lambda: api.render(DETAIL, 7), "The shape is a int"),  # type: ignore[arg-type]
    "faces beyond the vertices": (
        lambda: api.render(DETAIL, (np.zeros((3, 3)), np.array([[0, 1, 3]]))), "whole numbers from 0 to one less"
    ),
    "vertices of two numbers": (lambda: api.render(DETAIL, (np.zeros((3, 2)), np.array([[0, 1, 2]]))), "give (V, 3)"),
    "an unknown shading": (lambda: api.render(DETAIL, shading="toon"), "shading = 'toon' is not known"),  # type: ignore[arg-type]
    "an unknown encoding": (
        lambda: api.load_photo("skimage:gravel", encoding="log"), "no encoding 'log'"  # type: ignore[arg-type]
    ),
    "an unknown photo": (lambda: api.load_photo("skimage:moon"), "no photo 'skimage:moon'"),
    "a photo of integers": (lambda: api.load_photo(np.zeros((64, 64), np.int64)), "an array of int64"),
    "a photo of four channels": (lambda: api.load_photo(np.zeros((64, 64, 4))), "of shape (64, 64, 4)"),
    "an empty photo": (lambda: api.load_photo(np.zeros((0, 0))), "0 x 0 pixels"),
    "a photo with nan": (lambda: api.load_photo(np.full((64, 64), np.nan)), "NaN or infinite"),
    "a negative photo": (lambda: api.load_photo(np.full((64, 64), -1.0)), "negative"),
    "a mask of another size": (lambda: api.load_photo(np.zeros((64, 64)), np.ones((3, 3), bool)), "of the photo's size"),
    "an empty mask": (lambda: api.load_photo(np.zeros((64, 64)), np.zeros((64, 64), bool)), "The mask is empty"),
    "a picture of whole numbers": (lambda: api.save_image("x.png", np.zeros((9, 9), np.uint8)), "give linear light as floats"),
    "a picture of one row": (lambda: api.save_image("x.png", np.zeros(9)), "the shape (9,)"),
    "a format that is not known": (lambda: api.export(DETAIL, "box", "x.fbx"), "use one of .vol, .ply, .obj"),
    "a displacement as densities": (lambda: api.export(DETAIL, "box", "x.vol"), "has no density"),
    "a volume as a mesh": (lambda: api.export(api.Detail(mode="volume"), "box", "x.ply"), "with the suffix .vol"),
    "an unknown metric": (lambda: api.compare("skimage:gravel", "skimage:grass", metric="ssim"), "no metric 'ssim'"),
}  # fmt: skip


@pytest.mark.parametrize("name", BAD)
def test_bad_input_is_one_sentence(name: str) -> None:
    call, says = BAD[name]
    with pytest.raises(InputError) as refused:
        call()
    assert says in str(refused.value)
    assert len(str(refused.value).splitlines()) == 1


def test_a_displaced_mesh_is_where_the_relief_is(tmp_path: Path) -> None:
    words = api.export(DETAIL, "sphere", tmp_path / "ball.ply", cells=32, scale=2.0)
    mesh = trimesh.load(tmp_path / "ball.ply", process=False)
    radius = np.linalg.norm(mesh.vertices, axis=1)
    assert words == f"{len(mesh.vertices)} vertices, {len(mesh.faces)} faces"
    assert 1.0 - 1e-5 <= radius.min() < radius.max() <= 1.0 + 2.0 * DETAIL.relief.amplitude + 1e-5
    assert mesh.is_watertight


def test_an_import_starts_no_process_and_loads_no_renderer() -> None:
    code = (
        "import subprocess, sys\n"
        "subprocess.Popen.__init__ = lambda *a, **k: sys.exit('a child process')\n"
        "import voldetail\n"
        "assert 'mitsuba' not in sys.modules and 'drjit' not in sys.modules\n"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=120, check=False)
    assert (done.returncode, done.stderr) == (0, "")
