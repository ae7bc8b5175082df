"""How commands speak: --json, --quiet, --verbose, at any place; and completion."""

import json
from pathlib import Path

import pytest

from voldetail.cli import main
from voldetail.cli.app import app
from voldetail.detail import Detail, save_detail
from voldetail.image import load_photo, save_png


@pytest.fixture(scope="module")
def files(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("manners")
    save_png(folder / "photo.png", load_photo("skimage:gravel").pixels[:96, :96])
    save_detail(folder / "relief.json", Detail())
    save_detail(folder / "matter.json", Detail(mode="volume"))
    assert main(["texture", "fit", str(folder / "photo.png"), "-o", str(folder / "colour.json"), "--quiet"]) == 0
    assert main(["library", "build", "brick", "--entries", "4", "--workers", "1", "-o", str(folder / "lib"), "--quiet"]) == 0
    return folder


RESULTS: dict[str, tuple[list[str], list[str]]] = {
    "fit": (
        ["fit", "{}/photo.png", "--light", "70,50", "--evaluations", "6", "--resolution", "64", "--colour", "none", "-o", "{}/f"],
        ["detail", "report", "distance", "verdict", "evaluations"],
    ),
    "render": (["render", "{}/relief.json", "sphere", "--size", "32x32", "-o", "{}/s.png"], ["file", "columns", "rows"]),
    "relight": (
        ["relight", "{}/relief.json", "--azimuth", "0,90", "--elevation", "30", "--size", "32x32", "-o", "{}/turn"],
        ["folder", "frames", "animation"],
    ),
    "relief": (
        ["relief", "{}/photo.png", "--light", "70,50", "--size", "64", "--no-report", "-o", "{}/own"],
        ["relief", "files", "confidence", "notes"],
    ),
    "bake": (["bake", "{}/matter.json", "sphere", "--cells", "16", "-o", "{}/m.vol"], ["file", "what"]),
    "bake a mesh": (["bake", "{}/relief.json", "torus", "--cells", "16", "-o", "{}/m.ply"], ["file", "what"]),
    "compare": (["compare", "{}/photo.png", "skimage:grass", "--resolution", "96"], ["distance", "parts", "halves_of_a"]),
    "stationarize": (["stationarize", "{}/photo.png", "--size", "32", "-o", "{}/t.png"], ["tiles", "stopped"]),
    "stationarity": (["stationarity", "{}/photo.png"], ["measures", "sigma"]),
    "retrieve": (["retrieve", "{}/photo.png", "--library", "{}/lib", "--top", "1"], ["answers", "scale"]),
    "show": (["show", "{}/relief.json"], ["noise", "relief"]),
    "schema": (["schema"], ["properties"]),
    "texture fit": (["texture", "fit", "{}/photo.png", "-o", "{}/c.json"], ["file", "numbers"]),
    "texture render": (["texture", "render", "{}/colour.json", "--size", "32x32", "-o", "{}/c.png"], ["file", "columns"]),
    "texture edit": (["texture", "edit", "{}/colour.json", "--gain", "0=2", "-o", "{}/e.json"], ["file"]),
    "texture morph": (
        ["texture", "morph", "{}/colour.json", "{}/colour.json", "--steps", "2", "--size", "32x32", "-o", "{}/mm"],
        ["folder", "steps"],
    ),
    "library build": (
        ["library", "build", "brick", "--entries", "4", "--workers", "1", "-o", "{}/lib2"], ["folder", "entries", "bytes"]
    ),
    "library index": (["library", "index", "{}/lib"], ["file"]),
    "library info": (["library", "info", "{}/lib", "--check"], ["sources", "entries", "checked"]),
}  # fmt: skip


@pytest.mark.parametrize("name", RESULTS)
def test_a_result_is_one_json_text(name: str, files: Path, capsys: pytest.CaptureFixture[str]) -> None:
    words, keys = RESULTS[name]
    assert main([*(word.replace("{}", str(files)) for word in words), "--json"]) == 0
    record = json.loads(capsys.readouterr().out)
    for key in keys:
        assert key in record


def test_every_command_is_in_the_table() -> None:
    names = {c.callback.__name__ for c in app.registered_commands if c.callback}
    names |= {
        f"{group.typer_instance.info.name} {c.callback.__name__}"
        for group in app.registered_groups if group.typer_instance
        for c in group.typer_instance.registered_commands if c.callback
    }  # fmt: skip
    assert names == {name for name in RESULTS if name != "bake a mesh"}


@pytest.mark.parametrize("place", ["before", "after"])
def test_quiet_leaves_results_alone(place: str, files: Path, capsys: pytest.CaptureFixture[str]) -> None:
    words = ["texture", "render", str(files / "colour.json"), "--size", "32x32", "-o", str(files / "q.png")]
    assert main(["--quiet", *words] if place == "before" else [*words, "--quiet"]) == 0
    said = capsys.readouterr()
    assert (said.out, said.err) == (f"{files / 'q.png'}  32 x 32 pixels\n", "")


def test_quiet_and_json_still_tell_errors(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["show", "missing.json", "--json", "--quiet"]) == 2
    said = capsys.readouterr()
    assert said.out == ""
    assert "missing.json does not exist" in said.err


def test_verbose_says_how_long_it_took(files: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["show", str(files / "relief.json"), "--verbose"]) == 0
    assert "Done in" in capsys.readouterr().err
    assert main(["show", str(files / "relief.json")]) == 0
    assert "Done in" not in capsys.readouterr().err


def test_completion_can_be_shown(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SHELL", "/bin/bash")
    monkeypatch.setenv("_TYPER_COMPLETE_TEST_DISABLE_SHELL_DETECTION", "1")
    assert main(["--show-completion", "bash"]) == 0
    assert "_VOLDETAIL_COMPLETE" in capsys.readouterr().out
