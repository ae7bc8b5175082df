"""`voldetail library info`: what is in a library, and whether it is as it was written."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.table import Table
from rich.text import Text

from voldetail.cli.console import output, remarks, result
from voldetail.cli.library_words import size_on_disk
from voldetail.records.refusal import printable, shown

if TYPE_CHECKING:
    from voldetail.library.layout import SourceRecord
    from voldetail.library.store import Header


def info(
    library: Annotated[Path, typer.Argument(metavar="LIB", help="A library, as library build makes it.")],
    check: Annotated[bool, typer.Option("--check", help="Read everything and hold it against its hashes.")] = False,
) -> None:
    """Say what is in a library, how it was made, and whether this voldetail can still use it."""
    from voldetail.library.store import read_header

    header = read_header(library)
    table = Table(box=None, padding=(0, 2, 0, 0))
    for heading in ("source", "entries", "numbers", "sampling", "seed", "current"):
        table.add_column(heading, no_wrap=heading != "numbers")
    for name, record in header.sources.items():
        sampling = record.definition.get("sampling")
        words = (
            name, str(record.entries), ", ".join(record.keys), sampling if isinstance(sampling, str) else "", str(record.seed),
            _current(name, record),
        )  # fmt: skip
        table.add_row(*(Text(printable(word)) for word in words))
    output().print(table)
    version = shown(header.record.descriptor.get("version"))
    state = f"out of date: {header.stale} are not this voldetail's; build it again" if header.stale else "current"
    for label, text in (
        ("entries", f"{header.entries}, {size_on_disk(header.bytes)} on disk"),
        ("descriptor", f"version {version}, {header.record.descriptor_sha256[:12]}"),
        ("weights", f"w_global {header.w_global:g}"),
        ("library", f"{header.sha256[:12]}, {state}"),
        ("index", "there" if (library / "index").is_file() else "none"),
    ):
        output().print(f"{label + ':':12}{text}", markup=False, soft_wrap=True)
    if check:
        _check(header)
    result({
        "sources": {name: {"entries": record.entries, "seed": record.seed, "current": _current(name, record)}
                    for name, record in header.sources.items()},
        "entries": header.entries, "bytes": header.bytes, "sha256": header.sha256, "stale": header.stale,
        "index": (library / "index").is_file(), "checked": check,
    })  # fmt: skip
    if check:
        output().print("checked:    every number is the one that was written.", markup=False)


def _current(name: str, record: SourceRecord) -> str:
    """Whether the entries are those that this voldetail would make."""
    from voldetail.library.building.source import StructureSource
    from voldetail.library.vectors import COMPLETE_SIDE
    from voldetail.texture.structures import MODELS

    if record.definition.get("kind") == "relief":
        return _relief_current(record)
    side = record.definition.get("side")
    if record.definition.get("kind") != "structure" or name not in MODELS or not isinstance(side, int):
        return "not known here"
    grid = record.definition.get("sampling") == "grid"
    now = StructureSource(MODELS[name], record.seed, "grid" if grid else "random", max(side, COMPLETE_SIDE))
    return "yes" if record.definition == now.definition else "no, another model"


def _relief_current(record: SourceRecord) -> str:
    from voldetail.fit.warmstart import ReliefSource

    elevation = record.definition.get("elevation")
    if not isinstance(elevation, int):
        return "not known here"
    return "yes" if record.definition == ReliefSource(elevation, record.seed).definition else "no, other reliefs"


def _check(header: Header) -> None:
    from voldetail.cli.progress import LINE_SECONDS, ProgressView
    from voldetail.library.check import check
    from voldetail.library.store import open_library

    with ProgressView(remarks()) as view:
        last = view.clock()

        def tell(entries: int) -> None:
            nonlocal last
            if view.live is not None or view.clock() - last >= LINE_SECONDS:
                last = view.clock()
                view.step(f"checking: {entries} of {header.entries} entries")

        check(open_library(header.path), tell)
