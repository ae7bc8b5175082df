"""Specks of albedo: their range, their size, and that they do not go with the relief."""

from types import ModuleType

import numpy as np
import pytest

from voldetail.backend import mitsuba

mi: ModuleType = mitsuba()  # before Dr.Jit is imported, which would pick an LLVM of its own

from voldetail.noise import NoiseSettings, single_octave, specks  # noqa: E402

SIDE, STEP = 400, 0.125


def plane(dims: int, factor: float = 1.0) -> tuple[object, ...]:
    """A grid of 50 x 50 specks."""
    y, x = np.mgrid[:SIDE, :SIDE] * STEP * factor
    planar = tuple(mi.Float(v.ravel().astype(np.float32)) for v in (x, y))
    return planar if dims == 2 else (*planar, mi.Float(np.full(SIDE * SIDE, 0.3, np.float32)))


@pytest.mark.parametrize("dims", [2, 3])
def test_specks_are_between_minus_one_and_one_about_zero(dims: int) -> None:
    found = specks(plane(dims), mi.UInt32(4)).numpy().astype(np.float64)
    assert np.abs(found).max() < 1
    score = found / np.sqrt(1 - found**2)
    assert abs(score.mean()) < 0.05
    assert score.std() == pytest.approx(1.0, abs=0.05)


def test_specks_have_the_size_of_their_cells() -> None:
    def length(factor: float) -> int:
        field = specks(plane(2, factor), mi.UInt32(4)).numpy().reshape(SIDE, SIDE)
        field = field - field.mean()
        rho = [float((field[:, lag:] * field[:, : SIDE - lag]).mean() / field.var()) for lag in range(40)]
        return int(np.argmax(np.array(rho) < 0.5))

    assert 1 <= length(1.0) <= 4  # half a speck is 4 steps
    assert length(0.25) == pytest.approx(4 * length(1.0), abs=4)


def test_specks_do_not_lie_where_the_relief_does() -> None:
    x = plane(3)
    relief = single_octave(x, NoiseSettings.from_ranks(3, 1, 1, gaussian=True), mi.UInt32(4), mi.Float(0), mi.Float(0)).numpy()
    one, other = specks(x, mi.UInt32(4)).numpy(), specks(x, mi.UInt32(5)).numpy()
    assert abs(np.corrcoef(one, relief)[0, 1]) < 0.03
    assert abs(np.corrcoef(one, other)[0, 1]) < 0.03
