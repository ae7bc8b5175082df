"""`voldetail fit`: from a photo to a folder with the detail and its report."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from voldetail.cli.console import Json, explain, remarks, result
from voldetail.cli.console import output as results
from voldetail.cli.fit_folder import DETAIL, FIT, RELIEF, FitFolder
from voldetail.cli.fit_relief import keep_relief
from voldetail.cli.fit_setup import implied, output_folder, proxy_of, read_setup, rotation_of, zone_of
from voldetail.cli.settings import given, setting
from voldetail.cli.threads import use_threads
from voldetail.setup.light import FORMS
from voldetail.setup.shapes import SHAPE_WORDS

if TYPE_CHECKING:
    from voldetail.results import FitResult

Word = str | None
WHERE, SCENE, SEARCH = "Where and what", "The scene", "The search"


def fit(
    photo: Annotated[str, typer.Argument(help="A photo, skimage:gravel (or grass, brick), or a scene as .toml.")],
    light: Annotated[
        Word,
        setting(
            "light",
            panel=SCENE,
            words=f"{FORMS} (azimuth counter-clockwise from the right, elevation above the picture; estimated for flat surfaces)",
        ),
    ] = None,
    proxy: Annotated[Word, setting("proxy.kind", panel=SCENE, words=f"{SHAPE_WORDS} or a mesh file", convert=proxy_of)] = None,
    rotation: Annotated[Word, setting("proxy.rotation", panel=SCENE, words="X,Y,Z", convert=rotation_of)] = None,
    camera: Annotated[Word, setting("camera.kind", panel=SCENE, words="orthographic or perspective")] = None,
    fov: Annotated[float | None, setting("camera.field_of_view", panel=SCENE)] = None,
    mode: Annotated[
        Word, setting("mode", panel=SCENE, words="displacement, or volume (tufts, overhangs, clouds; a closed shape)")
    ] = None,
    look: Annotated[Word, setting("look", panel=SCENE, words="surface or medium")] = None,
    colour: Annotated[Word, setting("colour", panel=SCENE, words="auto (default), by-example, height, cell or none")] = None,
    mask: Annotated[Word, setting("mask", panel=WHERE)] = None,
    zone: Annotated[Word, setting("photo.zone", panel=WHERE, words="X,Y,WIDTH,HEIGHT in pixels", convert=zone_of)] = None,
    resolution: Annotated[int | None, setting("photo.resolution", panel=WHERE)] = None,
    stationarize: Annotated[bool | None, setting("photo.stationarize", "--stationarize/--as-it-is", panel=WHERE)] = None,
    output: Annotated[Word, setting("output", "--output", "-o", panel=WHERE)] = None,
    force: Annotated[bool, typer.Option("--force", help="Replace an earlier fit.", rich_help_panel=WHERE)] = False,
    resume: Annotated[bool, typer.Option("--resume", help="Go on with an interrupted fit.", rich_help_panel=WHERE)] = False,
    relief: Annotated[bool | None, setting("relief", "--relief/--no-relief", panel=WHERE)] = None,
    amplitude: Annotated[float | None, setting("amplitude", panel=SEARCH)] = None,
    domain: Annotated[Word, setting("domain", panel=SEARCH, words="solid or surface")] = None,
    specular: Annotated[bool | None, setting("fit.specular", "--specular/--no-specular", panel=SEARCH)] = None,
    solver: Annotated[Word, setting("fit.solver", panel=SEARCH, words="default or paper")] = None,
    metric: Annotated[Word, setting("fit.metric", panel=SEARCH)] = None,
    seed: Annotated[int | None, setting("seed", panel=SEARCH)] = None,
    evaluations: Annotated[int | None, setting("fit.evaluations", panel=SEARCH)] = None,
    library: Annotated[Word, setting("fit.library", panel=SEARCH)] = None,
    time_limit: Annotated[float | None, setting("fit.time_limit", panel=SEARCH)] = None,
    override: Annotated[
        list[str] | None,
        typer.Option("-D", metavar="KEY=VALUE", help="Any setting of the scene file.", rich_help_panel=SEARCH),
    ] = None,
) -> None:
    """Fit relief to one photo.

    Leaves a folder with detail.json (the relief), report.html, sheet.png, fit.png, setup.toml (all settings),
    state.json (for --resume) and relief (the photo's own relief, see voldetail relief). Ctrl-C ends the search with the
    best so far.
    """
    setup = read_setup(photo, implied(list(given(fit, locals()))), override or [])
    place = FitFolder(output_folder(setup), setup)
    place.check(force=force, resume=resume)
    run(place, resume=resume)


def run(place: FitFolder, *, resume: bool) -> None:
    """Fit the setup of ``place`` and fill it."""
    from voldetail.cli.building import teller
    from voldetail.cli.progress import ProgressView
    from voldetail.fit.autolight import resolve_light
    from voldetail.fit.evenness import warning
    from voldetail.fit.fitter import fit as search
    from voldetail.fit.session import Progress, State
    from voldetail.fit.target import load_photo_of
    from voldetail.results import Target

    console = remarks()
    picture = load_photo_of(place.setup)
    place.setup, guess = resolve_light(place.setup, picture)
    start = place.resumed(picture.sha256) if resume else None
    if resume and start is None:
        console.print("No state was saved in that folder yet: starting from the beginning.")
    use_threads()
    for note in picture.notes:
        explain(f"The photo: {note}.")
    if guess is not None:
        results().print(guess.sentence, markup=False, soft_wrap=True)

    with ProgressView(console) as view:
        if place.setup.photo.stationarize:
            view.step("making an even picture of the photo")

        def on_target(target: Target) -> None:
            if place.setup.relief and start is None:
                keep_relief(place, picture, view.step)
            uneven = "" if place.setup.photo.stationarize else warning(target.unevenness)
            if uneven:
                console.print(uneven, markup=False, soft_wrap=True)

        def on_progress(progress: Progress) -> None:
            place.begin(keep=start is not None)
            place.preview(progress)
            view.searching(progress)

        def on_state(state: State) -> None:
            place.begin(keep=start is not None)
            place.save_state(state, picture.sha256)

        fitted = search(
            place.setup,
            photo=picture,
            start=start,
            light_guess=guess,
            on_progress=on_progress,
            on_state=on_state,
            on_target=on_target,
            on_remark=lambda sentence: console.print(sentence, markup=False, soft_wrap=True),
            on_library_progress=teller(view, [], "reliefs for lights at this elevation, made once: "),
        )
        place.begin(keep=start is not None)  # a resumed fit that was complete reports no progress
        place.finish(fitted)
        try:
            _report(place.path, fitted, view.step)
        except KeyboardInterrupt:
            words = f"Stopped before the report was complete; {place.path / DETAIL} is."
            console.print(words, markup=False, soft_wrap=True)
            raise typer.Exit(130) from None
    _tell(place.path, fitted)


def _report(folder: Path, result: FitResult, on_step: Callable[[str], None]) -> None:
    from voldetail.apply import gallery
    from voldetail.report import write_report

    pictures = gallery(result, on_progress=lambda what: on_step(f"rendering {what}"))
    on_step("writing the report")
    write_report(folder, result, pictures)


def _tell(folder: Path, fitted: FitResult) -> None:
    """Say what was made and how good it is."""
    from voldetail.report import PAGE_NAME, SHEET_NAME, verdict
    from voldetail.report.facts import amplitude_words, duration, medium_words

    console = results()
    if fitted.interrupted:
        console.print("Stopped by you: this is the best so far; the same command with --resume goes on.")
    # On a terminal a sentence is wrapped between words; in a file it stays one line.
    wrap = not console.is_terminal
    console.print(verdict(fitted.distance, fitted.detail.noise_floor).sentence, markup=False, soft_wrap=wrap)
    relief = f"Of the medium: {medium_words(fitted)}" if fitted.identifiability else f"Amplitude {amplitude_words(fitted)}"
    console.print(f"{relief}.", markup=False, soft_wrap=wrap)
    spent = f"{fitted.evaluations} pictures compared in {duration(fitted.seconds)}"
    console.print(f"{spent}; {fitted.status}.", markup=False, soft_wrap=wrap)
    for name, what in (
        (PAGE_NAME, "the report: open it in a browser"), (SHEET_NAME, "the same on one picture"),
        (DETAIL, "the detail: use it with voldetail render, relight and show"),
        (FIT, "the photo's zone as the detail makes it"),
        (RELIEF, "the photo's own relief: use it as the detail"),
    ):  # fmt: skip
        if name == RELIEF and not (folder / name).is_dir():
            continue
        console.print(f"  {folder / name}  {what}", markup=False, soft_wrap=True)
    result(_record(folder, fitted))


def _record(folder: Path, fitted: FitResult) -> Json:
    """What was made and how good it is, as JSON holds it."""
    from voldetail.report import PAGE_NAME, SHEET_NAME, verdict

    floor = fitted.detail.noise_floor
    return {
        "folder": str(folder), "detail": str(folder / DETAIL), "report": str(folder / PAGE_NAME),
        "sheet": str(folder / SHEET_NAME), "picture": str(folder / FIT), "distance": fitted.distance,
        "photo_halves": floor.photo_halves, "other_seed": floor.other_seed,
        "verdict": verdict(fitted.distance, floor).sentence, "evaluations": fitted.evaluations, "seconds": fitted.seconds,
        "status": fitted.status, "interrupted": fitted.interrupted,
    }  # fmt: skip
