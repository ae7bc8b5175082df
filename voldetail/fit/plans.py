"""The two ways through a fit: ours and the paper's. A plan is a list of stages that each better a pool of candidates."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from voldetail.fit.candidates import Candidate, best_distinct, paper_grid, sampled
from voldetail.fit.search import GradientDescent
from voldetail.fit.session import Session, derived_seed

Anisotropy = tuple[float, float]


@dataclass(frozen=True)
class Stage:
    """One part of a plan: a name for the user, and what it does to the session's pool."""

    name: str
    run: Callable[[Session], None]


@dataclass(frozen=True)
class Plan:
    """Stages in order and the evaluations they take together."""

    stages: tuple[Stage, ...]
    evaluations: int


DEFAULT_COARSE = 408
DEFAULT_REGIONS = 6
DEFAULT_REGION_STEPS = 80
DEFAULT_FINALISTS = 2
DEFAULT_FINALIST_STEPS = 130
DEFAULT_LAST_STEPS = 170
UNSEEN_SEEDS = 3
"""Numbers of the default plan, tuned on the recovery cases of tests/benchmarks and six photos so that a fit stays under
a minute on two cores."""


def default_plan(anisotropy: Anisotropy, evaluations: int | None) -> Plan:
    """Return our plan: cover the space at half resolution, search the best regions, refine the best few.

    ``evaluations`` scales every stage; None means the tuned numbers.
    """
    total = DEFAULT_COARSE + DEFAULT_REGIONS * DEFAULT_REGION_STEPS + DEFAULT_FINALISTS * DEFAULT_FINALIST_STEPS
    total += DEFAULT_LAST_STEPS + UNSEEN_SEEDS * (DEFAULT_REGIONS + 2 * DEFAULT_FINALISTS)
    factor = 1.0 if evaluations is None else evaluations / total

    def scaled(count: int) -> int:
        return max(4, round(count * factor))

    def cover(session: Session) -> None:
        candidates = sampled(session.space, scaled(DEFAULT_COARSE), derived_seed(session.root_seed, "cover"), anisotropy)
        session.pool = [
            replace(c, value=session.value(session.coarse, c.kind, c.vector, session.noise_seed(0))) for c in candidates
        ]
        session.pool = best_distinct(session.pool, DEFAULT_REGIONS)

    def regions(session: Session) -> None:
        _refine_pool(session, scaled(DEFAULT_REGION_STEPS), fine=False)
        _rank(session, fine=True)
        session.pool = session.pool[:DEFAULT_FINALISTS]

    def finalists(session: Session) -> None:
        _refine_pool(session, scaled(DEFAULT_FINALIST_STEPS), fine=True)
        _rank(session, fine=True)

    def last(session: Session) -> None:
        session.pool = session.pool[:1] + session.pool[:1]  # what was there, and what becomes of it
        kept = session.pool[0]
        _refine_one(session, 1, scaled(DEFAULT_LAST_STEPS), fine=True)
        session.pool = [session.pool[1], kept]
        _rank(session, fine=True)

    return Plan(
        (Stage("covering the space", cover), Stage("searching the best regions", regions),
         Stage("refining the best few", finalists), Stage("refining the best", last)),
        evaluations or total,
    )


PAPER_SHARE = 0.5
"""Share of the evaluations for the coarse samples; the rest goes to gradient descent. The paper gives no numbers."""

PAPER_KEPT = 6
PAPER_EVALUATIONS = 3000


def paper_plan(anisotropy: Anisotropy, evaluations: int | None) -> Plan:
    """Return GD10's plan: coarse samples compared at the coarse level, then gradient descent from the closest few.

    The grid has thousands of points (the paper ran for hours); where the budget is smaller, an even random part of it
    is taken.
    """
    total = evaluations or PAPER_EVALUATIONS

    def coarse(session: Session) -> None:
        grid = paper_grid(session.space, anisotropy)
        count = min(len(grid), max(PAPER_KEPT, int(total * PAPER_SHARE)))
        chosen = np.random.default_rng(derived_seed(session.root_seed, "grid")).permutation(len(grid))[:count]
        session.pool = sorted(
            (
                replace(grid[i], value=session.value(session.coarse, grid[i].kind, grid[i].vector, session.noise_seed(0)))
                for i in chosen
            ),
            key=lambda c: c.value,
        )[:PAPER_KEPT]

    def descend(session: Session) -> None:
        share = max(1, (session.planned - session.evaluations) // max(len(session.pool), 1))
        for index in range(len(session.pool)):
            _refine_one(session, index, share, fine=True, solver=GradientDescent())
        session.pool.sort(key=lambda c: c.value)

    return Plan((Stage("coarse samples", coarse), Stage("gradient descent", descend)), total)


def _refine_pool(session: Session, budget: int, *, fine: bool) -> None:
    for index in range(len(session.pool)):
        _refine_one(session, index, budget, fine=fine)


def _refine_one(
    session: Session, index: int, budget: int, *, fine: bool, solver: GradientDescent | None = None
) -> None:
    objective = session.fine if fine else session.coarse

    def keep(candidate: Candidate) -> None:
        session.pool[index] = candidate

    session.pool[index] = session.refine(session.pool[index], objective, budget, solver, keep)
    session.save()


def _rank(session: Session, *, fine: bool) -> None:
    """Sort the pool by the mean distance under seeds that nothing was fitted to."""
    objective = session.fine if fine else session.coarse
    for index, candidate in enumerate(session.pool):
        values = [
            session.value(objective, candidate.kind, candidate.vector, session.unseen_seed(seed))
            for seed in range(UNSEEN_SEEDS)
        ]
        session.pool[index] = replace(candidate, value=float(np.mean(values)))
    session.pool.sort(key=lambda c: c.value)
