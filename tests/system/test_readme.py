"""Every block of README and of the pages in docs is run, in order: README's in one folder, each page's in a folder of its own."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
GRAVEL = ROOT / "results" / "fits" / "gravel" / "detail.json"
PROMISED = {
    "fit": ("brick/report.html", "brick/sheet.png", "scene/detail.json", "lawn.png"),
    "volume": ("tufts.png", "turf.png", "turf.vol", "on-turf.png"),
    "bake": ("ring.ply",),
    "render": ("cylinder.png", "plane.exr", "turn/sheet.png"),
    "texture": ("wider.png", "ball.png", "softer.json", "morph/step_003.png"),
    "tiles": ("heat.png", "tile.png", "even/detail.json"),
    "retrieve": ("answers.png", "bricks.json", "bricks.png"),
    "compare": ("flat.png",),
    "show": (),
    "python": ("cylinder.png",),
    "relief": ("own/relief.json", "own/report.html", "own/turn/sheet.png", "own/cylinder.png"),
}  # fmt: skip

FITTING = ("fit", "tiles", "volume")
OTHERS = sorted(set(PROMISED) - set(FITTING))


def blocks(path: Path) -> list[tuple[str, str]]:
    """Language and text of the blocks of a page that are commands or programs."""
    found = re.findall(r"^```(\w+)\n(.*?)^```$", path.read_text(encoding="utf-8"), re.M | re.S)
    return [(language, text) for language, text in found if language in ("bash", "python")]


PAGES = {path.stem: path for path in sorted((ROOT / "docs").rglob("*.md")) if blocks(path)}
# The first two are the set-up of a fresh machine, which .ci/run runs as they stand.
SETUP, REST = blocks(ROOT / "README.md")[:2], blocks(ROOT / "README.md")[2:]


def folder_for_blocks(folder: Path) -> Path:
    """Fill a folder with the scenes, and a `voldetail` on the path that is the one under test."""
    shutil.copytree(ROOT / "scenes", folder / "scenes")
    command = folder / "bin" / "voldetail"
    command.parent.mkdir()
    command.write_text(f'#!/bin/sh\nexec "{sys.executable}" -m voldetail.cli "$@"\n')
    command.chmod(0o755)
    return folder


def run(language: str, text: str, folder: Path) -> None:
    program = ["bash", "-euc", text] if language == "bash" else [sys.executable, "-c", text]
    paths = f"{folder / 'bin'}{os.pathsep}{os.environ['PATH']}"
    environment = os.environ | {"PATH": paths, "PYTHONPATH": str(ROOT)}
    done = subprocess.run(program, cwd=folder, env=environment, capture_output=True, text=True, timeout=400, check=False)
    assert done.returncode == 0, done.stdout[-2000:] + done.stderr[-2000:]


def missing(folder: Path, promised: tuple[str, ...]) -> list[str]:
    return [name for name in promised if not (folder / name).is_file() or (folder / name).stat().st_size == 0]


def test_the_first_two_blocks_are_the_two_commands() -> None:
    assert [language for language, _ in SETUP] == ["bash", "bash"]
    assert all(len(text.strip().splitlines()) == 1 for _, text in SETUP)
    assert "voldetail fit skimage:" in SETUP[0][1]
    assert "pytest" in SETUP[1][1]


def test_readme_runs(tmp_path: Path) -> None:
    folder = folder_for_blocks(tmp_path)
    for language, text in REST:
        run(language, text, folder)
    promised = ("gravel/report.html", "gravel/sheet.png", "sphere.png", "grass.json", "grass.png")
    assert missing(folder, promised) == []


def test_every_page_with_blocks_says_what_they_leave() -> None:
    assert set(PROMISED) == set(PAGES)


def run_page(page: str, folder: Path) -> None:
    folder_for_blocks(folder)
    (folder / "gravel").mkdir()
    shutil.copy(GRAVEL, folder / "gravel" / "detail.json")  # in place of the quick start's, whose fit takes a minute
    for language, text in blocks(PAGES[page]):
        run(language, text, folder)
    assert missing(folder, PROMISED[page]) == []


# A class each, or each second page: a process takes a class as a whole, and two of them are to end together.


class TestPageFit:
    def test_page_runs(self, tmp_path: Path) -> None:
        run_page("fit", tmp_path)


class TestPageTiles:
    def test_page_runs(self, tmp_path: Path) -> None:
        run_page("tiles", tmp_path)


class TestPageVolume:
    def test_page_runs(self, tmp_path: Path) -> None:
        run_page("volume", tmp_path)


class TestOtherPages:
    @pytest.mark.parametrize("page", OTHERS[::2])
    def test_page_runs(self, page: str, tmp_path: Path) -> None:
        run_other(page, tmp_path)


class TestRemainingPages:
    @pytest.mark.parametrize("page", OTHERS[1::2])
    def test_page_runs(self, page: str, tmp_path: Path) -> None:
        run_other(page, tmp_path)


def run_other(page: str, folder: Path) -> None:
    run_page(page, folder)
    if page == "render":
        assert len(list((folder / "turn").glob("*.png"))) == 12 + 1  # frames and their sheet
