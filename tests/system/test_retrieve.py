"""`voldetail retrieve` from photo to table, sheet and JSON, and what it says when something is wrong."""

import json
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from voldetail.cli import main
from voldetail.cli.commands import retrieve as retrieve_command
from voldetail.detail import StructureTexture
from voldetail.detail.texture_file import load_texture
from voldetail.image import save_png
from voldetail.library import entries, novelty, recolour, table
from voldetail.library.groups import Group, Groups
from voldetail.texture.structures import MODELS, structure

DARK, BRIGHT = (0.1, 0.2, 0.3), (0.9, 0.6, 0.5)


@pytest.fixture(scope="module")
def groups() -> Groups:
    found = {}
    for name in ("brick", "perlin"):
        made = entries(MODELS[name], 0, 8, side=128)
        found[name] = Group(name, tuple(p.key for p in MODELS[name].parameters), made.values, table(made.vectors), 0)
    return found


@pytest.fixture
def photo(tmp_path: Path, groups: Groups, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A photo of the third brick wall, turned by 45 degrees, with its tones exchanged."""
    monkeypatch.setattr(retrieve_command, "_groups", lambda library: groups)
    monkeypatch.setattr(novelty, "PICTURES", 2)  # pictures of 256 pixels are what takes the time
    s = structure(MODELS["brick"], groups["brick"].parameters(2), 128, rotation=np.pi / 4)
    s = (s - s.min()) / (s.max() - s.min())
    save_png(tmp_path / "photo.png", recolour(1 - s, DARK, BRIGHT))
    return tmp_path / "photo.png"


def test_a_known_wall_is_found(photo: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    sheet, answers = tmp_path / "sheet.png", tmp_path / "answers.json"
    assert main(["retrieve", str(photo), "--top", "3", "-o", str(sheet), "--answers", str(answers)]) == 0
    said = capsys.readouterr().out
    lines = [line.split() for line in said.splitlines()]
    assert lines[1][:2] == ["1", "brick"]
    assert lines[1][3:5] == ["45°", "yes"]
    assert "Compared at 128 x 128 pixels; two tones explain 100%" in said
    found = json.loads(answers.read_text())
    first = found["answers"][0]
    assert (first["model"], first["entry"], first["swapped"]) == ("brick", 2, True)
    assert len(found["answers"]) == 3
    assert list(found["best_of_each"]) == ["brick", "perlin"]
    np.testing.assert_allclose([found["dark"], found["bright"]], [DARK, BRIGHT], atol=0.06)
    np.testing.assert_allclose([first["zero"], first["one"]], [BRIGHT, DARK], atol=0.06)
    with Image.open(sheet) as picture:
        assert picture.width >= 480
    assert main(["retrieve", str(photo), "--model", "perlin", "--no-rotation", "--no-swap", "--answers", str(answers)]) == 0
    found = json.loads(answers.read_text())
    assert {(a["model"], a["rotation"], a["swapped"]) for a in found["answers"]} == {("perlin", 0.0, False)}


def test_an_answer_is_a_texture_for_any_shape(photo: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    texture, out = tmp_path / "wall.json", tmp_path / "out.png"
    assert main(["retrieve", str(photo), "--texture", str(texture)]) == 0
    found = load_texture(texture)
    assert isinstance(found, StructureTexture)
    assert (found.model, found.texels, found.photo) == ("brick", (128, 128), "photo.png")
    assert found.rotation == pytest.approx(np.pi / 4)
    np.testing.assert_allclose([found.zero, found.one], [BRIGHT, DARK], atol=0.06)
    # The picture's middle is the structure's origin; the texture's is its lower left texel.
    assert main(["texture", "render", str(texture), "-o", str(out), "--size", "128x128", "--offset=-63.5,-63.5"]) == 0
    with Image.open(out) as made, Image.open(photo) as shown:
        a, b = (np.asarray(p.convert("RGB"), float).ravel() for p in (made, shown))
    assert np.corrcoef(a, b)[0, 1] > 0.99
    assert main(["texture", "render", str(texture), "-o", str(out), "--size", "64x64", "--on", "sphere"]) == 0
    with Image.open(out) as made:
        pixels = np.asarray(made.convert("RGB"), float)
    assert pixels[16:48, 16:48].std(axis=(0, 1)).max() > 15
    capsys.readouterr()
    assert main(["texture", "edit", str(texture), "-o", str(out)]) == 2
    assert "has no bands" in capsys.readouterr().err
    texture.write_text(texture.read_text().replace('"brick"', '"clinker"'))
    assert main(["texture", "render", str(texture), "-o", str(out)]) == 2
    assert "'clinker', which is not known" in capsys.readouterr().err


def test_a_zone_a_mask_and_a_scale(photo: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    mask = tmp_path / "mask.png"
    Image.fromarray(np.where(np.arange(128) < 120, 255, 0).astype(np.uint8)[None].repeat(128, 0)).save(mask)
    answers = tmp_path / "answers.json"
    words = ["--zone", "0,0,96,80", "--mask", str(mask), "--scale", "0.5", "--answers", str(answers), "--top", "1"]
    assert main(["retrieve", str(photo), *words]) == 0
    assert "too small for the coarsest" in " ".join(capsys.readouterr().err.split())
    found = json.loads(answers.read_text())
    assert (found["pixels"], found["scale"]) == ([48, 40], 0.5)
    assert found["scales_missing"] > 0


def test_a_library_s_file_and_the_default_library_are_searched(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(novelty, "PICTURES", 1)
    monkeypatch.setattr(retrieve_command, "DEFAULT_ENTRIES", 1)
    monkeypatch.setenv("VOLDETAIL_CACHE", str(tmp_path / "cache"))
    save_png(tmp_path / "photo.png", recolour(structure(MODELS["star"], {"tips": 5}, 128), DARK, BRIGHT))
    library, answers = tmp_path / "stars.vlib", tmp_path / "answers.json"
    assert main(["library", "build", "star", "--entries", "3", "--workers", "1", "-o", str(library)]) == 0
    assert main(["retrieve", str(tmp_path / "photo.png"), "--library", str(library), "--answers", str(answers)]) == 0
    exact = json.loads(answers.read_text())
    assert list(exact["best_of_each"]) == ["star"]
    words = ["retrieve", str(tmp_path / "photo.png"), "--library", str(library), "--index", "--answers", str(answers)]
    assert main(words) == 2
    assert "has no index" in capsys.readouterr().err
    assert main(["library", "index", str(library)]) == 0
    assert main(words) == 0
    assert json.loads(answers.read_text()) == exact
    for _ in range(2):
        assert main(["retrieve", str(tmp_path / "photo.png"), "--answers", str(answers)]) == 0
        assert list(json.loads(answers.read_text())["best_of_each"]) == list(MODELS)
    assert len(list((tmp_path / "cache").iterdir())) == 1
    capsys.readouterr()
    assert main(["retrieve", str(tmp_path / "photo.png"), "--library", str(tmp_path)]) == 2
    assert "is no library" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (["--zone", "0,0,129,64"], "reaches outside the photo of 128 x 128"),
        (["--zone", "1,2"], "X,Y,WIDTH,HEIGHT"),
        (["--scale", "0.01"], "at least 32 a side"),
        (["--model", "brik"], "the nearest one is brick"),
        (["--mask", "photo.png"], "mask"),
        (["-o", "sheet.jpg"], "ends in .png"),
        (["--answers", "missing/answers.json"], "no folder"),
        (["--top", "0"], "--top"),
        (["--index"], "without a library"),
    ],
)
def test_errors_are_sentences(
    photo: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str],
    words: list[str], sentence: str,
) -> None:  # fmt: skip
    monkeypatch.chdir(tmp_path)
    assert main(["retrieve", str(photo), *words]) == 2
    said = capsys.readouterr().err
    assert sentence in said
    assert "Traceback" not in said
    assert not list(tmp_path.glob("sheet*"))
