"""Starting candidates: all families, evenly, inside the box, and the same for the same seed."""

from dataclasses import replace

import numpy as np
import pytest

from voldetail.detail import PAPER_NEIGHBOURS
from voldetail.fit.candidates import (
    PAPER_FREQUENCIES,
    PAPER_LACUNARITIES,
    PAPER_OCTAVES,
    Candidate,
    best_distinct,
    paper_grid,
    sampled,
)
from voldetail.fit.space import Kind, Space

SPACE = Space("solid", (1.0, 60.0), 120.0)
ROUND, LONG = (1.0, 0.0), (2.0, 0.7)


def test_every_pair_of_ranks_gets_its_share_and_every_vector_is_a_detail() -> None:
    found = sampled(SPACE, 216, 1, ROUND)
    assert len(found) == 216
    ranks = [(c.kind.first, c.kind.last) for c in found]
    assert min(ranks.count(pair) for pair in PAPER_NEIGHBOURS) >= 216 / 4 * 0.7
    assert {c.kind.fold for c in found} == {"none", "ridge", "billow"}
    assert {c.kind.envelope for c in found} == {"gaussian", "exponential"}
    assert all((c.kind.first, c.kind.last) == (1, 2) for c in found if c.kind.bordered)
    assert all((c.kind.first, c.kind.last) == (1, 50) for c in found if c.kind.stones)
    assert any(c.kind.stones for c in found)
    assert all(c.kind.bordered for c in found if c.kind.plates)
    assert any(c.kind.plates for c in found)
    for candidate in found:
        assert candidate.vector.min() >= 0
        assert candidate.vector.max() <= 1
        SPACE.decode(candidate.kind, candidate.vector)
    scales = np.log([SPACE.decode(c.kind, c.vector).noise.scale for c in found]) / np.log(60.0)
    assert np.histogram(scales, 6, (0, 1))[0].min() >= 216 / 6 * 0.7  # evenly, on the scale's own axis


def test_the_same_seed_gives_the_same_and_another_one_others() -> None:
    one, same, other = (sampled(SPACE, 40, seed, LONG) for seed in (1, 1, 2))
    assert all(a.kind == b.kind and (a.vector == b.vector).all() for a, b in zip(one, same, strict=True))
    assert not any(np.array_equal(a.vector, b.vector) for a, b in zip(one, other, strict=True))


def test_without_extensions_there_is_only_what_the_paper_has() -> None:
    for candidate in sampled(SPACE, 100, 3, ROUND, extended=False):
        kind = candidate.kind
        assert (kind.fold, kind.bordered, kind.pigment, kind.stones, kind.plates) == ("none", *[False] * 4)


def test_the_stretch_of_the_photo_is_where_some_start() -> None:
    factors = [SPACE.decode(c.kind, c.vector).noise.anisotropy for c in sampled(SPACE, 100, 3, LONG)]
    stretched = np.isclose(factors, 0.5)
    assert 30 < stretched.sum() < 70
    assert np.allclose(np.array(factors)[~stretched], 1.0)


def test_the_papers_grid_has_the_papers_sets() -> None:
    grid = paper_grid(SPACE, LONG)
    assert 500 < len(grid) < 20_000
    details = [SPACE.decode(c.kind, c.vector).noise for c in grid]
    assert {(d.first_neighbour, d.last_neighbour) for d in details} == set(PAPER_NEIGHBOURS)
    assert {c.kind.octaves for c in grid} == set(PAPER_OCTAVES) == {1, 2, 3, 4}
    assert set(PAPER_LACUNARITIES) == {1.5, 2.0, 4.0}
    assert {round(d.lacunarity, 6) for d in details} >= {1.5, 2.0, 4.0}
    assert {round(d.stripe_frequency, 6) for d in details} == set(PAPER_FREQUENCIES) == {0.0, 2.0, 4.0}
    assert {d.envelope for d in details} == {"exponential"}
    assert {round(d.angle, 6) for d in details} == {0.7}
    assert len({(c.kind, tuple(c.vector)) for c in grid}) == len(grid)


def test_a_given_amplitude_is_not_searched() -> None:
    fixed = replace(SPACE, amplitude=0.05)
    for candidate in [*sampled(fixed, 20, 1, ROUND), *paper_grid(fixed, ROUND)[:20]]:
        assert fixed.decode(candidate.kind, candidate.vector).relief.amplitude == 0.05


@pytest.mark.parametrize("count", [1, 2, 10])
def test_the_best_of_different_families(count: int) -> None:
    bumps, more, striped = (Kind(1, 2, "gaussian", 1, False), Kind(1, 2, "exponential", 3, False),
                            Kind(1, 2, "gaussian", 1, True))  # fmt: skip
    pool = [Candidate(kind, np.zeros(1), value) for kind, value in
            [(bumps, 3.0), (more, 1.0), (striped, 2.0), (bumps, 0.5), (replace(bumps, fold="ridge"), 4.0)]]  # fmt: skip
    # Octaves, envelope and pigment do not make a family: the exponential kind is beaten by its gaussian sister.
    assert [c.value for c in best_distinct(pool, count)] == [0.5, 2.0, 4.0][:count]
