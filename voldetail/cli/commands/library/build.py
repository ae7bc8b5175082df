"""`voldetail library build`: procedural textures or reliefs, drawn once, for `voldetail retrieve` and fits."""

from __future__ import annotations

import shutil
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from voldetail.cli.building import teller
from voldetail.cli.console import output, remarks, result
from voldetail.cli.library_words import make_index, size_on_disk
from voldetail.errors import InputError
from voldetail.records.nearest import nearest

if TYPE_CHECKING:
    from voldetail.library.building.build import BuildProgress
    from voldetail.library.building.source import Source

ALL = "all"
SAMPLINGS = ("random", "grid")
MOST_WORKERS = 1024
PROJECTED = 1_000_000
"""Entries, the largest databases of the paper's table 2 that are sampled at random."""


def build(
    what: Annotated[
        list[str],
        typer.Argument(metavar="WHAT...", help="Names of structure models, or all; or relief, for fits to start from."),
    ],
    out: Annotated[Path, typer.Option("--output", "-o", metavar="LIB", help="The library, a folder.")],
    count: Annotated[
        int | None, typer.Option("--entries", min=1, help="Entries of each; a grid has its own number, reliefs have 4000.")
    ] = None,
    sampling: Annotated[str, typer.Option(help="random or grid: how parameters are spread over their ranges.")] = "random",
    seed: Annotated[int, typer.Option(min=0, help="The root of all random numbers.")] = 0,
    workers: Annotated[int | None, typer.Option(min=1, max=MOST_WORKERS, help="Processes; default: a core each.")] = None,
    scheduler: Annotated[
        str | None, typer.Option(metavar="ADDRESS", help="A Dask scheduler whose workers compute, e.g. tcp://host:8786.")
    ] = None,
    force: Annotated[bool, typer.Option("--force", help="Replace the library that is there.")] = False,
    indexed: Annotated[bool, typer.Option("--index", help="Make its index as well, see library index.")] = False,
) -> None:
    """Make many pictures of procedural textures, or of reliefs, and keep their parameters and descriptors.

    relief is a series for each of nine elevations of the light, relief-40 that of one.

    Ctrl-C keeps what is computed; the same command goes on.
    """
    from voldetail.cli.progress import ProgressView
    from voldetail.library.building.build import build as made
    from voldetail.library.building.build import check_output, part_of
    from voldetail.library.building.plan import Plan
    from voldetail.report.facts import duration

    if scheduler is not None and workers is not None:
        raise InputError("--workers and --scheduler were both given; a scheduler has its own workers, so leave out --workers.")
    sources = sources_of(what, sampling, seed)
    counts = _counts(sources, count)
    plan = Plan(tuple(sources), tuple(counts))
    check_output(out, force)
    _check_room(out, plan.bytes, part_of(out))
    kind = "series of reliefs" if plan.measure == "reliefs" else "models" if len(sources) > 1 else "model"
    of = f"{plan.entries} entries of {len(sources)} {kind}"
    remarks().print(f"{of}, {size_on_disk(plan.bytes)} on disk and twice that while building.", markup=False, soft_wrap=True)
    if plan.measure == "reliefs":
        from voldetail.cli.threads import use_threads

        use_threads()
    last: list[BuildProgress] = []
    with ProgressView(remarks()) as view:
        tell = teller(view, last)
        if part_of(out).is_dir():
            view.step("reading what is computed already")
        try:
            made(sources, counts, out, workers=workers, scheduler=scheduler, force=force, on_progress=tell)
        except KeyboardInterrupt:
            done = last[-1].done if last and last[-1].stage == "computing" else plan.entries
            remarks().print(
                f"{done} of {plan.entries} entries are kept in {part_of(out)}; the same command goes on.", markup=False,
                soft_wrap=True,
            )  # fmt: skip
            raise
    end = last[-1]
    speed = ""
    if end.rate:
        speed = f": {end.rate:.3g} entries a second, a million would take {PROJECTED / end.rate / 3600:.2g} hours here"
    record: dict[str, object] = {"folder": str(out), "entries": plan.entries, "bytes": plan.bytes, "seconds": end.seconds}
    words = f"{out}  {plan.entries} entries, {size_on_disk(plan.bytes)}, {duration(end.seconds)}{speed}"
    if indexed:
        output().print(words, markup=False, soft_wrap=True)
        file, words = make_index(out)
        record["index"] = str(file)
    result(record, words)


def sources_of(what: list[str], sampling: str, seed: int) -> list[Source]:
    """Return the sources that words on the command line stand for: the one place where names become sources."""
    from voldetail.library.building.source import StructureSource
    from voldetail.texture.structures import MODELS

    if sampling not in SAMPLINGS:
        raise InputError(f"--sampling {sampling!r} is not known; allowed: random, grid.")
    if any(word.startswith("relief") for word in what):
        from voldetail.fit.warmstart import ReliefSource
        from voldetail.fit.warmstart.choose import elevations_of

        return [ReliefSource(elevation, seed) for elevation in elevations_of(what)]
    names: list[str] = []
    for word in what:
        name = word.replace("-", " ")  # as a shell likes the name "cellular grid"
        if name != ALL and name not in MODELS:
            known = [model.replace(" ", "-") for model in MODELS] + ["relief"]
            raise InputError(f"There is no model {word!r}; {nearest(word, [*known, ALL])}. Known: {', '.join(known)}, all.")
        names += list(MODELS) if name == ALL else [name]
    return [StructureSource(MODELS[name], seed, "grid" if sampling == "grid" else "random") for name in dict.fromkeys(names)]


def _counts(sources: list[Source], count: int | None) -> list[int]:
    if sources[0].measure == "reliefs":
        from voldetail.fit.warmstart import ENTRIES

        return [count or ENTRIES] * len(sources)
    grids = [getattr(source, "most", None) for source in sources]
    if count is None and None in grids:
        raise InputError("The number of entries is missing; give --entries, e.g. --entries 1000 for a first try.")
    if count is not None and any(grids):
        raise InputError("A grid is built whole and has its own number of entries; leave out --entries, or --sampling grid.")
    return [count or most or 0 for most in grids]


def _check_room(out: Path, needed: int, part: Path) -> None:
    """Raise InputError where a library and, while it is built, its chunks have no room."""
    there = sum(path.stat().st_size for path in part.rglob("*.chunk")) if part.is_dir() else 0
    try:
        usage = shutil.disk_usage(out.parent)
    except OSError:
        return
    if usage.total > 0 and usage.free < 2 * needed - there:
        raise InputError(
            f"Cannot build {out}: {size_on_disk(2 * needed - there)} are needed there while building and "
            f"{size_on_disk(usage.free)} are free; free some space, give fewer --entries or another disk."
        )
