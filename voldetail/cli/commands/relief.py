"""`voldetail relief`: the photo's own height, normals, albedo and roughness."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, cast

import typer

from voldetail.cli.console import explain, remark, remarks, result
from voldetail.cli.console import output as results
from voldetail.cli.fit_setup import read_setup, zone_of
from voldetail.cli.outputs import check_folder, make_folder, remove
from voldetail.cli.settings import given, setting
from voldetail.cli.shape_options import shape_of
from voldetail.cli.threads import use_threads
from voldetail.errors import InputError
from voldetail.setup.light import FORMS

if TYPE_CHECKING:
    from voldetail.detail.photo_relief import MappedDetail
    from voldetail.recover.recovery import Recovery
    from voldetail.recover.slopes import Method
    from voldetail.setup.setup import Setup

Word = str | None
WHERE, HOW = "Where and what", "How"
RELIEF, TILE = "relief.json", "tile"
METHODS = ("network", "linear")


def relief(
    photo: Annotated[str, typer.Argument(help="A photo, skimage:gravel (or grass, brick), or a scene as .toml.")],
    output: Annotated[Path, typer.Option("--output", "-o", help="The folder for the maps.", rich_help_panel=WHERE)],
    light: Annotated[Word, setting("light", panel=WHERE, words=FORMS)] = None,
    mask: Annotated[Word, setting("mask", panel=WHERE)] = None,
    zone: Annotated[Word, setting("photo.zone", panel=WHERE, words="X,Y,WIDTH,HEIGHT in pixels", convert=zone_of)] = None,
    force: Annotated[bool, typer.Option("--force", help="Replace the maps in the folder.", rich_help_panel=WHERE)] = False,
    size: Annotated[
        int, typer.Option(help="Pixels of the maps' longest side; 0 for the photo's own.", rich_help_panel=HOW)
    ] = 1024,
    tile: Annotated[int | None, typer.Option(help="Make a tile of so many pixels a side as well.", rich_help_panel=HOW)] = None,
    method: Annotated[
        str, typer.Option(help="network, or linear: one closed step without anything learnt.", rich_help_panel=HOW)
    ] = "network",
    mesh: Annotated[str, typer.Option(help="The shape of the report's last picture.", rich_help_panel=HOW)] = "cylinder",
    report: Annotated[
        bool, typer.Option("--report/--no-report", help="Whether report.html and sheet.png are made.", rich_help_panel=HOW)
    ] = True,
    seed: Annotated[int, typer.Option(min=0, max=2**32 - 1, help="The root of all random numbers.", rich_help_panel=HOW)] = 0,
) -> None:
    """Recover the photo's own relief: maps of height, normals, albedo and roughness that render on any shape.

    Leaves a folder with relief.json, height.exr, normal.png, albedo.png, roughness.png, report.html and sheet.png.
    The photo is of something flat, seen head-on.
    """
    if method not in METHODS:
        raise InputError(f"--method {method!r} is not known; use network or linear.")
    setup = read_setup(photo, list(given(relief, locals())), [])
    if not setup.proxy.row.flat or any(setup.proxy.rotation):
        raise InputError(f"{photo} has a proxy that is no plane facing the camera; relief is recovered from flat surfaces alone.")
    earlier = _free_folder(output, force)
    shape = shape_of(mesh)
    use_threads()
    with remarks().status("reading the photo") as status:
        step: Callable[[str], None] = status.update
        recovery = _recovered(setup, size, cast("Method", method), seed, step)
        made = None if tile is None else _tile(recovery, tile, seed, step)
        make_folder(output)
        remove(earlier)
        _write(output, recovery, made, shape if report else None, step)
    _tell(output, recovery, report, tile is not None)


def _recovered(setup: Setup, size: int, method: Method, seed: int, on_step: Callable[[str], None]) -> Recovery:
    """Return what is recovered of the photo of ``setup``."""
    from voldetail.fit.autolight import resolve_light
    from voldetail.fit.target import load_photo_of
    from voldetail.image import with_mask
    from voldetail.recover.recovery import recover

    photo = load_photo_of(setup)
    for note in photo.notes:
        explain(f"The photo: {note}.")
    setup, guess = resolve_light(setup, photo)
    if guess is not None:
        results().print(guess.sentence, markup=False, soft_wrap=True)
    return recover(
        with_mask(photo, setup.mask), setup.light, zone=setup.photo.zone, size=size or None, method=method,
        name=setup.photo.skimage or setup.photo.name, seed=seed, on_step=on_step,
    )  # fmt: skip


def _tile(recovery: Recovery, side: int, seed: int, on_step: Callable[[str], None]) -> MappedDetail:
    """Return the tile of ``side`` pixels."""
    from voldetail.recover.tile import tile_of
    from voldetail.report.facts import duration

    return tile_of(
        recovery, side, seed=seed, on_progress=lambda p: on_step(f"making the tile, about {duration(p.seconds_left)} left")
    )


def _write(
    folder: Path, recovery: Recovery, tile: MappedDetail | None, shape: str | None, on_step: Callable[[str], None]
) -> None:
    """Write the maps, the tile's into a folder of its own, and with a ``shape`` the report."""
    from voldetail.recover.files import save_relief

    on_step("writing the maps")
    detail = save_relief(folder, recovery.detail)
    if tile is not None:
        make_folder(folder / TILE)
        save_relief(folder / TILE, tile)
    if shape is None:
        return
    from voldetail.apply.relief_gallery import relief_gallery
    from voldetail.report.relief_page import write_relief_report

    pictures = relief_gallery(
        detail, recovery.photo, recovery.again, tile=tile, mesh=shape, on_progress=lambda what: on_step(f"rendering: {what}")
    )
    on_step("writing the report")
    write_relief_report(folder, detail, pictures)


def _tell(folder: Path, recovery: Recovery, report: bool, tile: bool) -> None:
    """Say what was made, and how sure it is."""
    from voldetail.report import PAGE_NAME, SHEET_NAME
    from voldetail.report.facts import duration

    record = recovery.detail.record
    for note in recovery.notes:
        remark(note)
    files = [RELIEF, *(getattr(record.maps, name).path for name in type(record.maps).model_fields)]
    files += [f"{TILE}/{RELIEF}"] if tile else []
    result(
        {
            "folder": str(folder), "relief": str(folder / RELIEF), "files": files, "columns": record.columns, "rows": record.rows,
            "amplitude": record.relief.amplitude, "confidence": record.confidence, "notes": list(recovery.notes),
            "seconds": recovery.seconds,
        },
        f"{folder / RELIEF}  {record.columns} x {record.rows} pixels, amplitude {record.relief.amplitude:.3g} scene units,"
        f" confidence {record.confidence:.2f}, {duration(recovery.seconds)}: for voldetail render, relight, bake and show",
        *([f"{folder / TILE / RELIEF}  the tile"] if tile else []),
        *([f"{folder / PAGE_NAME}  the report: open it in a browser"] if report else []),
        *([f"{folder / SHEET_NAME}  the same on one picture"] if report else []),
    )  # fmt: skip


def _free_folder(folder: Path, force: bool) -> list[Path]:
    """Check the folder for the maps; return the files of an earlier run in it, which ``force`` lets go."""
    from voldetail.detail.relief_maps import RELIEF_FILES
    from voldetail.report import PAGE_NAME, SHEET_NAME

    check_folder(folder)
    names = (*RELIEF_FILES, *(f"{TILE}/{name}" for name in RELIEF_FILES), PAGE_NAME, SHEET_NAME)
    earlier = [folder / name for name in names if (folder / name).exists()]
    if earlier and not force:
        raise InputError(f"{folder} holds {earlier[0].name} already; give --force to replace it, or another folder.")
    return earlier
