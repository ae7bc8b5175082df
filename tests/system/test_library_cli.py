"""`voldetail library` as a whole: built, stopped with Ctrl-C, killed, gone on with, and told of."""

import os
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from voldetail.cli import main
from voldetail.library.index import open_index
from voldetail.library.store import open_library

BUILD = ["library", "build", "woodlines", "star", "--entries", "24"]


def files_of(folder: Path) -> dict[str, bytes]:
    return {path.relative_to(folder).as_posix(): path.read_bytes() for path in sorted(folder.rglob("*")) if path.is_file()}


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("built") / "built.vlib"
    assert main([*BUILD, "-o", str(path), "--workers", "1"]) == 0
    return path


def started(path: Path) -> subprocess.Popen[str]:
    return subprocess.Popen(
        [sys.executable, "-m", "voldetail.cli", *BUILD, "-o", str(path), "--workers", "2"], stdout=subprocess.PIPE,
        stderr=subprocess.PIPE, text=True, start_new_session=True,
        # A parent in the background may have Ctrl-C ignored, and its children with it.
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
    )  # fmt: skip


def wait_for_chunks(folder: Path, count: int, process: subprocess.Popen[str]) -> None:
    end = time.monotonic() + 60
    while len(list(folder.rglob("*.chunk"))) < count:
        assert process.poll() is None, process.communicate()
        assert time.monotonic() < end
        time.sleep(0.02)


def test_a_stopped_and_a_killed_build_go_on_to_the_same_library(built: Path, tmp_path: Path) -> None:
    path, part = tmp_path / "lib.vlib", tmp_path / "lib.vlib.part"
    process = started(path)
    wait_for_chunks(part, 1, process)
    os.killpg(process.pid, signal.SIGINT)  # as a terminal does it: to the workers too
    out, err = process.communicate(timeout=60)
    assert process.returncode == 130, out + err
    assert "of 48 entries are kept in" in err
    assert "the same command goes on." in err
    assert "Traceback" not in err
    assert not path.exists()
    kept = len(list(part.rglob("*.chunk")))
    process = started(path)
    wait_for_chunks(part, kept + 1, process)
    process.kill()
    process.communicate()
    assert not path.exists()
    assert main([*BUILD, "-o", str(path), "--workers", "1"]) == 0
    assert [p.name for p in tmp_path.iterdir()] == ["lib.vlib"]
    assert files_of(path) == files_of(built)


def test_a_library_is_told_of(built: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["library", "info", str(built), "--check"]) == 0
    shown = capsys.readouterr().out
    for words in ("woodlines", "star", "spacing, waviness", "random", "48, 16", "version 1", "current", "checked"):
        assert words in shown
    assert shown.count("yes") == 2
    copied = Path(shutil.copytree(built, tmp_path / "lib"))
    assert main(["library", "index", str(copied)]) == 0
    assert "lib/index  " in capsys.readouterr().out.replace("\\", "/")
    assert set(open_index(open_library(copied))) == {"woodlines", "star"}
    text = (copied / "zarr.json").read_text()
    (copied / "zarr.json").write_text(text.replace('"reach": 2.5', '"reach": 2.6'))
    assert main(["library", "info", str(copied)]) == 0
    assert "out of date: its descriptors" in capsys.readouterr().out
    assert main(["library", "info", str(copied), "--check"]) == 2
    assert "build it again with: voldetail library build" in capsys.readouterr().err


def test_the_answer_to_a_library_that_is_there(built: Path, capsys: pytest.CaptureFixture[str]) -> None:
    before = files_of(built)
    assert main([*BUILD, "-o", str(built)]) == 2
    assert "it is there already" in capsys.readouterr().err
    assert files_of(built) == before


def test_a_grid_is_built_whole(tmp_path: Path) -> None:
    assert main(["library", "build", "woodstreaks", "--sampling", "grid", "-o", str(tmp_path / "lib"), "--workers", "1"]) == 0
    group = open_library(tmp_path / "lib").groups["woodstreaks"]
    assert len(group.values) == 11
    sizes = [group.parameters(k)["size"] for k in range(11)]
    assert sizes == sorted(sizes)


@pytest.mark.parametrize(
    ("words", "says"),
    [
        (["brik", "--entries", "3"], "There is no model 'brik'; the nearest one is brick"),
        (["brick"], "give --entries"),
        (["brick", "--entries", "0"], "--entries"),
        (["brick", "--sampling", "grid", "--entries", "3"], "A grid is built whole"),
        (["brick", "--sampling", "sobol", "--entries", "3"], "allowed: random, grid"),
        (["brick", "--entries", "20000001"], "1 to 20000000 are allowed"),
        (["all", "--entries", "20000000"], "are needed there while building"),
        (["brick", "--entries", "3", "--workers", "2", "--scheduler", "tcp://x:1"], "leave out --workers"),
        (["brick", "--entries", "3", "-o", "none/lib"], "there is no folder none"),
        (["brick", "--entries", "3", "-o", "there", "--force"], "no library of voldetail's"),
    ],
)
def test_bad_input(
    words: list[str], says: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "there").mkdir()
    assert main(["library", "build", *([] if "-o" in words else ["-o", "lib"]), *words]) == 2
    error = capsys.readouterr().err
    assert says in error
    assert error.count("\n") == 1
    assert [p.name for p in tmp_path.iterdir()] == ["there"]
