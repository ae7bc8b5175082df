"""The library that a setup names, opened or made, and the starts that it has for a photo."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from pathlib import Path

from voldetail.errors import InputError
from voldetail.fit.warmstart.light import direction_at_zone
from voldetail.fit.warmstart.nearest import nearest_reliefs
from voldetail.fit.warmstart.source import ELEVATIONS, ENTRIES, ReliefSource
from voldetail.fit.warmstart.start import Start
from voldetail.library.building.build import BuildProgress
from voldetail.library.cache import cached
from voldetail.library.groups import Series
from voldetail.library.store import Library, open_library
from voldetail.results import Target
from voldetail.setup.setup import Setup
from voldetail.setup.view import view_of

FEWEST_FOR_LIBRARY = 500
"""Evaluations below which a library is not made for a fit: that takes longer than the fit."""

TOP = 160
"""Starts that a fit compares itself: among the nearest hundred the library's order says nothing more (rank correlation with the
fit's own comparison 0.1 on 14 photographs), and comparing one takes 10 ms."""


def takes_starts(setup: Setup) -> bool:
    """Whether a fit of ``setup`` is told where to start: the default one of a relief, unless it is to be a short one."""
    settings = setup.fit
    usual = setup.mode == "displacement" and settings.solver == "default" and settings.metric == "combined"
    short = settings.library == "auto" and settings.evaluations is not None and settings.evaluations < FEWEST_FOR_LIBRARY
    return usual and not short and settings.library != "none"


def starts_from(
    setup: Setup,
    target: Target,
    *,
    on_progress: Callable[[BuildProgress], None] = lambda progress: None,
    on_remark: Callable[[str], None] = lambda sentence: None,
) -> tuple[Start, ...]:
    """Return where a fit of ``setup`` may start: the reliefs of its library nearest to the photo under its light.

    setup.fit.library: "auto", which is made in the user's cache where it is not there, for the light's elevation alone; "none";
    or the path of one. No starts where the mask leaves too little of the zone at the library's size, and where the cache cannot
    be written, which ``on_remark`` is told. Raises InputError for a library by its path that cannot be used.
    """
    named = setup.fit.library
    if named == "none":
        return ()
    view = view_of(setup.camera, target.shape, target.zone, setup.photo.resolution)
    elevation = math.degrees(direction_at_zone(target.lamp, view)[1])
    if named == "auto":
        nearest = min(ELEVATIONS, key=lambda at: abs(at - elevation))
        source = ReliefSource(nearest)
        try:
            series = cached([source], ENTRIES, f"reliefs-{nearest}", on_progress=on_progress).series[source.name]
        except InputError as refused:
            # The user asked for a fit and not for a library: a home that is read only is no reason to have none.
            on_remark(f"Searching without a library of reliefs, which takes longer: {refused}")
            return ()
    else:
        series = _nearest_series(open_library(Path(named)), elevation)
    try:
        return nearest_reliefs(target, setup, series, TOP)[1]
    except InputError:
        return ()


def _nearest_series(library: Library, elevation: float) -> Series:
    """The series whose light is nearest, if it is of this voldetail's reliefs."""
    where = f"The library {library.header.path}"
    if not library.series:
        raise InputError(f"{where} has no reliefs but structures; give one made by voldetail library build relief.")

    def apart(series: Series) -> float:
        at = series.definition.get("elevation")
        return abs(float(at) - elevation) if isinstance(at, (int, float)) else math.inf

    chosen = min(library.series.values(), key=apart)
    at = chosen.definition.get("elevation")
    if not isinstance(at, int) or dict(chosen.definition) != ReliefSource(at, chosen.seed).definition:
        raise InputError(
            f"{where} is out of date: its reliefs are not this voldetail's; build it again with: "
            f"voldetail library build relief -o {library.header.path} --force"
        )
    return chosen


def elevations_of(names: Sequence[str]) -> list[int]:
    """Return the elevations that words on the command line name: "relief" is all, "relief-40" one.

    Raises InputError for another.
    """
    by_name = {f"relief-{at}": at for at in ELEVATIONS}
    elevations: list[int] = []
    for name in names:
        if not name.startswith("relief"):
            raise InputError(f"A library has either structures or reliefs; build one for {name[:60]!r} apart.")
        if name != "relief" and name not in by_name:
            raise InputError(f"There are no reliefs {name[:60]!r}; relief (all) and {', '.join(by_name)} are known.")
        elevations += list(ELEVATIONS) if name == "relief" else [by_name[name]]
    return list(dict.fromkeys(elevations))
