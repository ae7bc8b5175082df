"""The fit as a whole: from a Setup to a FitResult. Writes nothing; states and progress go to callbacks."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from voldetail.backend import mitsuba
from voldetail.detail import rounded
from voldetail.errors import InputError, VoldetailError
from voldetail.fit.autolight import resolve_light
from voldetail.fit.colour import choose_colour
from voldetail.fit.identifiability import medium_identifiability
from voldetail.fit.interval import amplitude_interval
from voldetail.fit.objective import Evaluation, Objective
from voldetail.fit.plans import Stage, default_plan, paper_plan
from voldetail.fit.provenance import Findings, signed
from voldetail.fit.reflectance import colours
from voldetail.fit.resolvable import space_of
from voldetail.fit.session import Progress, Session, State, Stopped, derived_seed
from voldetail.fit.target import load_photo_of, make_target, reduced
from voldetail.fit.warmstart.choose import starts_from, takes_starts
from voldetail.fit.warmstart.start import Start
from voldetail.image import Photo
from voldetail.library.building.build import BuildProgress
from voldetail.metric import metric_named
from voldetail.metric.anisotropy import anisotropy
from voldetail.render.build import build
from voldetail.results import AmplitudeInterval, ColourChoice, FitResult, Identifiability, LightGuess, Target
from voldetail.setup.photo import SMALLEST_ZONE
from voldetail.setup.setup import Setup

COLOUR_SEEDS = 3
"""Noise seeds that judge the tries of a colour, and as many for the relief's shading."""

INTERVAL_SEEDS = 2
"""Noise seeds for the intervals of numbers."""

FINALISTS = 3
DETAIL_SEEDS = 4
"""Seeds tried for the finished detail: one noise field of a few hundred cells can by chance be an odd one."""


def fit(
    setup: Setup,
    *,
    photo: Photo | None = None,
    start: State | None = None,
    light_guess: LightGuess | None = None,
    on_progress: Callable[[Progress], None] = lambda progress: None,
    on_state: Callable[[State], None] = lambda state: None,
    on_target: Callable[[Target], None] = lambda target: None,
    on_library_progress: Callable[[BuildProgress], None] = lambda progress: None,
    on_remark: Callable[[str], None] = lambda sentence: None,
) -> FitResult:
    """Return the Detail whose rendering has the texture statistics of the photo (GD10 section 7).

    ``start`` continues an interrupted fit from one of the states handed to ``on_state``. Ctrl-C ends the search with
    the best so far. A light "auto" is estimated first; ``light_guess`` tells that the setup's light was estimated so
    already, for the record. ``on_target`` gets what will be compared, before the search. Surfaces under the default solver
    and metric start from the reliefs of setup.fit.library instead of covering the space, and the search is then shorter;
    ``on_library_progress`` follows the making of that library, where it is not there, and ``on_remark`` gets a sentence where
    none can be had. Raises InputError for input that cannot be used.
    """
    metric_named(setup.fit.metric)
    mitsuba()
    photo = photo or load_photo_of(setup)
    setup, guess = resolve_light(setup, photo)
    light_guess = guess or light_guess
    target = make_target(setup, photo)
    on_target(target)
    starts: Sequence[Start] = ()
    if takes_starts(setup) if start is None else start.started:
        starts = starts_from(setup, target, on_progress=on_library_progress, on_remark=on_remark)
    session, stages = _session(setup, target, start, starts, on_progress, on_state)
    status, interrupted = _search(session, stages)
    final = _finish(session)
    heights = None if interrupted else _heights(setup, session, final)
    identifiability = () if interrupted else _identifiability(session, final)
    final, background = coloured(target, final)
    colour = None if interrupted else _colour(setup, session, final)
    if colour is not None:
        final = replace(final, detail=colour.detail)
    return FitResult(
        detail=signed(final, setup, target, session, Findings(status, light_guess, heights, identifiability, background, colour)),
        setup=setup,
        target=target,
        picture=final.picture,
        covered=final.covered,
        background=background,
        distance=final.distance,
        evaluations=session.evaluations,
        seconds=session.seconds,
        status=status,
        trace=tuple(session.trace),
        interrupted=interrupted,
        light_guess=light_guess,
        heights=heights,
        identifiability=identifiability,
        colour=colour,
    )


def _search(session: Session, stages: Sequence[Stage]) -> tuple[str, bool]:
    """Carry out the plan, as far as it gets; returns why it ended, and whether the user ended it."""
    status, interrupted = "the plan was carried out", False
    try:
        while session.stage < len(stages):
            session.stage_name = stages[session.stage].name
            stages[session.stage].run(session)
            session.stage += 1
            session.save()
    except Stopped as reason:
        status = str(reason)
        session.save()
    except KeyboardInterrupt:
        status, interrupted = "stopped by the user; this is the best so far", True
        session.save()
    if not session.pool and session.first is not None:
        # Stopped within the first stage: a resumed fit starts it again, and this is what there is to show.
        session.pool = [session.first]
    if not session.pool:
        raise VoldetailError("The fit was stopped before a first detail was found: let it run a little longer.")
    return status, interrupted


def _session(
    setup: Setup,
    target: Target,
    start: State | None,
    starts: Sequence[Start],
    on_progress: Callable[[Progress], None],
    on_state: Callable[[State], None],
) -> tuple[Session, tuple[Stage, ...]]:
    space = space_of(setup, target)
    stretched = anisotropy(target.luminance, target.mask)
    if setup.fit.solver == "paper":
        plan = paper_plan(space, stretched, setup.fit.evaluations)
    else:
        plan = default_plan(space, stretched, setup.fit.evaluations, starts)
    coarse = _coarse(setup, target)
    both = setup.fit.solver != "paper" and coarse.target is not target
    fine = Objective(
        target,
        build(setup, target.shape, target.zone),
        specular=setup.fit.specular,
        reduced=coarse.target if both else None,
    )
    # The budget that the user named is a limit; the plan's own is an estimate with room for rounding.
    planned = setup.fit.evaluations or plan.evaluations
    session = Session(
        coarse,
        fine,
        space,
        setup.seed,
        planned,
        setup.fit.seeds,
        setup.fit.time_limit,
        on_progress,
        on_state,
        start,
        stages=len(plan.stages),
        started=bool(starts),
    )
    return session, plan.stages


def _coarse(setup: Setup, target: Target) -> Objective:
    """Return the objective of the coarse pass: half the pixels, or as many more as the metric needs."""
    longest, shortest = max(target.mask.shape), min(target.mask.shape)
    resolution = min(longest, max(longest // 2, math.ceil(SMALLEST_ZONE * longest / shortest)))
    half = setup.model_copy(update={"photo": setup.photo.model_copy(update={"resolution": resolution})})
    surface = build(half, target.shape, target.zone)
    try:
        smaller = reduced(target, setup.fit.metric, (surface.view.rows, surface.view.columns))
    except InputError:
        # The mask leaves enough at full resolution, and too little at half.
        smaller, surface = target, build(setup, target.shape, target.zone)
    return Objective(smaller, surface, specular=setup.fit.specular)


def _finish(session: Session) -> Evaluation:
    """Return the evaluation of the winner at full resolution, under the best of a few seeds for the detail itself.

    A plan that was cut short leaves candidates compared at half resolution; the best few are compared once more.
    """
    finite = [c for c in session.pool if np.isfinite(c.value)] or session.pool
    details = [rounded(session.space.decode(c.kind, c.vector)) for c in sorted(finite, key=lambda c: c.value)[:FINALISTS]]
    if session.stage < session.stages:
        details.sort(key=lambda d: session.fine.evaluate(d, session.unseen_seed(0)).score)
    seeds = (derived_seed(session.root_seed, f"detail/{index}") for index in range(DETAIL_SEEDS))
    return min((session.fine.evaluate(details[0], seed) for seed in seeds), key=lambda e: e.score)


def coloured(target: Target, final: Evaluation) -> tuple[Evaluation, tuple[float, float, float]]:
    """Return ``final`` with the colour of its medium apart from that of what shows through it, and the latter."""
    if final.detail.medium is None:
        return final, (0.0, 0.0, 0.0)
    through = np.asarray(final.background * (1.0 - final.covered), dtype=np.float32)
    tint, behind = colours(target.pixels, final.picture - through, through, final.mask)
    reflectance = final.detail.reflectance.model_copy(update={"tint": tint})
    coloured = replace(final, detail=final.detail.model_copy(update={"reflectance": reflectance}))
    r, g, b = (final.background * v for v in behind)
    return coloured, (r, g, b)


def _heights(setup: Setup, session: Session, final: Evaluation) -> AmplitudeInterval | None:
    """Return how well the photo tells the amplitude, None where the user gave it, or would not wait for it."""
    if setup.amplitude is not None or setup.medium or final.detail.relief.amplitude <= 0:
        return None
    seeds = [session.unseen_seed(index) for index in range(INTERVAL_SEEDS)]
    try:
        return amplitude_interval(session.fine, final.detail, seeds)
    except KeyboardInterrupt:
        return None


def _identifiability(session: Session, final: Evaluation) -> tuple[Identifiability, ...]:
    """Return what the photo tells of a medium, at the coarse objective's resolution: there are a hundred pictures to make."""
    if final.detail.medium is None:
        return ()
    try:
        seeds = [session.unseen_seed(index) for index in range(INTERVAL_SEEDS)]
        return medium_identifiability(session.coarse, final.detail, seeds)
    except KeyboardInterrupt:
        return ()


def _colour(setup: Setup, session: Session, final: Evaluation) -> ColourChoice | None:
    """Return the colour that the user asked for, None where nobody would wait for it."""
    if setup.colour == "none" or final.detail.medium is not None:
        return None
    judges, shading = (
        [derived_seed(session.root_seed, f"{name}/{index}") for index in range(COLOUR_SEEDS)] for name in ("colour", "shading")
    )
    try:
        return choose_colour(session.fine, final.detail, setup.colour, judges, shading, setup.photo.name[:200])
    except KeyboardInterrupt:
        return None
