"""`voldetail relief`: from a photo to a folder whose relief every other command takes."""

import json
from pathlib import Path

import numpy as np
import pytest

from voldetail.api import InputError, load_detail, load_photo, recover, save_relief, tile
from voldetail.cli import main
from voldetail.image import save_png


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    place = tmp_path_factory.mktemp("relief")
    save_png(place / "photo.png", load_photo("skimage:gravel").pixels[:128, :160])
    words = ["relief", str(place / "photo.png"), "--light", "70,50", "--tile", "64", "-o", str(place / "own"), "--quiet"]
    assert main([*words, "--mesh", "box"]) == 0
    return place


def test_the_folder_holds_maps_tile_and_report(folder: Path) -> None:
    maps = {"relief.json", "height.exr", "normal.png", "albedo.png", "roughness.png"}
    assert {p.name for p in (folder / "own").iterdir()} == maps | {"report.html", "sheet.png", "tile"}
    assert {p.name for p in (folder / "own" / "tile").iterdir()} == maps
    page = (folder / "own" / "report.html").read_text()
    assert page.count("<img") == 13
    assert "Height, white is high" in page
    assert "photo.png" in page
    record = json.loads((folder / "own" / "relief.json").read_text())
    assert (record["columns"], record["rows"], record["light"]) == (160, 128, "70,50")
    assert json.loads((folder / "own" / "tile" / "relief.json").read_text())["periodic"] is True


@pytest.mark.parametrize(
    "words",
    [
        ["render", "{}/own", "plane", "--size", "80x64", "-o", "{}/a.png"],
        ["render", "{}/own/relief.json", "sphere", "--size", "64x64", "--scale", "2", "-o", "{}/b.exr"],
        ["render", "{}/own/tile", "cylinder", "--size", "64x64", "--shading", "principled", "--samples", "4", "-o", "{}/c.png"],
        ["relight", "{}/own", "--azimuth", "0:360:4", "--elevation", "30", "--size", "80x64", "-o", "{}/turn"],
        ["bake", "{}/own", "box", "--cells", "24", "-o", "{}/d.ply"],
        ["show", "{}/own"],
    ],
)
def test_every_command_takes_it(words: list[str], folder: Path) -> None:
    assert main([word.replace("{}", str(folder)) for word in words]) == 0


def test_the_plane_shows_the_photo(folder: Path) -> None:
    """Under the photo's light the rendered plane goes with the photo, pixel by pixel."""
    assert (
        main(["render", str(folder / "own"), "plane", "--light", "70,50", "--size", "160x128", "-o", str(folder / "again.png")])
        == 0
    )
    again, photo = load_photo(folder / "again.png").pixels, load_photo(folder / "photo.png").pixels
    inner = (slice(8, -8), slice(8, -8), 1)
    assert np.corrcoef(again[inner].ravel(), photo[inner].ravel())[0, 1] > 0.8


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["{}/missing.png", "--light", "70,50"], "does not exist"),
        (["{}/photo.png"], "--light"),
        (["{}/photo.png", "--light", "x"], "not understood"),
        (["{}/photo.png", "--light", "70,50", "--size", "20"], "size 20"),
        (["{}/photo.png", "--light", "70,50", "--zone", "0,0,900,900"], "outside the photo"),
        (["{}/photo.png", "--light", "70,50", "--zone", "0,0,4,4"], "zone"),
        (["{}/photo.png", "--light", "70,50", "--method", "magic"], "--method"),
        (["{}/photo.png", "--light", "70,50", "--tile", "4096"], "tile"),
        (["{}/photo.png", "--light", "70,50", "--mesh", "blob"], "blob"),
        (["{}/photo.png", "--light", "70,50", "--mask", "{}/none.png"], "none.png"),
        (["{}/round.toml"], "no plane"),
    ],
)
def test_bad_input_is_one_sentence_and_leaves_nothing(
    words: list[str], said: str, folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (folder / "round.toml").write_text('light = "70,50"\n[photo]\npath = "photo.png"\n[proxy]\nkind = "sphere"\n')
    target = folder / "bad"
    assert main(["relief", *(w.replace("{}", str(folder)) for w in words), "-o", str(target)]) == 2
    error = capsys.readouterr().err
    assert said in error
    assert "Traceback" not in error
    assert not target.exists()


def test_an_earlier_relief_is_kept_unless_forced(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    words = ["relief", str(folder / "photo.png"), "--light", "70,50", "--no-report", "-o", str(folder / "own")]
    assert main(words) == 2
    assert "--force" in capsys.readouterr().err
    again = [*words[:-1], str(folder / "twice")]
    assert main(again) == 0
    assert main([*again, "--force", "--method", "linear", "--zone", "0,0,96,96"]) == 0
    assert json.loads((folder / "twice" / "relief.json").read_text())["columns"] == 96


def test_auto_light_and_a_mask(folder: Path) -> None:
    mask = np.zeros((128, 160))
    mask[10:120, 10:150] = 1.0
    save_png(folder / "mask.png", mask)
    words = ["relief", str(folder / "photo.png"), "--light", "70,50", "--mask", str(folder / "mask.png"), "--no-report"]
    assert main([*words, "-o", str(folder / "masked")]) == 0
    assert json.loads((folder / "masked" / "relief.json").read_text())["columns"] == 140


def test_python(folder: Path, tmp_path: Path) -> None:
    found = recover(load_photo("skimage:brick").pixels[:96, :96], (140.0, 45.0), method="linear")
    save_relief(tmp_path / "own", found.detail)
    assert load_detail(tmp_path / "own").name == "array"
    assert tile(found, 64).height.shape == (64, 64)
    for wrong in ({"method": "magic"}, {"size": 3}, {"zone": (0, 0, 600, 600)}):
        with pytest.raises(InputError):
            recover("skimage:brick", "140,45", **wrong)  # type: ignore[arg-type]
