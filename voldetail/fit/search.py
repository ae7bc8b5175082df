"""Solvers: init, ask, tell, finished. They know vectors and numbers, and nothing of images.

A solver proposes vectors (`ask`), is told their values (`tell`), and says with a sentence when it is done (`finished`).
`minimise` drives any of them, keeps the best and respects a budget, so no solver does that for itself.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Protocol

import cma
import numpy as np
from numpy.typing import NDArray

Vector = NDArray[np.float64]


@dataclass(frozen=True)
class Memory:
    """What a search hands to the next one from its end: how far to look, (n, n) covariance of the steps if it has one."""

    spread: float
    covariance: Vector | None = None


@dataclass(frozen=True)
class Solution:
    """The best vector that was seen, its value, how many evaluations it took, why the search ended, and what it learnt."""

    vector: Vector
    value: float
    evaluations: int
    status: str
    memory: Memory


class Solver(Protocol):
    """One method of search; the state it returns is its own business."""

    def init(self, start: Vector, memory: Memory, seed: int) -> Any: ...
    def ask(self, state: Any) -> list[Vector]: ...
    def tell(self, state: Any, vectors: Sequence[Vector], values: Sequence[float]) -> Any: ...
    def finished(self, state: Any) -> str | None: ...
    def memory(self, state: Any) -> Memory: ...


def minimise(
    solver: Solver,
    evaluate: Callable[[Sequence[Vector], int], list[float]],
    start: Vector,
    *,
    memory: Memory,
    seed: int,
    budget: int,
    on_step: Callable[[Solution], bool] = lambda solution: True,
) -> Solution:
    """Return the best of at most ``budget`` evaluations from ``start``.

    ``evaluate`` gets the vectors of one step and the step's number, so that one step can share its random numbers.
    ``on_step`` sees the best so far after each step; False ends the search.
    """
    state = solver.init(start, memory, seed)
    best, best_value, count, step = start, np.inf, 0, 0
    while True:
        vectors = solver.ask(state)
        short = count + len(vectors) > budget
        if short:
            # A part of a step is of no use to the solver, but where it is the first one, its vectors are all there is.
            vectors = vectors[: max(budget, 1)] if count == 0 else []
        if not vectors:
            return Solution(best, best_value, count, "the budget of evaluations was used up", solver.memory(state))
        values = evaluate(vectors, step)
        count, step = count + len(vectors), step + 1
        lowest = int(np.argmin(values))
        if values[lowest] < best_value:
            best, best_value = np.array(vectors[lowest]), float(values[lowest])
        if not on_step(Solution(best, best_value, count, "searching", solver.memory(state))):
            return Solution(best, best_value, count, "the search was asked to stop", solver.memory(state))
        if short:
            return Solution(best, best_value, count, "the budget of evaluations was used up", solver.memory(state))
        state = solver.tell(state, vectors, values)
        ended = solver.finished(state)
        if ended:
            return Solution(best, best_value, count, ended, solver.memory(state))


@dataclass(frozen=True)
class CMAES:
    """Covariance matrix adaptation (Hansen), from the package `cma`, in the unit box; some numbers may wrap.

    population: vectors a generation. periodic: indices of numbers without bounds. tolerance: spread of the values at
    which it is done.
    """

    population: int
    periodic: tuple[int, ...] = ()
    tolerance: float = 1e-4

    def init(self, start: Vector, memory: Memory, seed: int) -> Any:
        lower: list[float | None] = [None if i in self.periodic else 0.0 for i in range(len(start))]
        upper: list[float | None] = [None if i in self.periodic else 1.0 for i in range(len(start))]
        options = {
            "bounds": [lower, upper],
            "popsize": self.population,
            "seed": seed % (2**31 - 2) + 1,
            "verbose": -9,
            "tolfun": self.tolerance,
            "tolx": 1e-3,
            "verb_log": 0,
            "verb_disp": 0,
        }
        strategy = cma.CMAEvolutionStrategy(np.clip(start, 0.02, 0.98), memory.spread, options)
        if memory.covariance is not None:
            strategy.sm.C = np.array(memory.covariance)
            strategy.sm.update_now(-1)  # its eigenvectors go with it
        return strategy

    def ask(self, state: Any) -> list[Vector]:
        return [np.asarray(v) for v in state.ask()]

    def tell(self, state: Any, vectors: Sequence[Vector], values: Sequence[float]) -> Any:
        state.tell(list(vectors), list(values))
        return state

    def finished(self, state: Any) -> str | None:
        reasons = state.stop()
        return f"the search settled ({', '.join(sorted(reasons))})" if reasons else None

    def memory(self, state: Any) -> Memory:
        return Memory(float(state.sigma), np.array(state.sm.C))


@dataclass
class DescentState:
    """Where the descent is, its value, step length and what it is doing next."""

    point: Vector
    value: float
    length: float
    gradient: Vector | None
    phase: str


@dataclass(frozen=True)
class GradientDescent:
    """Gradient descent with a shrinking step, the gradient from central differences (GD10 section 7).

    The renderer's own gradient leaves out the edges of shadows, so differences under common random numbers are used.
    difference: half the distance of the two samples. smallest: step length at which it is done.
    """

    difference: float = 0.02
    smallest: float = 2e-3

    def init(self, start: Vector, memory: Memory, seed: int) -> DescentState:
        return DescentState(np.array(start), np.inf, memory.spread, None, "start")

    def ask(self, state: DescentState) -> list[Vector]:
        if state.phase == "start":
            return [state.point]
        if state.phase == "gradient":
            steps = self.difference * np.eye(len(state.point))
            return [np.clip(state.point + sign * step, 0.0, 1.0) for step in steps for sign in (1.0, -1.0)]
        assert state.gradient is not None
        direction = state.gradient / max(float(np.linalg.norm(state.gradient)), 1e-12)
        return [np.clip(state.point - state.length * f * direction, 0.0, 1.0) for f in (1.0, 0.5, 0.25)]

    def tell(self, state: DescentState, vectors: Sequence[Vector], values: Sequence[float]) -> DescentState:
        if state.phase == "start":
            return DescentState(state.point, values[0], state.length, None, "gradient")
        if state.phase == "gradient":
            gradient = np.array(values[::2]) - np.array(values[1::2])
            return DescentState(state.point, state.value, state.length, gradient, "line")
        lowest = int(np.argmin(values))
        if values[lowest] < state.value:
            return DescentState(np.array(vectors[lowest]), values[lowest], state.length, None, "gradient")
        return DescentState(state.point, state.value, state.length / 4.0, state.gradient, "line")

    def memory(self, state: DescentState) -> Memory:
        return Memory(state.length)

    def finished(self, state: DescentState) -> str | None:
        return "the gradient's step became too small to matter" if state.length < self.smallest else None
