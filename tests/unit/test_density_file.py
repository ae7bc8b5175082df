"""Densities in files: written, read, refused, and the shape that one stands for."""

import struct

import numpy as np
import pytest

from voldetail.backend import mitsuba
from voldetail.errors import InputError
from voldetail.geometry.density_file import read_density, write_density
from voldetail.geometry.density_grid import DensityGrid
from voldetail.geometry.meshes import load_mesh
from voldetail.geometry.topology import signed_volume

HEADER = struct.Struct("<4s5i6f")


def ball(cells=32, radius=0.6):
    """A ball whose density goes from 1 to 0 over four cells about its radius, in a box of 2 x 2 x 2."""
    axis = (np.arange(cells) + 0.5) * 2 / cells - 1
    z, y, x = np.meshgrid(axis, axis, axis, indexing="ij")
    return np.clip(0.5 - (np.sqrt(x * x + y * y + z * z) - radius) * cells / 8, 0, 1).astype(np.float32)


def grid_of(density, lower=(-1.0, -1.0, -1.0), edge=None):
    return DensityGrid(mitsuba().Float(density.ravel()), density.shape, lower, edge or 2 / density.shape[2])


def save(path, density, *, box=(-1, -1, -1, 1, 1, 1), magic=b"VOL\x03", encoding=1, channels=1, shape=None, cut=0):
    nz, ny, nx = shape or density.shape
    data = HEADER.pack(magic, encoding, nx, ny, nz, channels, *box) + density.astype("<f4").tobytes()
    path.write_bytes(data[: len(data) - cut])
    return path


def test_there_and_back(tmp_path):
    density = np.random.default_rng(1).random((3, 4, 5)).astype(np.float32)
    write_density(tmp_path / "a.vol", grid_of(density, (0.5, -2.0, 3.0), 0.25))
    found, lower, upper = read_density(tmp_path / "a.vol")
    np.testing.assert_array_equal(found, density)
    assert lower == (0.5, -2.0, 3.0)
    assert upper == (0.5 + 5 * 0.25, -2.0 + 4 * 0.25, 3.0 + 3 * 0.25)


def test_mitsuba_reads_what_is_written(tmp_path):
    mi = mitsuba()
    density = np.random.default_rng(2).random((3, 4, 5)).astype(np.float32)
    write_density(tmp_path / "a.vol", grid_of(density))
    # An independent reader of the format: Mitsuba's own.
    np.testing.assert_array_equal(np.asarray(mi.VolumeGrid(str(tmp_path / "a.vol"))).reshape(density.shape), density)


def test_and_what_mitsuba_writes_is_read(tmp_path):
    mi = mitsuba()
    density = np.random.default_rng(3).random((6, 5, 4)).astype(np.float32)
    mi.VolumeGrid(density[..., None]).write(str(tmp_path / "a.vol"))
    np.testing.assert_array_equal(read_density(tmp_path / "a.vol")[0], density)


def test_a_ball_becomes_a_closed_mesh_of_its_size(tmp_path):
    mesh = load_mesh(save(tmp_path / "a.vol", ball()))
    assert mesh.watertight
    assert mesh.notes == ()
    assert signed_volume(mesh.vertices, mesh.faces) == pytest.approx(4 / 3 * np.pi * 0.6**3, rel=0.01)
    np.testing.assert_allclose(np.linalg.norm(mesh.vertices, axis=1), 0.6, atol=0.005)


def test_cells_need_not_be_cubes(tmp_path):
    mesh = load_mesh(save(tmp_path / "a.vol", ball(), box=(0, 0, 0, 4, 2, 2)))
    np.testing.assert_allclose(np.ptp(mesh.vertices, axis=0), [2.4, 1.2, 1.2], atol=0.01)
    np.testing.assert_allclose(mesh.vertices.mean(axis=0), [2, 1, 1], atol=0.01)


def test_matter_that_fills_its_box_is_closed_there(tmp_path):
    mesh = load_mesh(save(tmp_path / "a.vol", np.ones((16, 16, 16), np.float32)))
    assert mesh.watertight
    assert signed_volume(mesh.vertices, mesh.faces) == pytest.approx(8, rel=0.05)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"cut": 4}, "holds"),
        ({"shape": (2, 2, 2)}, "2 x 2 x 2 cells"),
        ({"shape": (0, 4, 4)}, "above 0"),
        ({"shape": (1 << 20, 1 << 20, 1 << 20)}, "coarser"),
        ({"magic": b"VOL\x02"}, "version 3"),
        ({"encoding": 3}, "encoding"),
        ({"channels": 3}, "3 channels"),
        ({"box": (0, 0, 0, 1, 1, 0)}, "no volume"),
        ({"box": (0, 0, 0, 1, 1, float("nan"))}, "no volume"),
    ],
)
def test_refused(tmp_path, change, words):
    with pytest.raises(InputError, match=words) as refused:
        load_mesh(save(tmp_path / "a.vol", np.ones((4, 4, 4), np.float32), **change))
    assert "\n" not in str(refused.value)


@pytest.mark.parametrize("value", [float("nan"), float("inf"), -0.1, 1.5])
def test_values_that_are_no_density(tmp_path, value):
    density = ball(8)
    density[3, 3, 3] = value
    with pytest.raises(InputError, match="1 of its 512"):
        load_mesh(save(tmp_path / "a.vol", density))


def test_a_density_without_a_surface(tmp_path):
    with pytest.raises(InputError, match="nothing above"):
        load_mesh(save(tmp_path / "a.vol", np.full((4, 4, 4), 0.4, np.float32)))


def test_a_file_without_a_header(tmp_path):
    (tmp_path / "a.vol").write_bytes(b"VOL")
    with pytest.raises(InputError, match="version 3"):
        load_mesh(tmp_path / "a.vol")
