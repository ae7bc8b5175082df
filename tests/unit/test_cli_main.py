"""Exit codes and sentences: whatever goes wrong, a user reads one line."""

import errno
import io
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from voldetail import __version__
from voldetail.cli import main
from voldetail.detail import Detail, detail_from_text, detail_to_text, save_detail
from voldetail.errors import InputError
from voldetail.fit.session import Progress


@pytest.fixture
def detail(tmp_path: Path) -> Path:
    path = tmp_path / "detail.json"
    save_detail(path, Detail(name="wall [bold]"))
    return path


def test_version(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["--version"]) == 0
    assert capsys.readouterr().out == f"voldetail {__version__}\n"


def test_behind_two_dashes_every_word_is_a_file(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    save_detail(tmp_path / "--json", Detail(name="dashes"))
    monkeypatch.chdir(tmp_path)
    assert main(["show", "--", "--json"]) == 0
    assert capsys.readouterr().out.startswith("dashes\n")


@pytest.mark.parametrize("words", [["--help"], ["fit", "--help"], ["relight", "-h"], ["library", "build", "-h"], []])
def test_help(words: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    assert main(words) == 0
    assert "Usage" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("words", "says"),
    [
        (["fti"], "No such command 'fti'"),
        (["fit"], "Missing argument"),
        (["fit", "x.png", "--ligth", "1,2"], "No such option"),
        (["fit", "x.png"], "The light of the photo is missing"),
        (["fit", "x.png", "--light", "1,2"], "does not exist"),
        (["fit", "x.png", "--light", "1,2", "--seed", "many"], "--seed"),
        (["--threads", "-3", "schema"], "--threads"),
        (["show", "none.json"], "The detail file none.json does not exist"),
        (["compare", "a.png", "b.png"], "The photo a.png does not exist"),
        (["compare", "skimage:gravle", "b.png"], "the nearest one is gravel"),
        (["compare", "a.png", "b.png", "--metric", "l2"], "There is no metric 'l2'"),
    ],
)
def test_bad_input(words: list[str], says: str, capsys: pytest.CaptureFixture[str], tmp_path: Path,
                   monkeypatch: pytest.MonkeyPatch) -> None:  # fmt: skip
    monkeypatch.chdir(tmp_path)
    assert main(words) == 2
    shown = capsys.readouterr()
    assert shown.err.startswith("voldetail: ")
    assert says in shown.err
    assert shown.err.count("\n") == 1
    assert not shown.out
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("words", "says"),
    [
        (["render", "{}", "spher", "-o", "x.png"], "nearest one is sphere"),
        (["render", "{}", "sphere", "-o", "x.gif"], "has the suffix .gif"),
        (["render", "{}", "sphere", "-o", "none/x.png"], "there is no folder none"),
        (["render", "{}", "sphere", "-o", "x.png", "--light", "0,-5"], "behind the surface"),
        (["render", "{}", "sphere", "-o", "x.png", "--light", "auto"], "estimated from a photo, by fit alone"),
        (["render", "{}", "sphere", "-o", "x.png", "--light", "0,5", "--envmap", "sky.exr"], "choose one"),
        (["render", "{}", "sphere", "-o", "x.png", "--envmap", "sky.exr"], "does not exist"),
        (["render", "{}", "sphere", "-o", "x.png", "--shading", "toon"], "phong or principled"),
        (["render", "{}", "sphere", "-o", "x.png", "--size", "8"], "WIDTHxHEIGHT"),
        (["render", "{}", "sphere", "-o", "x.png", "--scale", "0"], "--scale"),
        (["relight", "{}", "--azimuth", "0:360:0", "--elevation", "30", "-o", "r"], "START:STOP:COUNT"),
        (["relight", "{}", "--azimuth", "0", "--elevation", "0", "-o", "r"], "over 0 to 90"),
        (["relight", "{}", "--azimuth", "0", "--elevation", "9", "-o", "detail.json"], "is a file"),
        (["relight", "{}", "--azimuth", "0", "--elevation", "9", "-o", "r", "--animation", "av"], "or none"),
        (["relight", "{}", "--azimuth", "0:360:360", "--elevation", "1:90:9", "-o", "r"], "3240 pictures"),
    ],
)  # fmt: skip
def test_bad_input_with_a_detail(
    words: list[str],
    says: str,
    detail: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.chdir(detail.parent)
    assert main([word.format(detail) for word in words]) == 2
    shown = capsys.readouterr()
    assert says in shown.err
    assert shown.err.count("\n") == 1
    assert [p.name for p in detail.parent.iterdir()] == ["detail.json"]


def _raising(error: BaseException) -> Callable[..., None]:
    def raise_it(*_: object) -> None:
        raise error

    return raise_it


@pytest.mark.parametrize(
    ("error", "code", "says"),
    [
        (InputError("two\nlines"), 2, "voldetail: two lines\n"),
        (OSError(errno.ENOSPC, "No space left on device", "x.png"), 2, "free some space"),
        (PermissionError(errno.EACCES, "Permission denied", "y"), 2, "Permission denied (y)"),
        (MemoryError(), 2, "not enough memory"),
        (KeyboardInterrupt(), 130, ""),
        (ZeroDivisionError("division by zero"), 1, "unexpected ZeroDivisionError: division by zero"),
    ],
)
def test_what_goes_wrong_inside(
    error: BaseException, code: int, says: str, detail: Path, capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:  # fmt: skip
    monkeypatch.setattr("voldetail.recover.files.load_any", _raising(error))
    assert main(["show", str(detail)]) == code
    shown = capsys.readouterr()
    assert says in shown.err
    assert shown.err.count("\n") <= 1
    assert "Traceback" not in shown.err
    assert main(["show", str(detail), "--debug"]) == code
    assert isinstance(error, KeyboardInterrupt) or "Traceback" in capsys.readouterr().err


def test_show_in_words(detail: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["show", str(detail)]) == 0
    shown = capsys.readouterr().out
    assert "wall [bold]" in shown
    for words in ("Amplitude", "0.05", "scene units", "Lacunarity", "matte."):
        assert words in shown


def test_show_as_json(detail: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["show", str(detail), "--json"]) == 0
    shown = capsys.readouterr().out
    assert detail_from_text(shown) == Detail(name="wall [bold]")
    assert shown == detail_to_text(Detail(name="wall [bold]"))


def test_compare_a_picture_with_itself_and_another(capsys: pytest.CaptureFixture[str]) -> None:
    import json

    assert main(["compare", "skimage:gravel", "skimage:gravel", "--json", "--resolution", "128"]) == 0
    same = json.loads(capsys.readouterr().out)
    assert main(["compare", "skimage:gravel", "skimage:grass", "--json", "--resolution", "128"]) == 0
    other = json.loads(capsys.readouterr().out)
    assert same["distance"] == 0
    assert other["distance"] > 1.5 * other["halves_of_a"]["distance"] > 0
    assert other["distance"] == pytest.approx(sum(other["parts"].values()))
    assert main(["compare", "skimage:gravel", "skimage:grass", "--metric", "published", "--resolution", "128"]) == 0
    assert "level 2" in capsys.readouterr().out


def test_plain_progress_comes_every_few_seconds() -> None:
    from rich.console import Console

    from voldetail.cli.progress import LINE_SECONDS, ProgressView

    now, stream = [0.0], io.StringIO()
    with ProgressView(Console(file=stream, width=120), clock=lambda: now[0]) as view:
        for second in range(21):
            now[0] = float(second)
            stage = "covering" if second < 18 else "refining"
            view.searching(Progress(stage, second + 1, 99, float("inf") if second < 18 else 2.5, second, 99 - second))
        view.step("writing")
    lines = stream.getvalue().splitlines()
    assert len(lines) == 18 // LINE_SECONDS + 1 + 1 + 1  # at 0, 5, 10, 15; at the new stage; the step
    assert lines[0] == "covering: 1 of 99 pictures, M not known yet, 0 s so far, about 1 min 39 s left"
    assert "best M 2.5" in lines[-2]
    assert lines[-1] == "writing ..."


def test_a_terminal_gets_a_live_line() -> None:
    from rich.console import Console

    from voldetail.cli.progress import ProgressView

    stream = io.StringIO()
    with ProgressView(Console(file=stream, width=120, force_terminal=True)) as view:
        view.searching(Progress("refining", 5, 10, 1.5, 1.0, 1.0))
        assert view.live is not None
        view.live.refresh()
    assert "5/10" in stream.getvalue()
    assert "best M 1.5" in stream.getvalue()


def test_the_parser_loads_no_renderer() -> None:
    import subprocess

    code = (
        "import sys; from voldetail.cli import main; main(['--version']);"
        "sys.exit(any(name in sys.modules for name in ('mitsuba', 'drjit', 'matplotlib', 'cma')))"
    )
    assert subprocess.run([sys.executable, "-c", code], check=False, capture_output=True).returncode == 0
