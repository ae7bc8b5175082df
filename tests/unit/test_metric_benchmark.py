"""The metric table's own tools: phases that leave the spectrum, scores of an order, distances shared between references."""

import numpy as np
import pytest
from skimage import data

from tests.benchmarks import texture_families as families
from tests.benchmarks import texture_pictures as pictures
from tests.benchmarks.metric_table import retrieval
from tests.benchmarks.searched_decoys import KINDS, RANGES, detail_at
from tests.benchmarks.yardsticks import YARDSTICKS, distances, reference
from voldetail.image import to_linear
from voldetail.metric.layers import layers


def crop(name: str, y: int = 0, side: int = 64) -> np.ndarray:
    return to_linear(getattr(data, name)()[y : y + side, :side] / np.float32(255))


def test_phases_turn_and_the_spectrum_stays() -> None:
    encoded = np.random.default_rng(1).random((32, 32))
    path = families._phases(encoded, np.random.default_rng(2).standard_normal((32, 32)))
    assert path[0] == pytest.approx(encoded)
    # The few frequencies that are their own conjugates can be real only, and lose what turns out of the plane.
    kept = [np.abs(np.abs(np.fft.fft2(p)) - np.abs(np.fft.fft2(encoded))) > 1e-6 for p in path]
    assert max(int(k.sum()) for k in kept) <= 4
    gaps = [np.abs(p - encoded).mean() for p in path]
    assert np.all(np.diff(gaps) > 0)


def test_an_order_is_scored_by_rank_and_by_step(monkeypatch: pytest.MonkeyPatch) -> None:
    family = families.Family("one", crop("gravel"), [crop("gravel")] * 7)
    up = list(range(7))
    for ways, rank, steps in ((up, 1, 100), (up[::-1], -1, 0), ([0, 2, 1, 3, 5, 4, 6], 0.929, 66.7)):
        fed = iter(ways)
        monkeypatch.setattr("tests.benchmarks.yardsticks.Reference.distance", lambda self, picture, fed=fed: next(fed))
        found = families.order([family], "tone")
        # Spearman: 1 - 6 * (1 + 1 + 1 + 1) / (7 * 48) = 0.929
        assert found["all"] == found["one"] == {"rank": rank, "steps": steps}


def test_retrieval_counts_first_places_and_precision() -> None:
    owners = ["a", "a", "b", "b"]
    table = np.array([[0.0, 1.0, 2.0, 3.0], [5.0, 1.0, 0.0, 4.0]])
    # b's own second crop comes second of three: precision 1/2.
    assert retrieval(table, ["a", "b"], owners) == {"rank1": 50.0, "map": 75.0}


@pytest.mark.parametrize("metric", YARDSTICKS)
def test_distances_from_many_references_are_those_from_each(metric: str) -> None:
    references = [reference(crop(name), metric) for name in ("gravel", "grass")]
    other = crop("gravel", 100)
    assert distances(references, layers(other)) == pytest.approx([one.distance(other) for one in references], rel=1e-6)


def test_searched_details_have_what_the_vector_says() -> None:
    low, high = (detail_at(np.full(len(RANGES), unit), KINDS[0], 3) for unit in (0.0, 0.999))
    assert low[0].noise.curve == (0.0,) * 11
    assert min(high[0].noise.curve) == pytest.approx(0.999)
    assert (low[0].noise.octaves, high[0].noise.octaves) == (1, 3)
    assert low[1].direction == pytest.approx((np.cos(np.radians(4)), 0, np.sin(np.radians(4))))
    assert low[0].relief.amplitude * low[0].noise.scale == pytest.approx(0.03, rel=1e-4)


def test_eight_bits_come_back_as_they_went() -> None:
    values = np.arange(256, dtype=np.uint8).reshape(16, 16)
    once = pictures.from_8_bits(values)
    assert np.array_equal(pictures.in_8_bits(once), once)
