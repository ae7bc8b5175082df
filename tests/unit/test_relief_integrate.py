"""Heights from slopes: exact for slopes of a height, nearest for others, seamless where asked."""

import numpy as np
import pytest

from tests.unit.relief_examples import smooth_noise
from voldetail.recover.integrate import integrate, without_plane


def staggered(height: np.ndarray, *, periodic: bool) -> tuple[np.ndarray, np.ndarray]:
    """Slopes at pixels whose neighbours' mean is the difference of heights: by elimination along each row and column."""
    p, q = np.zeros_like(height), np.zeros_like(height)
    for j in range(height.shape[1] - 1):
        p[:, j + 1] = 2 * (height[:, j + 1] - height[:, j]) - p[:, j]
    for i in range(height.shape[0] - 1):
        q[i + 1] = -2 * (height[i + 1] - height[i]) - q[i]
    return p, q


def test_a_height_comes_back_from_its_slopes() -> None:
    height = smooth_noise((40, 56), 10.0).astype(np.float64)
    p, q = staggered(height, periodic=False)
    found = integrate(p.astype(np.float32), q.astype(np.float32))
    assert np.abs(found - (height - height.mean())).max() < 1e-3


def test_it_is_the_least_squares_solution() -> None:
    """Against a dense solve of all differences of a 6 x 5 picture."""
    rng = np.random.default_rng(1)
    p, q = rng.normal(size=(2, 6, 5)).astype(np.float32)
    lines, values = [], []
    for i in range(6):
        for j in range(5):
            if j < 4:
                line = np.zeros((6, 5))
                line[i, j + 1], line[i, j] = 1, -1
                lines.append(line.ravel())
                values.append((p[i, j] + p[i, j + 1]) / 2)
            if i < 5:
                line = np.zeros((6, 5))
                line[i + 1, j], line[i, j] = 1, -1
                lines.append(line.ravel())
                values.append(-(q[i, j] + q[i + 1, j]) / 2)
    wanted = np.linalg.lstsq(np.array(lines), np.array(values), rcond=None)[0].reshape(6, 5)
    assert np.allclose(integrate(p, q), wanted - wanted.mean(), atol=1e-5)


@pytest.mark.parametrize("shape", [(32, 48), (33, 47)])
def test_a_tile_is_seamless(shape: tuple[int, int]) -> None:
    rng = np.random.default_rng(2)
    p, q = rng.normal(size=(2, *shape)).astype(np.float32)
    found = integrate(p, q, periodic=True)
    moved = integrate(np.roll(p, (5, 9), (0, 1)), np.roll(q, (5, 9), (0, 1)), periodic=True)
    assert np.allclose(np.roll(found, (5, 9), (0, 1)), moved, atol=1e-4)


def test_planes_are_taken_away() -> None:
    y, x = np.mgrid[0:30, 0:50].astype(np.float32)
    assert np.abs(without_plane(3 * x - 2 * y + 7)).max() < 1e-3
    used = np.zeros((30, 50), bool)
    used[:, :25] = True
    bent = np.where(used, x, 100.0).astype(np.float32)
    assert np.abs(without_plane(bent, used)[used]).max() < 1e-3
