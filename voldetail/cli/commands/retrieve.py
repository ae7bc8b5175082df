"""`voldetail retrieve`: the procedural textures of a library that are nearest to a photo."""

from __future__ import annotations

import json
from math import degrees
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer
from rich.table import Table

from voldetail.cli.arguments import zone as zone_of
from voldetail.cli.console import output, remarks, result
from voldetail.cli.outputs import check_file
from voldetail.errors import InputError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from voldetail.library import Answer, Novelty, Query, Ranking
    from voldetail.library.groups import Groups
    from voldetail.library.index import Index

MOST_ANSWERS = 100
DEFAULT_ENTRIES = 400
"""Of each model, where no library is given."""


def retrieve(
    photo: Annotated[str, typer.Argument(help="A photo of a texture, or skimage:gravel, :grass, :brick.")],
    library: Annotated[
        Path | None, typer.Option(help="A library, as library build makes it. Default: one of all models, made once.")
    ] = None,
    top: Annotated[int, typer.Option(min=1, max=MOST_ANSWERS, help="How many answers.")] = 8,
    model: Annotated[
        list[str] | None, typer.Option(metavar="NAME", help="Look among this model only; repeat it for several.")
    ] = None,
    mask: Annotated[Path | None, typer.Option(help="A picture of the photo's size: white is used.")] = None,
    zone: Annotated[str | None, typer.Option(help="X,Y,WIDTH,HEIGHT in pixels: the part to use. Default: all.")] = None,
    scale: Annotated[
        float | None,
        typer.Option(
            min=1e-3, max=100, help="What the photo is resized by before it is compared. Default: to at most 256 pixels a side."
        ),
    ] = None,
    rotation: Annotated[bool, typer.Option("--rotation/--no-rotation", help="Whether structures may be turned.")] = True,
    indexed: Annotated[
        bool, typer.Option("--index", help="Use the library's index: quicker among millions, and may miss an answer.")
    ] = False,
    swap: Annotated[bool, typer.Option("--swap/--no-swap", help="Whether the two tones may change places.")] = True,
    sheet: Annotated[Path | None, typer.Option("--output", "-o", help="A sheet of the photo and the answers, .png.")] = None,
    answers: Annotated[Path | None, typer.Option(help="A file for the answers, .json, as --json prints them.")] = None,
    texture: Annotated[Path | None, typer.Option(help="The first answer as a texture file, .json, for texture render.")] = None,
) -> None:
    """Find the procedural textures nearest to a photo, with their parameters and two tones.

    Nothing is optimised: the photo's descriptor is compared with those of a library. A structure is of the same size as the
    photo's only where the photo is compared at a size that the library knows; see --scale.
    """
    from voldetail.library import novelty_of, rank

    for path, suffix in ((sheet, ".png"), (answers, ".json"), (texture, ".json")):
        if path is not None:
            if path.suffix.lower() != suffix:
                raise InputError(f"Cannot write {path}: give a name that ends in {suffix}.")
            check_file(path)
    asked = _query(photo, mask, zone, scale)
    groups = _chosen(_groups(library), model)
    found = rank(
        groups, asked.vector, top, tones=(asked.tones.dark, asked.tones.bright), rotations=rotation, swap=swap,
        indexes=_indexes(library) if indexed else None,
    )  # fmt: skip
    first = found.answers[0]
    with remarks().status(f"comparing with other pictures of {first.model}"):
        novelty = novelty_of(groups[first.model], first, rotations=rotation, swap=swap)
    said = _remarks(asked, novelty)
    _print(found, asked, said)
    record = _record(photo, asked, found, novelty, said)
    result(record)
    if answers is not None:
        from voldetail.files import write_text

        write_text(answers, json.dumps(record, indent=2) + "\n")
    if texture is not None:
        from voldetail.detail.texture_file import save_texture
        from voldetail.library import texture_of
        from voldetail.records.examples import picture_path

        name = picture_path(photo)
        save_texture(texture, texture_of(found.answers[0], (asked.photo.shape[0], asked.photo.shape[1]), name.name))
    if sheet is not None:
        _write_sheet(sheet, photo, asked, found.answers)


def _groups(library: Path | None) -> Groups:
    """The library's groups; without one, those of the default library, built where the user's cache does not have it."""
    from voldetail.cli.building import teller
    from voldetail.cli.progress import ProgressView
    from voldetail.library import StructureSource, open_library
    from voldetail.library.cache import cached
    from voldetail.texture.structures import MODELS

    if library is not None:
        opened = open_library(library)
        if not opened.groups:
            raise InputError(f"The library {library} has reliefs, which fits start from (fit --library); give one of structures.")
        return opened.groups
    sources = [StructureSource(model) for model in MODELS.values()]
    with ProgressView(remarks()) as view:
        return cached(
            sources, DEFAULT_ENTRIES, "structures", on_progress=teller(view, [], "the library of structures, made once: ")
        ).groups


def _indexes(library: Path | None) -> dict[str, Index]:
    from voldetail.library import open_library
    from voldetail.library.index import open_index

    if library is None:
        raise InputError("--index was given without a library; name one by --library, with an index that library index made.")
    return open_index(open_library(library))


def _chosen(groups: Groups, names: list[str] | None) -> Groups:
    """The groups that are named; all where none is."""
    from voldetail.records.nearest import nearest

    names = [name.replace("-", " ") for name in names or []]  # as library build takes the name "cellular grid"
    for name in names:
        if name not in groups:
            raise InputError(f"The library has no model {name[:60]!r}; {nearest(name, list(groups))}.")
    return {name: group for name, group in groups.items() if not names or name in names}


def _query(photo: str, mask: Path | None, zone: str | None, scale: float | None) -> Query:
    from voldetail.image import load_masked
    from voldetail.library import query

    loaded = load_masked(photo, mask)
    return query(loaded.pixels, loaded.opaque, zone=zone_of(zone) if zone is not None else None, scale=scale)


def _print(found: Ranking, asked: Query, said: list[str]) -> None:
    rows, columns = asked.photo.shape[:2]
    say = output()
    say.print(_table([(str(k + 1), answer) for k, answer in enumerate(found.answers)], "rank"))
    if len(found.by_model) > 1:
        best = sorted((answers[0] for answers in found.by_model.values()), key=lambda answer: answer.distance)
        say.print()
        say.print(_table([("", answer) for answer in best], "best of each"))
    say.print(
        f"Compared at {columns} x {rows} pixels; two tones explain {asked.tones.explained:.0%} of the colours' variance.",
        markup=False, soft_wrap=True,
    )  # fmt: skip
    for sentence in said:
        remarks().print(sentence, markup=False, soft_wrap=True)


def _remarks(asked: Query, novelty: Novelty | None) -> list[str]:
    """What a reader of the answers has to know, a sentence each."""
    said = [novelty.sentence if novelty else "", asked.tones.poor]
    if asked.missing:
        said.append(
            f"The photo is too small for the coarsest {asked.missing} of six scales, so nothing of that size was compared."
        )
    return [sentence for sentence in said if sentence]


def _table(rows: Sequence[tuple[str, Answer]], heading: str) -> Table:
    table = Table(box=None, padding=(0, 2, 0, 0))
    for name, side in ((heading, "left"), ("model", "left"), ("distance", "right"), ("turned", "right"), ("swapped", "left")):
        table.add_column(name, justify="right" if side == "right" else "left", no_wrap=True)
    table.add_column("parameters")
    for rank, answer in rows:
        numbers = ", ".join(f"{key} {value:.3g}" for key, value in answer.parameters.items())
        turn = f"{degrees(answer.rotation):.4g}°"
        table.add_row(rank, answer.model, f"{answer.distance:.3f}", turn, "yes" if answer.swapped else "no", numbers)
    return table


def _record(photo: str, asked: Query, found: Ranking, novelty: Novelty | None, said: list[str]) -> dict[str, Any]:
    """The answers as what JSON holds."""
    rows, columns = asked.photo.shape[:2]
    return {
        "photo": photo, "pixels": [columns, rows], "scale": asked.scale, "explained": asked.tones.explained,
        "dark": asked.tones.dark.tolist(), "bright": asked.tones.bright.tolist(), "scales_missing": asked.missing,
        "known": None if novelty is None else not novelty.novel,
        "farthest_of_its_model": None if novelty is None else novelty.farthest,
        "remarks": said,
        "answers": [_answer(answer) for answer in found.answers],
        "best_of_each": {name: _answer(answers[0]) for name, answers in found.by_model.items()},
    }  # fmt: skip


def _answer(answer: Answer) -> dict[str, Any]:
    return {
        "model": answer.model, "entry": answer.entry, "seed": answer.seed, "distance": answer.distance,
        "rotation": answer.rotation, "swapped": answer.swapped, "parameters": dict(answer.parameters),
        "zero": list(answer.zero), "one": list(answer.one),
    }  # fmt: skip


def _write_sheet(path: Path, photo: str, asked: Query, answers: Sequence[Answer]) -> None:
    """Photo, structure map and answers, all of one size."""
    import numpy as np

    from voldetail.image import to_linear
    from voldetail.library import picture
    from voldetail.report import write_contact_sheet
    from voldetail.report.pictures import dimmed

    size = (asked.photo.shape[0], asked.photo.shape[1])
    # The map is shown as numbers: half-way between the tones is half-way between black and white as stored.
    structure = np.repeat(to_linear(asked.tones.structure)[..., None], 3, axis=2)
    frames = [("photo", dimmed(asked.photo, asked.mask)), ("its structure", structure)]
    frames += [(caption(k + 1, answer), picture(answer, size)) for k, answer in enumerate(answers)]
    write_contact_sheet(path, frames, f"{Path(photo).name}: the nearest procedural textures")
    output().print(str(path), markup=False, soft_wrap=True)


def caption(rank: int, answer: Answer) -> str:
    """Return the line under an answer's picture."""
    turn = f", {degrees(answer.rotation):.4g}°" if answer.rotation else ""
    return f"{rank}. {answer.model}, D {answer.distance:.2f}{turn}{', swapped' if answer.swapped else ''}"
