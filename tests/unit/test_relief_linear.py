"""Linear shape from shading: exact on waves along the light, blind across it, not fooled by paint."""

import numpy as np
import pytest

from tests.unit.relief_examples import distant, lambert, slopes_of, smooth_noise
from voldetail.recover.light_map import light_map
from voldetail.recover.linear import linear_slopes, shading_share, windows
from voldetail.setup.lamp import Lamp
from voldetail.setup.view import View

SHAPE = (160, 192)
INSIDE = (slice(24, -24), slice(24, -24))


def test_a_wave_along_the_light_comes_back() -> None:
    """d = -t p, t = 0.7 at 45 degrees and a sky of 0.3: a slope of 0.1 sin gives d of -0.07 sin, and back."""
    x = np.arange(SHAPE[1])
    slope = np.broadcast_to(0.1 * np.sin(2 * np.pi * x / 16), SHAPE).astype(np.float32)
    found = linear_slopes((-0.7 * slope).astype(np.float32), distant(SHAPE, 0, 45))
    error = found.p[INSIDE] - slope[INSIDE]
    # Some is lost to the fading edges, and to what is held back of waves slower than half the photo.
    assert np.sqrt(np.mean(error**2)) < 0.05 * np.sqrt(np.mean(slope**2))
    assert np.abs(found.q[INSIDE]).max() < 0.01


@pytest.mark.parametrize("azimuth", [0.0, 37.0, 90.0, 200.0])
def test_relief_is_nearer_than_flat_for_any_light(azimuth: float) -> None:
    height = 1.2 * smooth_noise(SHAPE, 9.0, 4)
    p, q = slopes_of(height)
    light = lambert(height, azimuth, 45)
    found = linear_slopes(light / light.mean() - 1, distant(SHAPE, azimuth, 45))
    a = np.radians(azimuth)
    for x, y, least in ((np.cos(a), np.sin(a), 0.9), (-np.sin(a), np.cos(a), 0.5)):
        one, true = (found.p * x + found.q * y)[INSIDE].ravel(), (p * x + q * y)[INSIDE].ravel()
        assert np.corrcoef(one, true)[0, 1] > least


def test_paint_makes_little_relief() -> None:
    """Statistical: isotropic noise that is all paint leaves under a third of the slopes that the same noise as shading does."""
    paint = 0.2 * smooth_noise(SHAPE, 7.0, 8)
    light = distant(SHAPE, 20, 45)
    painted = linear_slopes(paint, light)
    height = 1.0 * smooth_noise(SHAPE, 7.0, 8)
    shading = lambert(height, 20, 45)
    shading = shading / shading.mean() - 1
    shaded = linear_slopes((shading * (0.2 / shading.std())).astype(np.float32), light)
    size = [float(np.sqrt(np.mean(s.p[INSIDE] ** 2 + s.q[INSIDE] ** 2))) for s in (painted, shaded)]
    assert size[0] < size[1] / 3


def test_share_of_shading_is_wieners() -> None:
    """Powers N = 2 and S = 6 of every frequency: the share is 6 c / (6 c + 2), c = cos^2."""
    wy, wx = np.meshgrid(np.linspace(-3, 3, 61), np.linspace(0, 3, 31), indexing="ij")
    frequency = np.hypot(wx, wy)
    cosine = np.where(frequency > 0, wx / np.maximum(frequency, 1e-9), 0) ** 2
    found = shading_share(np.sqrt(2 + 6 * cosine).astype(np.complex64), wx, frequency)
    many = frequency > 0.8  # slower octaves hold too few frequencies for a line
    assert np.allclose(found[many], (6 * cosine / (6 * cosine + 2))[many], atol=1e-3)


def test_windows_sum_to_one() -> None:
    for side in (33, 64, 501):
        total = np.zeros(side)
        for weight, (first, last) in windows(side):
            total[first:last] += weight
        assert np.allclose(total, 1.0)


def test_a_lamp_far_away_is_a_distant_light() -> None:
    height = smooth_noise(SHAPE, 9.0, 2)
    light = lambert(height, 30, 40)
    detail = light / light.mean() - 1
    view = View(-1, 1, -0.8, 0.8, SHAPE[1], SHAPE[0])
    far = np.array([np.cos(np.radians(30)) * np.cos(np.radians(40)), np.sin(np.radians(30)) * np.cos(np.radians(40)),
                    np.sin(np.radians(40))])  # fmt: skip
    near = light_map(Lamp(position=tuple(float(v) for v in 40 * far)), view)
    assert near.varies
    one, other = linear_slopes(detail, near), linear_slopes(detail, distant(SHAPE, 30, 40))
    assert np.corrcoef(one.p[INSIDE].ravel(), other.p[INSIDE].ravel())[0, 1] > 0.97


def test_a_light_in_front_makes_no_relief() -> None:
    found = linear_slopes(0.2 * smooth_noise(SHAPE, 7.0, 1), distant(SHAPE, 0, 90))
    assert max(np.abs(found.p).max(), np.abs(found.q).max()) < 1e-4
