"""One running fit: objectives, budget, seeds, the best so far, progress. Plans drive it."""

from __future__ import annotations

import hashlib
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from voldetail.detail import Detail
from voldetail.fit.candidates import Candidate
from voldetail.fit.objective import Evaluation, Objective
from voldetail.fit.search import CMAES, Memory, Solution, Solver, minimise
from voldetail.fit.space import Kind, Space, Vector

COARSE_COOLING = 0.6
"""Factor on the spread after each coarse round, at most. A few generations cannot shrink it by themselves, and families that
were not searched closely are compared by luck: with the spread left to itself, gravel lost its stones to grooves."""

POPULATION = 8
"""Vectors a generation: in a few hundred evaluations, smaller generations got lower in 8 of 12 starts of recovery cases."""


class Stopped(Exception):  # noqa: N818 - an end like any other, not an error
    """The budget of time or evaluations is used up, or the user stopped: the plan ends with what it has."""


@dataclass(frozen=True)
class Progress:
    """What a user sees while a fit runs; seconds_left is an estimate, best the lowest distance so far."""

    stage: str
    evaluations: int
    planned: int
    best: float
    seconds: float
    seconds_left: float
    picture: NDArray[np.float32] | None = None


@dataclass(frozen=True)
class State:
    """All that is needed to go on after an interruption; plain numbers, saved as JSON by the command line.

    stage: index of the stage of the plan that was running; pool: the candidates it started from, bettered since. started:
    whether it is the plan of a fit that was told where to start.
    """

    stage: int
    pool: tuple[Candidate, ...]
    evaluations: int
    seconds: float
    trace: tuple[tuple[int, float], ...] = ()
    started: bool = False


def derived_seed(root: int, name: str) -> int:
    """Return the 31-bit seed called ``name`` under ``root``."""
    digest = hashlib.sha256(f"{root}/{name}".encode()).digest()
    return int.from_bytes(digest[:4], "little") >> 1


@dataclass
class Session:
    """A fit in progress. ``coarse`` and ``fine`` are the objectives at half and full resolution.

    best: the best picture at full resolution; first: the best candidate at any, for a fit that ends within a stage.
    """

    coarse: Objective
    fine: Objective
    space: Space
    root_seed: int
    planned: int
    seed_count: int
    time_limit: float | None
    on_progress: Callable[[Progress], None]
    on_state: Callable[[State], None]
    start: State | None = None
    stage_name: str = "start"
    best: Evaluation | None = None
    first: Candidate | None = None
    best_value: float = np.inf
    stage: int = 0
    stages: int = 0
    started: bool = False
    pool: list[Candidate] = field(default_factory=list)
    trace: list[tuple[int, float]] = field(default_factory=list)

    def __post_init__(self) -> None:
        self._began = time.monotonic() - (self.start.seconds if self.start else 0.0)
        self._counted = self.start.evaluations if self.start else 0
        self._shown = 0.0
        if self.start:
            self.stage, self.pool, self.trace = self.start.stage, list(self.start.pool), list(self.start.trace)
            if self.trace:
                self.best_value = self.trace[-1][1]

    @property
    def evaluations(self) -> int:
        return self._counted + self.coarse.evaluations + self.fine.evaluations

    @property
    def seconds(self) -> float:
        return time.monotonic() - self._began

    def noise_seed(self, index: int) -> int:
        """Return the seed that every candidate of one step shares; steps go round ``seed_count`` of them."""
        return derived_seed(self.root_seed, f"noise/{index % self.seed_count}")

    def unseen_seed(self, index: int) -> int:
        """Return a seed on which nothing was fitted, for choosing between finalists."""
        return derived_seed(self.root_seed, f"unseen/{index}")

    def check(self) -> None:
        """Raise Stopped when the budget is used up; not before there is something to show."""
        if self.first is None and not self.pool:
            return
        if self.evaluations >= self.planned:
            raise Stopped("the budget of evaluations was used up")
        if self.time_limit is not None and self.seconds > self.time_limit:
            raise Stopped("the time limit was reached")

    def value(self, objective: Objective, kind: Kind, vector: Vector, seed: int) -> float:
        """Return the score at one vector times the penalty of its kind; keeps the best full-resolution picture."""
        return next(self.values(objective, [(kind, vector)], seed))

    def values(self, objective: Objective, places: Sequence[tuple[Kind, Vector]], seed: int) -> Iterator[float]:
        """Yield the `value` at each of ``places`` under one seed, in order."""

        def details() -> Iterator[Detail]:
            for kind, vector in places:
                self.check()
                yield self.space.decode(kind, vector)

        for (kind, vector), evaluation in zip(places, objective.evaluate_all(details(), seed), strict=True):
            value = evaluation.score * kind.penalty
            if self.first is None or value < self.first.value:
                self.first = Candidate(kind, vector, value)
            if objective is self.fine:
                if self.best is None or evaluation.score < self.best.score:
                    self.best = evaluation
                if evaluation.distance < self.best_value:
                    self.best_value = evaluation.distance
                    self.trace.append((self.evaluations, evaluation.distance))
            self._report()
            yield value

    def _report(self) -> None:
        now = time.monotonic()
        if now - self._shown < 0.2:
            return
        self._shown = now
        done = max(self.evaluations, 1)
        left = self.seconds / done * max(self.planned - done, 0)
        if self.time_limit is not None:
            left = min(left, max(self.time_limit - self.seconds, 0.0))
        picture = self.best.picture if self.best else None
        self.on_progress(Progress(self.stage_name, done, self.planned, self.best_value, self.seconds, left, picture))

    def save(self) -> None:
        """Hand out the state, for a later resume."""
        self.on_state(State(self.stage, tuple(self.pool), self.evaluations, self.seconds, tuple(self.trace), self.started))

    def refine(
        self,
        candidate: Candidate,
        objective: Objective,
        budget: int,
        solver: Solver | None = None,
        keep: Callable[[Candidate], None] = lambda candidate: None,
    ) -> Candidate:
        """Return ``candidate`` after a search of ``budget`` evaluations from it, by CMA-ES unless told otherwise.

        Its value is that of its best vector under the seed of that step; the plans compare finalists on unseen seeds.
        """
        kind = candidate.kind
        names = self.space.names(kind)
        chosen = solver or CMAES(population=POPULATION, periodic=(names.index("noise.angle"),))

        def evaluate(vectors: Sequence[Vector], step: int) -> list[float]:
            # Common random numbers within a step: candidates differ by their parameters alone.
            seed = self.noise_seed(candidate.spent + step)
            return list(self.values(objective, [(kind, vector) for vector in vectors], seed))

        def after(solution: Solution) -> Candidate:
            spread = solution.memory.spread
            if objective is self.coarse:
                spread = min(spread, COARSE_COOLING * candidate.spread)
            return replace(
                candidate,
                vector=solution.vector,
                value=solution.value,
                spread=spread,
                covariance=solution.memory.covariance,
                spent=candidate.spent + solution.evaluations,
            )

        def on_step(solution: Solution) -> bool:
            keep(after(solution))
            return True

        return after(
            minimise(
                chosen,
                evaluate,
                candidate.vector,
                memory=Memory(candidate.spread, candidate.covariance),
                budget=budget,
                on_step=on_step,
                seed=derived_seed(self.root_seed, f"search/{candidate.spent}"),
            )
        )
