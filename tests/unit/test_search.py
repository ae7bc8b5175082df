"""Solvers on functions that are known, and seeds that are derived."""

from collections.abc import Sequence

import numpy as np
import pytest
from numpy.typing import NDArray

from voldetail.fit.search import CMAES, GradientDescent, Memory, Solution, Solver, minimise
from voldetail.fit.session import derived_seed

Vector = NDArray[np.float64]
SOLVERS = [CMAES(population=10), GradientDescent()]
AIM = np.array([0.3, 0.7, 0.55, 0.2])


def bowl(vector: Vector) -> float:
    return float((np.array([1.0, 3.0, 0.5, 2.0]) * (vector - AIM) ** 2).sum())


class Counting:
    """A function of vectors that remembers what it was asked."""

    def __init__(self, function=bowl) -> None:  # type: ignore[no-untyped-def]
        self.function, self.seen, self.steps = function, [], []  # type: ignore[var-annotated]

    def __call__(self, vectors: Sequence[Vector], step: int) -> list[float]:
        self.seen += [np.array(v) for v in vectors]
        self.steps.append(step)
        return [self.function(v) for v in vectors]


def run(solver: Solver, budget: int, evaluate: Counting, **other: object) -> Solution:
    return minimise(solver, evaluate, np.full(4, 0.5), memory=Memory(0.2), seed=3, budget=budget, **other)  # type: ignore[arg-type]


@pytest.mark.parametrize("solver", SOLVERS, ids=lambda s: type(s).__name__)
def test_a_bowl_in_the_box_is_found(solver: Solver) -> None:
    evaluate = Counting()
    found = run(solver, 800, evaluate)
    assert found.vector == pytest.approx(AIM, abs=0.03)
    assert found.value < 2e-3
    assert found.value == bowl(found.vector) == min(bowl(v) for v in evaluate.seen)
    assert found.evaluations == len(evaluate.seen) <= 800
    assert all(v.min() >= 0 and v.max() <= 1 for v in evaluate.seen)
    assert evaluate.steps == list(range(len(evaluate.steps)))


@pytest.mark.parametrize("solver", SOLVERS, ids=lambda s: type(s).__name__)
def test_a_lowest_point_outside_is_met_at_the_border(solver: Solver) -> None:
    beyond = np.array([1.5, 0.4, -0.5, 0.5])
    found = run(solver, 600, Counting(lambda v: float(((v - beyond) ** 2).sum())))
    assert found.vector == pytest.approx([1.0, 0.4, 0.0, 0.5], abs=0.05)


@pytest.mark.parametrize("solver", SOLVERS, ids=lambda s: type(s).__name__)
@pytest.mark.parametrize("budget", [1, 4, 9, 10, 37, 100])
def test_the_budget_is_respected(solver: Solver, budget: int) -> None:
    evaluate = Counting()
    found = run(solver, budget, evaluate)
    assert 1 <= len(evaluate.seen) <= budget
    assert found.evaluations == len(evaluate.seen)
    assert np.isfinite(found.value)
    assert "budget" in found.status


@pytest.mark.parametrize("solver", SOLVERS, ids=lambda s: type(s).__name__)
def test_the_same_seed_is_the_same_search(solver: Solver) -> None:
    one, other = (run(solver, 60, Counting()) for _ in range(2))
    assert (one.vector == other.vector).all()
    assert one.value == other.value


def test_another_seed_is_another_search() -> None:
    start = np.full(4, 0.5)
    first, second = (minimise(CMAES(10), Counting(), start, memory=Memory(0.2), seed=seed, budget=50).vector for seed in (1, 2))
    assert (first != second).any()


def test_the_best_is_kept_though_values_rise_later() -> None:
    values = iter([5.0, 1.0, *(float(v) for v in range(2, 1000))])
    evaluate = Counting(lambda v: next(values))
    found = run(CMAES(population=10), 45, evaluate)
    assert found.value == 1.0
    assert (found.vector == evaluate.seen[1]).all()


def test_each_step_is_reported_and_can_end_the_search() -> None:
    reported: list[Solution] = []

    def on_step(solution: Solution) -> bool:
        reported.append(solution)
        return len(reported) < 3

    found = run(CMAES(population=10), 1000, Counting(), on_step=on_step)
    assert [s.evaluations for s in reported] == [10, 20, 30]
    assert [s.value for s in reported] == sorted((s.value for s in reported), reverse=True)
    assert found.status == "the search was asked to stop"


def test_numbers_that_wrap_may_leave_the_box() -> None:
    def ring(vector: Vector) -> float:
        return float(1 - np.cos(2 * np.pi * (vector[0] - 0.95)) + (vector[1] - 0.5) ** 2)

    found = minimise(CMAES(10, periodic=(0,)), Counting(ring), np.array([0.1, 0.5]), memory=Memory(0.1), seed=1, budget=400)
    assert found.vector[0] % 1.0 == pytest.approx(0.95, abs=0.02)
    assert found.vector[0] < 0.1  # the short way round, through 0


def test_a_flat_function_ends_with_a_sentence() -> None:
    for solver in SOLVERS:
        found = run(solver, 5000, Counting(lambda v: 1.0))
        assert found.evaluations < 5000
        assert "settled" in found.status or "too small" in found.status


def test_derived_seeds_are_what_they_always_were() -> None:
    # The first four bytes of SHA-256 of "0/noise/0" and so on, as a little-endian number, halved.
    assert derived_seed(0, "noise/0") == 0x5A818A86 // 2
    assert derived_seed(0, "detail") == 0x53E9142D // 2
    assert derived_seed(12345, "cover") == 0xE192F6B4 // 2
    names = [derived_seed(root, f"noise/{i}") for root in range(20) for i in range(50)]
    assert len(set(names)) == 1000
    assert all(0 <= seed < 2**31 for seed in names)


def test_what_a_search_learnt_serves_the_next() -> None:
    """On a narrow valley a search that is handed the covariance gets lower than one that starts round again."""

    def valley(v: Vector) -> float:
        along, across = v[0] + v[1] - 1.0, v[0] - v[1]
        return float(along**2 + 400.0 * (across - 0.1) ** 2 + 50.0 * (v[2] - v[3]) ** 2 + (v[2] - 0.3) ** 2)

    kept, anew = [], []
    for seed in range(5):
        first = minimise(CMAES(10), Counting(valley), np.array([0.9, 0.2, 0.8, 0.1]), memory=Memory(0.2), seed=seed, budget=150)
        assert first.memory.covariance is not None
        assert first.memory.covariance.shape == (4, 4)
        for memory, values in ((first.memory, kept), (Memory(first.memory.spread), anew)):
            values.append(minimise(CMAES(10), Counting(valley), first.vector, memory=memory, seed=seed + 100, budget=80).value)
    assert np.median(np.array(kept) / np.array(anew)) < 0.8
