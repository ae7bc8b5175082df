"""Descriptors as vectors and the nearest of a table: W2 in closed form, turns and swaps, and retrieval of known pictures."""

import numpy as np
import pytest
from scipy import linalg, stats

from voldetail.errors import InputError
from voldetail.library import (
    Entries,
    distance,
    entries,
    entry,
    grid_values,
    nearest,
    published_w_global,
    random_values,
    swapped,
    table,
    turned,
    vector_of,
    weights,
)
from voldetail.library.vectors import LENGTH, ORIENTED, scales
from voldetail.metric import gabor
from voldetail.metric.layers import Layers
from voldetail.texture.structures import MODELS, structure

SIDE = 128
"""Pixels of pictures here: the smallest power of two on which all scales fit."""


def random_table(count: int, seed: int = 0) -> np.ndarray:
    return np.random.default_rng(seed).random((count, LENGTH)).astype(np.float32)


@pytest.fixture(scope="module")
def library() -> list[Entries]:
    return [entries(MODELS[name], 0, 40, side=SIDE) for name in ("perlin", "brick", "rings")]


def test_the_vector_holds_what_the_metric_measures_with_its_weights() -> None:
    pictures = [structure(MODELS[name], size=SIDE) for name in ("brick", "rings")]
    a, b = (gabor.measure(Layers((s,), (None,)), {}) for s in pictures)
    u, v = (vector_of(s) for s in pictures)
    assert u.shape == (750,)
    expected = sum(float(gabor.apart(a[part], b[part], gabor.weights()[part])) for part in gabor.NAMES)
    assert distance(u, v) ** 2 == pytest.approx(expected, rel=1e-5)
    by_scale = [np.sum((weights() * (u - v).astype(float))[scales() == scale] ** 2) for scale in range(gabor.SCALES)]
    for scale, found in enumerate(by_scale):
        part = f"scale {scale}"
        assert found == pytest.approx(float(gabor.apart(a[part], b[part], gabor.weights()[part])), rel=1e-5)


def test_the_distance_of_two_gaussians_is_their_wasserstein_distance() -> None:
    """d^2 of one entry's mean and deviation: by quantile functions, and by the general formula for covariances."""
    (m, s), (n, t) = (0.3, 0.2), (0.55, 0.05)
    u = np.zeros(LENGTH)
    v = u.copy()
    # Mean and deviation of the first oriented response of scale 1.
    mean = int(np.flatnonzero(scales() == 1)[2])
    deviation = mean + (LENGTH - ORIENTED) // 2
    u[[mean, deviation]], v[[mean, deviation]] = (m, s), (n, t)
    found = (distance(u, v) / weights()[mean]) ** 2
    p = (np.arange(200_000) + 0.5) / 200_000
    assert found == pytest.approx(np.mean((stats.norm.ppf(p, m, s) - stats.norm.ppf(p, n, t)) ** 2), rel=1e-4)
    root = linalg.sqrtm(np.array([[s * t * s * t]]))[0, 0]
    assert found == pytest.approx((m - n) ** 2 + s * s + t * t - 2 * root, rel=1e-9)


def test_the_published_weight_is_the_sum_of_the_others() -> None:
    assert published_w_global() == pytest.approx(np.sum(weights()[2:]) / 2)
    assert weights(published_w_global())[:2] == pytest.approx([published_w_global()] * 2)
    assert len(weights()) == 750


def test_a_quarter_turn_moves_orientations_by_eight() -> None:
    for name in ("brick", "rings", "woodlines"):
        s = structure(MODELS[name], size=SIDE)
        u, v = vector_of(s), vector_of(np.ascontiguousarray(np.rot90(s)))
        # The pixels at which responses are evaluated are not symmetric, so not 0.
        assert distance(turned(u, 8), v) < 0.03
        assert distance(u, v) > 10 * distance(turned(u, 8), v)
        assert np.array_equal(turned(turned(u, 8), 8), u)


def test_turning_is_a_group_of_sixteen() -> None:
    u = random_table(1)[0]
    assert np.array_equal(turned(u, 16), u)
    assert np.array_equal(turned(turned(u, 5), -5), u)
    assert np.array_equal(turned(u, 3)[ORIENTED + 3], u[ORIENTED])
    assert np.array_equal(turned(u, 3)[:ORIENTED], u[:ORIENTED])


def test_swapping_is_the_vector_of_the_swapped_structure_and_its_own_inverse() -> None:
    s = structure(MODELS["rings"], size=SIDE)
    assert swapped(vector_of(s)) == pytest.approx(vector_of(1 - s), abs=2e-6)
    assert swapped(swapped(vector_of(s))) == pytest.approx(vector_of(s), abs=1e-7)


def brute(vectors: np.ndarray, query: np.ndarray, w: np.ndarray) -> np.ndarray:
    """D (N, 16, 2) over turns of the entries and orders of the query's tones, as equation 6 is written."""
    w2 = w * w
    found = np.empty((len(vectors), 16, 2))
    for step in range(16):
        moved = turned(vectors, step).astype(np.float64)
        for order, asked in enumerate((query, swapped(query))):
            found[:, step, order] = np.sqrt(np.sum(w2 * (moved - asked.astype(np.float64)) ** 2, axis=1))
    return found


@pytest.mark.parametrize("w_global", [gabor.GLOBAL, published_w_global(), 0.0])
@pytest.mark.parametrize("count", [1, 5, 300, 3000])
def test_the_search_is_exact(count: int, w_global: float) -> None:
    vectors, query = random_table(count), random_table(1, seed=1)[0]
    # Some near ones among them, turned and swapped, so that outlines have something to rule out.
    for k in range(0, count, 20):
        near = turned(swapped(query) if k % 3 else query, k % 16)
        vectors[k] = near + np.float32(0.002) * (k % 7) * random_table(1, seed=k)[0]
    expected = brute(vectors, query, weights(w_global))
    found = nearest(table(vectors, w_global), query)
    best = expected.min(axis=(1, 2))
    assert [match.distance for match in found] == pytest.approx(np.sort(best)[:8].tolist(), rel=1e-6, abs=1e-5)
    for match in found:
        step = round(match.rotation * 16 / np.pi)
        assert expected[match.entry, step, int(match.swapped)] == pytest.approx(match.distance, rel=1e-6, abs=1e-5)
    as_it_lies = nearest(table(vectors, w_global), query, rotations=False, swap=False)
    assert [m.distance for m in as_it_lies] == pytest.approx(np.sort(expected[:, 0, 0])[:8].tolist(), rel=1e-6, abs=1e-5)


def test_scales_that_a_small_picture_lacks_are_left_out() -> None:
    vectors = random_table(50)
    query = vectors[7].copy()
    query[scales() >= 4] = np.nan
    found = nearest(table(vectors), query, top=50)
    assert (found[0].entry, found[0].distance) == (7, 0.0)
    w = np.where(scales() >= 4, 0, weights())
    expected = brute(vectors, np.nan_to_num(query), w).min(axis=(1, 2))
    assert [m.distance for m in found] == pytest.approx(np.sort(expected).tolist(), rel=1e-6)
    small = vector_of(structure(MODELS["brick"], size=64))
    assert np.isnan(small).any()
    assert np.isfinite([m.distance for m in nearest(table(vectors), small)]).all()


def test_an_entry_is_the_same_whoever_computes_it(library: list[Entries]) -> None:
    brick = library[1]
    again = entries(MODELS["brick"], 10, 2, side=SIDE)
    assert np.array_equal(again.values, brick.values[10:12])
    assert np.array_equal(again.vectors, brick.vectors[10:12])
    values, vector = entry(MODELS["brick"], 11, side=SIDE)
    assert list(values.values()) == brick.values[11].tolist()
    assert np.array_equal(vector, brick.vectors[11])
    assert random_values(MODELS["brick"], 11, seed=1) != values
    # Written down once: a change of these numbers makes every stored library wrong.
    assert random_values(MODELS["woodstreaks"], 3)["size"] == pytest.approx(WOODSTREAKS_3, rel=1e-12)


WOODSTREAKS_3 = 3.236088735823123


def test_random_entries_stay_in_range_and_grids_count_through() -> None:
    for model in MODELS.values():
        for k in range(50):
            model.checked(random_values(model, k))
        assert grid_values(model, 0) == {p.key: p.stop(0) for p in model.parameters}
        assert grid_values(model, model.grid_size - 1) == {p.key: p.stop(p.stops - 1) for p in model.parameters}
    every = {tuple(grid_values(MODELS["woodlines"], k).values()) for k in range(121)}
    assert len(every) == 121


def test_known_pictures_are_retrieved_with_their_turn_and_order(library: list[Entries]) -> None:
    """Pictures of entries with another seed, turned and swapped: the entry is among the first of 120."""
    names = [part.model for part in library]
    searched = table(np.concatenate([part.vectors for part in library]))
    rng = np.random.default_rng(0)
    ranks, models, turns = [], [], []
    for k in range(0, 120, 5):
        name, step, swap = names[k // 40], int(rng.integers(16)), bool(rng.integers(2))
        s = structure(MODELS[name], random_values(MODELS[name], k % 40), SIDE, rotation=step * np.pi / 16, seed=1)
        found = nearest(searched, vector_of(1 - s if swap else s), top=120)
        rank = [match.entry for match in found].index(k)
        ranks.append(rank)
        models.append(found[0].entry // 40 == k // 40)
        if name == "brick":  # round blotches and rings have no direction to find again
            turns.append(round(found[rank].rotation * 16 / np.pi) == step)
    assert np.median(ranks) == 0
    assert np.mean(np.array(ranks) < 8) >= 0.9
    assert np.mean(models) >= 0.9
    assert np.mean(turns) >= 0.85


@pytest.mark.parametrize(
    ("call", "complaint"),
    [
        (lambda: table(np.zeros((0, LENGTH))), "one entry or more"),
        (lambda: table(np.zeros((3, 4))), "has the shape"),
        (lambda: table(np.full((3, LENGTH), np.nan)), "NaN or infinite"),
        (lambda: weights(-1.0), "at least 0"),
        (lambda: nearest(table(random_table(2)), np.zeros(3)), "has the shape"),
        (lambda: nearest(table(random_table(2)), np.full(LENGTH, np.nan)), "describe the picture again"),
        (lambda: nearest(table(random_table(2)), np.zeros(LENGTH), top=0), "at least one"),
        (lambda: vector_of(np.zeros((8, 8))), "at least 32"),
        (lambda: vector_of(np.full((40, 40), np.inf)), "NaN or infinite"),
        (lambda: vector_of(np.zeros((40, 40)), np.zeros((4, 4), bool)), "The mask has the shape"),
        (lambda: vector_of(np.zeros((40, 40)), np.zeros((40, 40), bool)), "leaves no pixel"),
        (lambda: vector_of(np.zeros((40, 40)), np.eye(40, dtype=bool)), "finest filter"),
        (lambda: entries(MODELS["star"], 0, 0), "at least one"),
        (lambda: entries(MODELS["star"], -1, 1), "counted from 0"),
        (lambda: grid_values(MODELS["star"], 44), "44 entries"),
        (lambda: random_values(MODELS["star"], 0, seed=-1), "The seed is -1"),
    ],
)
def test_what_cannot_be_compared_is_refused(call: object, complaint: str) -> None:
    with pytest.raises(InputError, match=complaint):
        call()  # type: ignore[operator]


def test_one_broken_query_entry_is_refused() -> None:
    query = random_table(1)[0]
    query[ORIENTED + 3] = np.nan
    with pytest.raises(InputError, match="describe the picture again"):
        nearest(table(random_table(2)), query)
