"""`voldetail bake`: the grid of densities, and an object that is one."""

import numpy as np
import pytest

from voldetail.apply import bake, render
from voldetail.cli import main
from voldetail.detail import Detail, save_detail, with_values
from voldetail.errors import InputError
from voldetail.geometry.density_file import read_density

SOLID = with_values(Detail(mode="volume"), {"relief.amplitude": 0.1, "noise.scale": 4.0})
CLOUD = with_values(Detail(), {"medium.thickness": 0.4, "medium.exponent": 2.0, "relief.amplitude": 0.2, "noise.scale": 3.0})


def test_bare_solid_ball_has_its_volume():
    grid = bake(with_values(SOLID, {"relief.amplitude": 0.0}), "sphere", cells=48)
    assert grid.edge == pytest.approx(2 / 48)
    assert grid.array().sum() * grid.edge**3 == pytest.approx(4 / 3 * np.pi, rel=0.01)


def test_relief_only_adds():
    bare, grown = (bake(with_values(SOLID, {"relief.amplitude": a}), "sphere", cells=48).array().sum() for a in (0.0, 0.1))
    assert bare * 1.02 < grown < bare * 1.1**3


def test_cells_of_a_medium_are_those_asked_for():
    assert bake(CLOUD, "sphere", cells=32).edge == pytest.approx(2 / 32)


@pytest.mark.parametrize("cells", [15, 1025, -3])
def test_number_of_cells(cells):
    with pytest.raises(InputError, match="number of cells"):
        bake(CLOUD, cells=cells)


def test_displacement_has_no_density():
    with pytest.raises(InputError, match="displaces"):
        bake(Detail())


def test_what_is_baked_is_a_shape_again(tmp_path, capsys):
    save_detail(tmp_path / "d.json", SOLID)
    bare = with_values(SOLID, {"relief.amplitude": 0.0})
    save_detail(tmp_path / "bare.json", bare)
    ball = tmp_path / "ball.vol"
    assert main(["bake", str(tmp_path / "bare.json"), "sphere", "-o", str(ball), "--cells", "64"]) == 0
    assert "ball.vol" in capsys.readouterr().out
    assert read_density(ball)[0].max() == 1.0
    whole = render(SOLID, "sphere", size=(96, 96))
    again = render(SOLID, ball, size=(96, 96))
    # The ball of the file is that of the program within a part of a cell: the same relief, the same picture.
    assert np.abs(whole - again).mean() < 0.02 * whole.max()
    assert np.corrcoef(whole.ravel(), again.ravel())[0, 1] > 0.97


def test_bad_words(tmp_path, capsys):
    save_detail(tmp_path / "d.json", SOLID)
    assert main(["bake", str(tmp_path / "d.json"), "sphere", "-o", str(tmp_path / "a.ply")]) == 2
    assert ".vol" in capsys.readouterr().err
    (tmp_path / "bad.vol").write_bytes(b"VOL\x03" + bytes(100))
    assert main(["render", str(tmp_path / "d.json"), str(tmp_path / "bad.vol"), "-o", str(tmp_path / "a.png")]) == 2
    error = capsys.readouterr().err
    assert error.count("\n") == 1
    assert "density file" in error
