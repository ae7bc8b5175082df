"""Structures as colours: the picture that was retrieved at any point, on planes and surfaces, and in files."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from voldetail.apply import painted
from voldetail.backend import mitsuba
from voldetail.detail import Detail, StructureTexture, detail_from_text, detail_to_text, summary
from voldetail.detail.texture_file import load_example, load_texture, save_texture, texture_from_text, texture_to_text
from voldetail.errors import InputError
from voldetail.field.albedo import coloured as pigment
from voldetail.field.albedo import factors_of
from voldetail.image import to_srgb
from voldetail.library import recolour
from voldetail.library.span import spanned
from voldetail.render.plugins.colour import colour_dict
from voldetail.texture import colour_at, picture
from voldetail.texture.picture import default_float
from voldetail.texture.structures import MODELS, checked_structure, structure

ZERO, ONE = (0.1, 0.3, 0.2), (0.9, 0.5, 0.7)
SPAN = (0.1, 0.8)
ROWS, COLUMNS = 40, 56


def texture_of(name: str, rotation: float = 0.7, seed: int = 5) -> StructureTexture:
    parameters = {p.key: p.at(0.4) for p in MODELS[name].parameters}
    return StructureTexture(
        model=name, parameters=parameters, seed=seed, rotation=rotation, span=SPAN, zero=ZERO, one=ONE, texels=(256, 192)
    )  # fmt: skip


@pytest.mark.parametrize("name", MODELS)
def test_every_model_is_the_picture_that_numpy_makes(name: str) -> None:
    texture = texture_of(name)
    made = picture(texture, (COLUMNS, ROWS))
    # The texel (0, 0) is the lower left pixel's middle.
    s = structure(MODELS[name], texture.parameters, (ROWS, COLUMNS), rotation=0.7, seed=5, offset=(0.5 - ROWS, -0.5))
    expected = recolour(spanned(s, SPAN), ZERO, ONE)
    assert s.std() > 0.02
    # Two libraries' sines differ in the last digit, which moves an edge here and there by a little.
    apart = np.abs(to_srgb(made) - to_srgb(expected)).max(axis=2)
    assert np.quantile(apart, 0.99) < 2e-3
    assert apart.mean() < 1e-3


def coloured(texture: StructureTexture, points: np.ndarray, normals: np.ndarray | None) -> np.ndarray:
    kind: Any = default_float()
    given = tuple(kind(np.ascontiguousarray(v, np.float32)) for v in points.T)
    facing = None if normals is None else tuple(kind(np.ascontiguousarray(v, np.float32)) for v in normals.T)
    colour = colour_at(texture, given, 2.0, normals=facing)
    return np.stack([v.numpy() for v in colour], axis=1)


def test_a_surface_sees_the_plane_at_right_angles_to_its_normal() -> None:
    texture = texture_of("brick", rotation=0.0)
    points = np.random.default_rng(0).uniform(-200, 200, (400, 3))
    for axis, (a, b) in enumerate(((2, 1), (0, 2), (0, 1))):
        for sign in (1.0, -1.0, 1e-20):
            normals = np.zeros((400, 3))
            normals[:, axis] = sign
            np.testing.assert_allclose(
                coloured(texture, points, normals), coloured(texture, points[:, [a, b]], None), atol=1e-5
            )  # fmt: skip
    along_z = coloured(texture, points[:, :2], None)
    np.testing.assert_allclose(coloured(texture, points, np.zeros((400, 3))), along_z, atol=1e-5)
    np.testing.assert_allclose(coloured(texture, points, None), along_z, atol=1e-5)
    between = to_srgb(coloured(texture, points, np.ones((400, 3))))
    assert (between >= np.minimum(ZERO, ONE) - 1e-3).all()
    assert (between <= np.maximum(ZERO, ONE) + 1e-3).all()
    # Of three equally seen planes the mean: a third of the variance.
    assert 0.2 < between.var(axis=0).mean() / to_srgb(along_z).var(axis=0).mean() < 0.5


@pytest.mark.parametrize("mapping", ["solid", "uv"])
def test_mitsuba_and_a_detail_on_a_shape_see_the_same_structure(mapping: str) -> None:
    mi = mitsuba()
    texture = texture_of("woodplanks")
    made = mi.load_dict(colour_dict(texture, 90.0, mapping))
    rng = np.random.default_rng(3)
    points, normals = rng.uniform(-1, 1, (60, 3)), rng.standard_normal((60, 3))
    si = mi.SurfaceInteraction3f()
    si.p, si.uv, si.n = mi.Point3f(*points.T), mi.Point2f(*points[:, :2].T), mi.Normal3f(*normals.T)
    plane = coloured(texture, 90.0 * points[:, :2], None)
    expected = plane if mapping == "uv" else coloured(texture, 90.0 * points, normals)
    np.testing.assert_allclose(np.asarray(made.eval(si)).T, expected, atol=2e-4)
    assert np.abs(coloured(texture, 90.0 * points, normals) - plane).max() > 0.05
    detail, facing = painted(texture, 90.0), tuple(si.n)
    shown = factors_of(pigment(detail, None, tuple(si.p), None, None, scale=1.0, spacing=0.0, normals=facing))
    solid = coloured(texture, 90.0 * points, normals)
    np.testing.assert_allclose(np.stack([np.asarray(v) for v in shown], axis=1), solid, atol=2e-4)
    with pytest.raises(InputError, match="'clinker', which is not known"):
        colour_dict(texture.model_copy(update={"model": "clinker"}), 90.0, mapping)


def test_a_file_comes_back(tmp_path: Path) -> None:
    texture = texture_of("cellular grid")
    save_texture(tmp_path / "t.json", texture)
    again = load_texture(tmp_path / "t.json")
    assert isinstance(again, StructureTexture)
    assert texture_to_text(again) == texture_to_text(texture)
    assert again.parameters == pytest.approx(texture.parameters, rel=1e-6)
    with pytest.raises(InputError, match="is a structure and has no bands"):
        load_example(tmp_path / "t.json")
    painted_detail = painted(texture)
    assert painted_detail.colour is not None
    assert painted_detail.colour.texels_per_unit == 128
    text = detail_to_text(painted_detail)
    assert '"texture"' not in text
    back = detail_from_text(text)
    assert isinstance(back, Detail)
    assert detail_to_text(back) == text
    assert "coloured by cellular grid in two tones" in summary(back)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"zero": [0.1, 0.2]}, "zero"),
        ({"one": [0.1, 0.2, 1.5]}, r"one\[2\] = 1.5 is out of range"),
        ({"rotation": 7.0}, "rotation = 7.0 is out of range"),
        ({"seed": -1}, "seed"),
        ({"span": [0.5, 0.5]}, "span's second number has to be over its first"),
        ({"texels": [0, 5]}, "texels"),
        ({"turn": 1}, "no setting turn"),
        ({"parameters": {"length": "9"}}, "parameters"),
        ({"version": 2}, "newer voldetail"),
    ],
)
def test_a_damaged_file_is_refused(changes: dict[str, Any], words: str) -> None:
    data = {**json.loads(texture_to_text(texture_of("brick"))), **changes}
    with pytest.raises(InputError, match=words):
        texture_from_text(json.dumps(data), "The texture x.json")


def test_an_unknown_model_and_numbers_out_of_range_are_refused_before_anything_is_made() -> None:
    texture = texture_of("brick")
    for changes, words in (
        ({"model": "clinker"}, "'clinker', which is not known; use one of perlin"),
        ({"parameters": {"length": 500.0}}, "length is 500; 12 to 96 is allowed"),
        ({"parameters": {"lenght": 50.0}}, "no parameter 'lenght'"),
        ({"parameters": {"phase": 0.5}}, "a whole number"),
    ):
        wrong = texture.model_copy(update=changes)
        for use in (checked_structure, lambda t: picture(t, (8, 8))):
            with pytest.raises(InputError, match=words):
                use(wrong)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"structure": None}, "a texture or a structure, and not both"),
        ({"driver": "cell"}, "nothing drives a structure"),
    ],
)
def test_a_detail_s_colour_is_of_one_kind(changes: dict[str, Any], words: str) -> None:
    data = json.loads(detail_to_text(painted(texture_of("grid"))))
    data["colour"] |= changes
    with pytest.raises(InputError, match=words):
        detail_from_text(json.dumps(data))
