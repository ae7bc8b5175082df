"""Every block of the README is run, in order, in one folder."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
BLOCKS = re.findall(r"^```(\w+)\n(.*?)^```$", (ROOT / "README.md").read_text(encoding="utf-8"), re.M | re.S)
# The first two are the set-up of a fresh machine, which .ci/run runs as they stand.
SETUP, REST = BLOCKS[:2], BLOCKS[2:]


@pytest.fixture(scope="module")
def place(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the scenes, and a `voldetail` on the path that is the one under test."""
    folder = tmp_path_factory.mktemp("readme")
    shutil.copytree(ROOT / "scenes", folder / "scenes")
    command = folder / "bin" / "voldetail"
    command.parent.mkdir()
    command.write_text(f'#!/bin/sh\nexec "{sys.executable}" -m voldetail.cli "$@"\n')
    command.chmod(0o755)
    return folder


def environment(place: Path) -> dict[str, str]:
    paths = f"{place / 'bin'}{os.pathsep}{os.environ['PATH']}"
    return os.environ | {"PATH": paths, "PYTHONPATH": str(ROOT)}


def test_the_first_two_blocks_are_the_two_commands() -> None:
    assert [language for language, _ in SETUP] == ["bash", "bash"]
    assert all(len(text.strip().splitlines()) == 1 for _, text in SETUP)
    assert "voldetail fit skimage:" in SETUP[0][1]
    assert "pytest" in SETUP[1][1]


@pytest.mark.parametrize("index", range(len(REST)), ids=[text.split("\n")[0][:40] for _, text in REST])
def test_block_runs(index: int, place: Path) -> None:
    language, text = REST[index]
    program = ["bash", "-euc", text] if language == "bash" else [sys.executable, "-c", text]
    done = subprocess.run(program, cwd=place, env=environment(place), capture_output=True, text=True, timeout=400, check=False)
    assert done.returncode == 0, done.stdout[-2000:] + done.stderr[-2000:]


def test_the_blocks_left_what_they_promise(place: Path) -> None:
    for made in ("gravel/report.html", "gravel/sheet.png", "sphere.png", "grass.json", "grass.png", "cylinder.png", "plane.exr"):
        assert (place / made).stat().st_size > 0, made
    assert len(list((place / "turn").glob("*.png"))) >= 13
