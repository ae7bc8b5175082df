"""Contact sheets and animations."""

from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from voldetail.report import write_animation, write_contact_sheet
from voldetail.report.frames import thumbnail


@pytest.mark.parametrize("count", [1, 2, 5, 12])
def test_a_contact_sheet_shows_each_frame(tmp_path: Path, count: int) -> None:
    frames = [(f"frame {i}", np.full((30, 40, 3), (0.9, 0.0, 0.0), np.float32)) for i in range(count)]
    write_contact_sheet(tmp_path / "sheet.png", frames, "a title")
    with Image.open(tmp_path / "sheet.png") as sheet:
        pixels = np.asarray(sheet.convert("RGB")).astype(int)
    red = (pixels[..., 0] > 200) & (pixels[..., 1] < 60)
    # Tiles of the fullest row and column, counted by the edges at which red begins.
    across = max(np.count_nonzero(np.diff(row.astype(int)) == 1) for row in np.pad(red, ((0, 0), (1, 0))))
    down = max(np.count_nonzero(np.diff(column.astype(int)) == 1) for column in np.pad(red, ((1, 0), (0, 0))).T)
    assert across * down >= count > across * (down - 1)


@pytest.mark.parametrize("suffix", [".gif", ".png"])
def test_an_animation_keeps_its_frames(tmp_path: Path, suffix: str) -> None:
    levels = (40, 120, 200)
    path = tmp_path / f"animation{suffix}"
    write_animation(path, [np.full((8, 12, 3), level, np.uint8) for level in levels], seconds=0.6)
    with Image.open(path) as moving:
        assert moving.n_frames == 3
        assert moving.info["loop"] == 0
        for index, level in enumerate(levels):
            moving.seek(index)
            assert np.asarray(moving.convert("L")).mean() == pytest.approx(level, abs=2)
            assert moving.info["duration"] == pytest.approx(200, abs=10)


def test_thumbnails_only_shrink() -> None:
    assert thumbnail(np.zeros((20, 30, 3), np.float32)).shape == (20, 30, 3)
    assert thumbnail(np.zeros((400, 800, 3), np.float32)).shape == (200, 400, 3)
