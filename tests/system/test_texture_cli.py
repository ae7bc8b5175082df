"""`voldetail texture` from photo to picture, and what it says when something is wrong."""

from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from voldetail.cli import main
from voldetail.detail.texture_file import load_texture


@pytest.fixture
def photo(tmp_path: Path) -> Path:
    """A palette PNG of two colours of blotches."""
    random = np.random.default_rng(0)
    grains = np.repeat(np.repeat(random.uniform(size=(16, 20)), 4, 0), 4, 1) + 0.4 * random.uniform(size=(64, 80))
    colours = np.stack([40 + 130 * grains, 60 + 90 * grains, 90 + 20 * grains], -1).astype(np.uint8)
    Image.fromarray(colours).quantize(32).save(tmp_path / "photo.png")
    return tmp_path / "photo.png"


def test_fit_render_edit_morph(photo: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    mask = tmp_path / "mask.png"
    Image.fromarray(np.where(np.arange(80) < 60, 255, 0).astype(np.uint8)[None].repeat(64, 0)).save(mask)
    a, b, c = (tmp_path / f"{n}.json" for n in "abc")
    assert main(["texture", "fit", str(photo), "-o", str(a), "--mask", str(mask), "--seed", "5"]) == 0
    assert "numbers from 80 x 64 pixels" in capsys.readouterr().out
    assert main(["texture", "fit", str(photo), "-o", str(b), "--zone", "8,0,64,64", "--no-histogram"]) == 0
    first = load_texture(a)
    assert (first.seed, first.photo, first.texels) == (5, "photo.png", (80, 64))
    assert load_texture(b).texels == (64, 64)
    assert main(["texture", "edit", str(a), "-o", str(c), "--gain", "fine=0", "--gain", "3=2", "--contrast", "0.5"]) == 0
    assert load_texture(c).channels[0].weights[0] == 0
    out = tmp_path / "out.png"
    for words in ([], ["--solid"], ["--zoom", "0.5", "--offset=-3,9"]):
        assert main(["texture", "render", str(a), "-o", str(out), "--size", "48x32", *words]) == 0
        assert Image.open(out).size == (48, 32)
    folder = tmp_path / "steps"
    assert main(["texture", "morph", str(a), str(b), "--steps", "3", "-o", str(folder), "--size", "16x16"]) == 0
    assert sorted(p.name for p in folder.iterdir()) == [f"step_{i:03d}.{s}" for i in range(3) for s in ("json", "png")]
    assert load_texture(folder / "step_000.json") == first
    capsys.readouterr()
    assert main(["texture", "morph", str(a), str(b), "-o", str(folder)]) != 0
    assert "--force" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (["fit", "PHOTO", "-o", "OUT", "--zone", "0,0,81,64"], "reaches outside"),
        (["fit", "PHOTO", "-o", "OUT", "--encoding", "lab"], "use srgb or linear"),
        (["fit", "none.png", "-o", "OUT"], "does not exist"),
        (["edit", "FILE", "-o", "OUT", "--gain", "0:2"], "BAND=FACTOR"),
        (["edit", "FILE", "-o", "OUT", "--gain", "77=2"], "no band '77'"),
        (["render", "PHOTO", "-o", "a.png"], "texture file"),
        (["render", "FILE", "-o", "a.bmp"], "suffix .bmp"),
        (["render", "FILE", "-o", "a.png", "--size", "9"], "WIDTHxHEIGHT"),
        (["render", "FILE", "-o", "a.png", "--offset", "1e9,0"], "too far"),
    ],
)
def test_errors_are_sentences(
    photo: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str],
    words: list[str], sentence: str,
) -> None:  # fmt: skip
    monkeypatch.chdir(tmp_path)
    assert main(["texture", "fit", str(photo), "-o", "file.json"]) == 0
    capsys.readouterr()
    names = {"PHOTO": "photo.png", "OUT": "out.json", "FILE": "file.json"}
    assert main(["texture", *(names.get(w, w) for w in words)]) != 0
    said = capsys.readouterr().err
    assert sentence in said
    assert "Traceback" not in said
