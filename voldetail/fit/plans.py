"""The two ways through a fit, ours and the paper's: stages that each better a pool of candidates."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from voldetail.fit.archetypes import archetypes
from voldetail.fit.candidates import Candidate, best_distinct, paper_grid, sampled
from voldetail.fit.search import GradientDescent
from voldetail.fit.session import Session, derived_seed
from voldetail.fit.space import Space
from voldetail.fit.warmstart.start import Start

Anisotropy = tuple[float, float]

Round = tuple[int, int, bool]
"""Of successive halving: candidates kept, evaluations for each, whether at full resolution."""


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


@dataclass(frozen=True)
class Effort:
    """Numbers of the default plan.

    cover: samples that cover the space; the archetypes come on top. rounds: of successive halving, candidates kept,
    evaluations for each, at full resolution or half: a family that is only badly sampled so far gets its chance, and most
    of the effort goes where it pays. last: evaluations for the winner.
    """

    cover: int
    rounds: tuple[Round, ...]
    last: int


SURFACE_EFFORT = Effort(300, ((10, 50, False), (6, 80, False), (3, 90, True), (2, 110, True)), 130)
"""15 samples for each of the 20 families of noise; tuned on the recovery cases of tests/benchmarks and six photos, for a fit
of about a minute on two cores."""

VOLUME_EFFORT = Effort(220, ((8, 40, False), (5, 60, False), (3, 80, False), (2, 50, True)), 60)
"""A picture of a volume at full resolution takes as long as ten of a relief: for a fit of under three minutes."""

STARTED_EFFORT = Effort(0, ((6, 40, False), (3, 50, True), (2, 60, True)), 100)
"""From starts that were chosen of thousands: what covering the space and its first rounds would find is there already. Tuned on
six photographs (with `starts.SPREAD`) for a fit of 20 seconds on two cores."""

WORTH_A_SEARCH = 1.4
"""Times the best start's distance that another's may be: searching further ones of other families took half of the time."""

UNSEEN_SEEDS = 3


def default_plan(space: Space, anisotropy: Anisotropy, evaluations: int | None, starts: Sequence[Start] = ()) -> Plan:
    """Return our plan: cover the space at half resolution, or compare ``starts``, then CMA-ES from ever fewer candidates.

    ``evaluations`` scales every stage; None means the tuned numbers.
    """
    effort = STARTED_EFFORT if starts else SURFACE_EFFORT if space.mode == "displacement" else VOLUME_EFFORT
    rounds = effort.rounds
    fine_rounds = [index for index, (_, _, fine) in enumerate(rounds) if fine]
    ranked = UNSEEN_SEEDS * (sum(rounds[index][0] for index in (fine_rounds[0] - 1, *fine_rounds)) + 2)
    first = [start.candidate(space) for start in starts] or archetypes(space, anisotropy)
    total = len(first) + effort.cover + sum(count * each for count, each, _ in rounds) + effort.last + ranked
    factor = 1.0 if evaluations is None else evaluations / total

    def scaled(count: int) -> int:
        return max(4, round(count * factor))

    def cover(session: Session) -> None:
        candidates = first[:: math.ceil(1.0 / factor)] if factor < 1.0 else list(first)
        if effort.cover:
            candidates += sampled(space, scaled(effort.cover), derived_seed(session.root_seed, "cover"), anisotropy)
        _compare(session, candidates)
        session.pool = best_distinct(session.pool, rounds[0][0])
        if starts:
            session.pool = [c for c in session.pool if c.value <= WORTH_A_SEARCH * session.pool[0].value]

    names = ("trying many families", "searching the better half", "refining the best three", "refining the best two")
    return Plan(
        (
            Stage("comparing reliefs of the library" if starts else "covering the space", cover),
            *(
                Stage(name, partial(_halve, rounds=rounds, index=index, scaled=scaled))
                for index, name in enumerate(names[-len(rounds) :])
            ),
            Stage("refining the best", partial(_refine_winner, budget=scaled(effort.last))),
        ),
        evaluations or total,
    )


def _halve(session: Session, rounds: Sequence[Round], index: int, scaled: Callable[[int], int]) -> None:
    """Keep the best of the pool, and search each of them further."""
    count, each, fine = rounds[index]
    session.pool = session.pool[:count]
    # Where fewer are worth it, they get what the others would have had.
    _refine_pool(session, scaled(each * count // max(len(session.pool), 1)), fine=fine)
    if fine or rounds[index + 1][2]:
        # What goes on to full resolution is chosen there: families that tie at half of it do not at full.
        _rank(session)
    else:
        session.pool.sort(key=lambda c: c.value)


def _refine_winner(session: Session, budget: int) -> None:
    before = session.pool[0]
    session.pool = [before]
    _refine_one(session, 0, budget, fine=True)
    # What was there stays in the race: the last search may have fitted its own seeds only.
    session.pool = [session.pool[0], before]
    _rank(session)


PAPER_SHARE = 0.5
"""Share of the evaluations for the coarse samples; the rest goes to gradient descent. The paper gives no numbers."""

PAPER_KEPT = 6
PAPER_EVALUATIONS = 3000


def paper_plan(space: Space, anisotropy: Anisotropy, evaluations: int | None) -> Plan:
    """Return GD10's plan: coarse samples compared at the coarse level, then gradient descent from the closest few.

    The grid has thousands of points (the paper ran for hours); where the budget is smaller, an even random part of it
    is taken.
    """
    total = evaluations or PAPER_EVALUATIONS

    def coarse(session: Session) -> None:
        grid = paper_grid(space, anisotropy)
        count = min(len(grid), max(PAPER_KEPT, int(total * PAPER_SHARE)))
        chosen = np.random.default_rng(derived_seed(session.root_seed, "grid")).permutation(len(grid))[:count]
        _compare(session, [grid[i] for i in chosen])
        session.pool = sorted(session.pool, key=lambda c: c.value)[:PAPER_KEPT]

    def descend(session: Session) -> None:
        share = max(1, (session.planned - session.evaluations) // max(len(session.pool), 1))
        for index in range(len(session.pool)):
            _refine_one(session, index, share, fine=True, solver=GradientDescent())
        session.pool.sort(key=lambda c: c.value)

    return Plan((Stage("coarse samples", coarse), Stage("gradient descent", descend)), total)


def _compare(session: Session, candidates: list[Candidate]) -> None:
    """Fill the pool with ``candidates`` and their values at half resolution, one by one: an interruption keeps them."""
    session.pool = []
    values = session.values(session.coarse, [(c.kind, c.vector) for c in candidates], session.noise_seed(0))
    for candidate, value in zip(candidates, values, strict=True):
        session.pool.append(replace(candidate, value=value))


def _refine_pool(session: Session, budget: int, *, fine: bool) -> None:
    for index in range(len(session.pool)):
        _refine_one(session, index, budget, fine=fine)


def _refine_one(session: Session, index: int, budget: int, *, fine: bool, solver: GradientDescent | None = None) -> None:
    objective = session.fine if fine else session.coarse

    def keep(candidate: Candidate) -> None:
        session.pool[index] = candidate

    session.pool[index] = session.refine(session.pool[index], objective, budget, solver, keep)
    session.save()


def _rank(session: Session) -> None:
    """Sort the pool by the mean distance under seeds that nothing was fitted to."""
    for index, candidate in enumerate(session.pool):
        values = [
            session.value(session.fine, candidate.kind, candidate.vector, session.unseen_seed(seed))
            for seed in range(UNSEEN_SEEDS)
        ]
        session.pool[index] = replace(candidate, value=float(np.mean(values)))
    session.pool.sort(key=lambda c: c.value)
