"""`voldetail fit`: from a photo to a folder with the detail and its report."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from voldetail.cli.console import output, remarks
from voldetail.cli.fit_folder import DETAIL, FIT, FitFolder
from voldetail.cli.threads import use_threads
from voldetail.setup.shapes import SHAPE_WORDS

if TYPE_CHECKING:
    from voldetail.results import FitResult

_Text = str | None
LIGHT_HELP = (
    "The light in the photo: AZ,EL in degrees (azimuth counter-clockwise from the right, elevation above the"
    " picture), x,y,z towards it, flash, flash@height, flash@u,v, or point:x,y,z; or auto to have it estimated"
    " (for a flat surface under one distant light)."
)
WHERE, SCENE, SEARCH = "Where and what", "The scene", "The search"


def fit(
    context: typer.Context,
    photo: Annotated[
        str, typer.Argument(help="A photo, skimage:gravel (or grass, brick), or a scene as .toml.")
    ],
    light: Annotated[_Text, typer.Option(help=LIGHT_HELP, rich_help_panel=SCENE)] = None,
    proxy: Annotated[
        _Text,
        typer.Option(
            help=f"The shape in the photo: {SHAPE_WORDS} or a mesh file.",
            rich_help_panel=SCENE,
        ),
    ] = None,
    rotation: Annotated[
        _Text, typer.Option(help="The proxy's turns about x, y, z in degrees.", rich_help_panel=SCENE)
    ] = None,
    camera: Annotated[_Text, typer.Option(help="orthographic or perspective.", rich_help_panel=SCENE)] = None,
    fov: Annotated[
        float | None,
        typer.Option(
            help="Degrees across the photo's longest side; makes it perspective.", rich_help_panel=SCENE
        ),
    ] = None,
    mode: Annotated[
        _Text,
        typer.Option(
            help="displacement (relief on a surface) or volume (tufts, overhangs, clouds; a closed shape).",
            rich_help_panel=SCENE,
        ),
    ] = None,
    look: Annotated[
        _Text,
        typer.Option(
            help="Of a volume: surface (solid matter) or medium (light passes through, as in clouds).",
            rich_help_panel=SCENE,
        ),
    ] = None,
    colour: Annotated[
        _Text,
        typer.Option(
            help="by-example, height, cell, none, or auto: whichever is nearest to the photo (default).", rich_help_panel=SCENE
        ),
    ] = None,
    mask: Annotated[
        _Text, typer.Option(help="A picture of the photo's size: white is used.", rich_help_panel=WHERE)
    ] = None,
    zone: Annotated[
        _Text,
        typer.Option(help="The part that is fitted: X,Y,WIDTH,HEIGHT in pixels.", rich_help_panel=WHERE),
    ] = None,
    resolution: Annotated[
        int | None, typer.Option(help="Its longest side when compared, in pixels.", rich_help_panel=WHERE)
    ] = None,
    stationarize: Annotated[
        bool | None,
        typer.Option(
            "--stationarize/--as-it-is", help="Make an even picture of it first, without stains and slow shading.",
            rich_help_panel=WHERE,
        ),
    ] = None,
    folder: Annotated[
        _Text,
        typer.Option("--output", "-o", help="The folder for results; default voldetail-out/PHOTO.", rich_help_panel=WHERE),
    ] = None,
    force: Annotated[
        bool, typer.Option("--force", help="Replace an earlier fit.", rich_help_panel=WHERE)
    ] = False,
    resume: Annotated[
        bool, typer.Option("--resume", help="Go on with an interrupted fit.", rich_help_panel=WHERE)
    ] = False,
    amplitude: Annotated[
        float | None,
        typer.Option(help="The relief's height in scene units, if known.", rich_help_panel=SEARCH),
    ] = None,
    domain: Annotated[_Text, typer.Option(help="solid or surface.", rich_help_panel=SEARCH)] = None,
    specular: Annotated[
        bool | None,
        typer.Option(
            "--specular/--no-specular", help="Whether it may have highlights.", rich_help_panel=SEARCH
        ),
    ] = None,
    solver: Annotated[_Text, typer.Option(help="default or paper.", rich_help_panel=SEARCH)] = None,
    metric: Annotated[
        _Text, typer.Option(help="The distance that is minimised.", rich_help_panel=SEARCH)
    ] = None,
    seed: Annotated[
        int | None, typer.Option(help="The root of all random numbers.", rich_help_panel=SEARCH)
    ] = None,
    evaluations: Annotated[
        int | None, typer.Option(help="The most pictures that are compared.", rich_help_panel=SEARCH)
    ] = None,
    library: Annotated[
        _Text,
        typer.Option(
            help="Reliefs to start from: auto (made once for the light's elevation, and kept), none, or a library's path.",
            rich_help_panel=SEARCH,
        ),
    ] = None,
    time_limit: Annotated[
        float | None,
        typer.Option(help="The longest time for the search, in seconds.", rich_help_panel=SEARCH),
    ] = None,
    override: Annotated[
        list[str] | None,
        typer.Option(
            "-D", metavar="KEY=VALUE", help="Any setting of the scene file.", rich_help_panel=SEARCH
        ),
    ] = None,
) -> None:
    """Fit relief to one photo.

    Leaves a folder with detail.json (the relief), report.html, sheet.png, fit.png, setup.toml (all settings)
    and state.json (for --resume). Ctrl-C ends the search with the best so far.
    """
    from voldetail.cli.fit_setup import output_folder, read_setup

    options = {
        "--light": light, "--proxy": proxy, "--rotation": rotation, "--camera": camera, "--fov": fov,
        "--mask": mask, "--zone": zone, "--resolution": resolution, "--output": folder, "--domain": domain,
        "--amplitude": amplitude, "--specular": specular, "--solver": solver, "--metric": metric,
        "--mode": mode, "--look": look, "--colour": colour, "--stationarize": stationarize, "--seed": seed,
        "--evaluations": evaluations, "--library": library, "--time-limit": time_limit,
    }  # fmt: skip
    setup = read_setup(photo, options, override or [])
    place = FitFolder(output_folder(setup), setup)
    place.check(force=force, resume=resume)
    run(place, resume=resume, threads=context.obj)


def run(place: FitFolder, *, resume: bool, threads: int) -> None:
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
    use_threads(threads)
    if guess is not None:
        output().print(guess.sentence, markup=False, soft_wrap=True)

    with ProgressView(console) as view:
        if place.setup.photo.stationarize:
            view.step("making an even picture of the photo")

        def on_target(target: Target) -> None:
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

        result = search(
            place.setup, photo=picture, start=start, light_guess=guess, on_progress=on_progress, on_state=on_state,
            on_target=on_target, on_remark=lambda sentence: console.print(sentence, markup=False, soft_wrap=True),
            on_library_progress=teller(view, [], "reliefs for lights at this elevation, made once: "),
        )
        place.begin(keep=start is not None)  # a resumed fit that was complete reports no progress
        place.finish(result)
        try:
            _report(place.path, result, view.step)
        except KeyboardInterrupt:
            words = f"Stopped before the report was complete; {place.path / DETAIL} is."
            console.print(words, markup=False, soft_wrap=True)
            raise typer.Exit(130) from None
    _tell(place.path, result)


def _report(folder: Path, result: FitResult, on_step: Callable[[str], None]) -> None:
    from voldetail.apply import gallery
    from voldetail.report import write_report

    pictures = gallery(result, on_progress=lambda what: on_step(f"rendering {what}"))
    on_step("writing the report")
    write_report(folder, result, pictures)


def _tell(folder: Path, result: FitResult) -> None:
    """Say what was made and how good it is."""
    from voldetail.report import PAGE_NAME, SHEET_NAME, verdict
    from voldetail.report.facts import amplitude_words, duration, medium_words

    console = output()
    if result.interrupted:
        console.print("Stopped by you: this is the best so far; the same command with --resume goes on.")
    # On a terminal a sentence is wrapped between words; in a file it stays one line.
    wrap = not console.is_terminal
    console.print(verdict(result.distance, result.detail.noise_floor).sentence, markup=False, soft_wrap=wrap)
    relief = f"Of the medium: {medium_words(result)}" if result.identifiability else f"Amplitude {amplitude_words(result)}"
    console.print(f"{relief}.", markup=False, soft_wrap=wrap)
    spent = f"{result.evaluations} pictures compared in {duration(result.seconds)}"
    console.print(f"{spent}; {result.status}.", markup=False, soft_wrap=wrap)
    for name, what in (
        (PAGE_NAME, "the report: open it in a browser"), (SHEET_NAME, "the same on one picture"),
        (DETAIL, "the detail: use it with voldetail render, relight and show"),
        (FIT, "the photo's zone as the detail makes it"),
    ):  # fmt: skip
        console.print(f"  {folder / name}  {what}", markup=False, soft_wrap=True)
