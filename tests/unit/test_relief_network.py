"""The network run by NumPy: its convolutions against SciPy's, and what must not matter to it."""

from importlib.resources import files

import numpy as np
import pytest
from scipy.ndimage import correlate

from tests.unit.relief_examples import distant, lambert, smooth_noise
from voldetail.recover import network
from voldetail.recover.light_map import LightMap
from voldetail.recover.network import features, predict, weights
from voldetail.recover.network_layers import convolved, doubled, halved, multiple, rectified, run

SHAPE = (96, 112)


def photo(azimuth: float = 10.0, shape: tuple[int, int] = SHAPE) -> np.ndarray:
    light = lambert(smooth_noise(shape, 8.0, 3), azimuth, 45)
    return np.repeat(0.3 * light[..., None], 3, axis=2).astype(np.float32)


def test_convolution_is_scipys() -> None:
    rng = np.random.default_rng(0)
    x, weight, bias = (rng.normal(size=s).astype(np.float32) for s in ((13, 9, 5), (7, 5, 3, 3), (7,)))
    wanted = np.stack(
        [sum(correlate(x[..., c], weight[d, c], mode="constant") for c in range(5)) + bias[d] for d in range(7)], axis=-1
    )
    assert np.allclose(convolved(x, weight, bias), wanted, atol=1e-4)


def test_small_parts() -> None:
    x = np.array([[[-2.0], [4.0]], [[0.0], [6.0]]], np.float32)
    assert np.allclose(rectified(x)[..., 0], [[-0.2, 4], [0, 6]])
    assert halved(x)[0, 0, 0] == 2.0
    assert doubled(x).shape == (4, 4, 1)
    assert doubled(x)[1, 3, 0] == 4.0


def test_the_weights_are_small_plain_and_few() -> None:
    path = files("voldetail.recover").joinpath("weights.npz")
    assert len(path.read_bytes()) < 3_000_000
    arrays = weights()
    assert sum(v.size for v in arrays.values()) < 1_500_000
    assert all(v.dtype == np.float32 and np.isfinite(v).all() for v in arrays.values())
    assert multiple(arrays) == 16


def test_moving_the_picture_moves_the_answer() -> None:
    """By the coarsest level's step, away from the edges that the network sees."""
    rng = np.random.default_rng(1)
    x = rng.normal(size=(256, 256, 8)).astype(np.float32) * 0.2
    one, other = run(x, weights()), run(np.roll(x, 16, axis=1), weights())
    assert np.allclose(one[112:144, 112:128], other[112:144, 128:144], atol=1e-3)


def test_exposure_does_not_matter() -> None:
    light = distant(SHAPE, 10, 45)
    one, other = predict(photo(), light), predict(photo() * np.float32(0.2), light)
    assert np.allclose(one.p, other.p, atol=1e-3)
    assert np.allclose(features(photo()), features(photo() * np.float32(0.2)), atol=1e-4)


@pytest.mark.parametrize("turns", [1, 2, 3])
def test_a_quarter_turn_turns_the_answer(turns: int) -> None:
    light = distant(SHAPE, 10, 45)
    picture = photo()
    one = predict(picture, light)
    cosine, sine = ((1, 0), (0, 1), (-1, 0), (0, -1))[turns]
    x, y, z = np.moveaxis(light.direction, -1, 0)
    direction = np.rot90(np.stack([cosine * x - sine * y, sine * x + cosine * y, z], axis=-1), turns)
    other = predict(np.ascontiguousarray(np.rot90(picture, turns)), LightMap(np.ascontiguousarray(direction), light.falloff))
    p, q = np.rot90(one.p, turns), np.rot90(one.q, turns)
    assert np.allclose(other.p, cosine * p - sine * q, atol=1e-3)
    assert np.allclose(other.q, sine * p + cosine * q, atol=1e-3)


@pytest.mark.parametrize("shape", [(33, 47), (64, 65), (100, 35)])
def test_any_size(shape: tuple[int, int]) -> None:
    found = predict(photo(shape=shape), distant(shape, 200, 30))
    assert found.p.shape == found.q.shape == found.paint.shape == found.error.shape == shape
    assert all(np.isfinite(v).all() for v in (found.p, found.q, found.paint, found.error))


def test_blocks_are_the_whole(monkeypatch: pytest.MonkeyPatch) -> None:
    shape = (160, 176)
    light = distant(shape, 10, 45)
    whole = predict(photo(shape=shape), light)
    monkeypatch.setattr(network, "BLOCK", 96)
    parts = predict(photo(shape=shape), light)
    off = np.abs(parts.p - whole.p)
    assert np.sqrt(np.mean(off**2)) < 0.15 * max(np.sqrt(np.mean(whole.p**2)), 1e-3)


def test_a_near_light_has_an_answer_everywhere() -> None:
    shape = (96, 96)
    y, x = np.mgrid[0:96, 0:96] / 48.0 - 1
    offset = np.stack([-x, y, np.full(shape, 1.0)], axis=-1)
    direction = (offset / np.linalg.norm(offset, axis=-1, keepdims=True)).astype(np.float32)
    found = predict(photo(shape=shape), LightMap(direction, direction[..., 2]))
    assert np.isfinite(found.p).all()
