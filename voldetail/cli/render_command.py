"""`voldetail render` and `voldetail relight`: a detail on other shapes and under other lights."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from voldetail.cli.arguments import angles, numbers, size
from voldetail.cli.console import output, remarks
from voldetail.cli.outputs import check_file, check_folder, make_folder, remove
from voldetail.cli.shape_options import MESH_HELP, DetailFile, Rotation, Scale, rotation_of, shape_of, tell
from voldetail.cli.threads import use_threads
from voldetail.detail import load_detail
from voldetail.errors import InputError
from voldetail.setup.lights.table import FORMS_PLACED

if TYPE_CHECKING:
    from voldetail.detail import Detail
    from voldetail.setup.setup import CameraSetup

RENDER_LIGHTS = FORMS_PLACED
ANIMATION_SECONDS = 0.12  # a frame
MOST_FRAMES = 720
BRIGHTEST = 1e3

_Fov = Annotated[
    float | None,
    typer.Option(min=1, max=150, help="Degrees across; a perspective camera. Default: orthographic."),
]
_Background = Annotated[
    str,
    typer.Option(
        help="Light where there is nothing: 0 is black; a number, R,G,B (linear), or photo: what the fit found there."
    ),
]
_Subsamples = Annotated[int, typer.Option(min=1, max=8, help="Samples a pixel, each way, under a light.")]


def render(
    context: typer.Context,
    detail: DetailFile,
    shape: Annotated[str, typer.Argument(metavar="MESH", help=MESH_HELP)],
    out: Annotated[Path, typer.Option("--output", "-o", help="The picture: .png, .jpg or .exr (linear).")],
    light: Annotated[
        str | None, typer.Option(help=f"{RENDER_LIGHTS}. Default: 135,45.")
    ] = None,
    envmap: Annotated[
        Path | None, typer.Option(help="Light from an environment map (.exr or .hdr) instead.")
    ] = None,
    scale: Scale = 1.0,
    pixels: Annotated[str, typer.Option("--size", help="WIDTHxHEIGHT in pixels.")] = "640x480",
    shading: Annotated[
        str, typer.Option(help="phong (as fitted) or principled (physically based).")
    ] = "phong",
    rotation: Rotation = None,
    fov: _Fov = None,
    samples: Annotated[
        int, typer.Option(min=1, max=65536, help="Samples a pixel, for --envmap and principled.")
    ] = 64,
    subsamples: _Subsamples = 2,
    background: _Background = "0",
) -> None:
    """Render a detail on a shape, under a light or an environment map."""
    from voldetail.apply import render as picture_of
    from voldetail.image import check_suffix, save_image
    from voldetail.render.environment import checked_environment
    from voldetail.setup.light import parse_light

    check_suffix(out)
    check_file(out)
    record = load_detail(detail)
    if light is not None and envmap is not None:
        raise InputError("--light and --envmap were both given; choose one.")
    if shading not in ("phong", "principled"):
        raise InputError(f"--shading {shading!r} is not known; use phong or principled.")
    lit = parse_light(light) if light is not None else None
    if lit is not None and lit.row.estimated:
        raise InputError(f"--light auto is estimated from a photo, by fit alone: give it as {RENDER_LIGHTS}.")
    options: dict[str, Any] = {
        "light": lit,
        "envmap": checked_environment(envmap) if envmap is not None else None,
        "scale": scale, "size": size(pixels), "camera": _camera(fov), "rotation": rotation_of(rotation),
        "subsamples": subsamples, "samples": samples, "shading": shading, "background": _background(background, record),
    }  # fmt: skip
    shape = shape_of(shape)
    use_threads(context.obj)
    with remarks().status(f"rendering {shape}") as status:
        options["tell"] = tell
        options["on_progress"] = lambda done, total: status.update(f"rendering {shape}: {done} of {total} blocks of its surface")
        picture = picture_of(record, shape, **options)
    save_image(out, picture)
    output().print(f"{out}  {picture.shape[1]} x {picture.shape[0]} pixels", markup=False, soft_wrap=True)


def relight(
    context: typer.Context,
    detail: DetailFile,
    azimuth: Annotated[
        str,
        typer.Option(
            help="Degrees: one, a list as 0,90, or START:STOP:COUNT steps without STOP, as 0:360:12."
        ),
    ],
    elevation: Annotated[str, typer.Option(help="Degrees above the picture, over 0 to 90 (-90 to 90 for a medium); as azimuth.")],
    folder: Annotated[Path, typer.Option("--output", "-o", help="The folder for the pictures.")],
    shape: Annotated[str, typer.Argument(metavar="[MESH]", help=MESH_HELP)] = "plane",
    scale: Scale = 1.0,
    pixels: Annotated[str, typer.Option("--size", help="WIDTHxHEIGHT in pixels.")] = "480x480",
    rotation: Rotation = None,
    fov: _Fov = None,
    subsamples: _Subsamples = 2,
    background: _Background = "0",
    animation: Annotated[str, typer.Option(help="gif, png (animated, more colours) or none.")] = "gif",
    force: Annotated[bool, typer.Option("--force", help="Replace the frames in the folder.")] = False,
) -> None:
    """Render a detail under many lights: frames, a contact sheet (sheet.png) and an animation.

    Each elevation is gone through with every azimuth. Without MESH it is a plane that fills the picture.
    """
    from voldetail.apply import relight as frames_of

    azimuths = angles(azimuth, "--azimuth", lambda a: -720 <= a <= 720, "-720 to 720")
    record = load_detail(detail)
    if record.medium is None:
        elevations = angles(elevation, "--elevation", lambda e: 0 < e <= 90, "over 0 to 90 (below for media alone)")
    else:
        elevations = angles(elevation, "--elevation", lambda e: -90 <= e <= 90, "-90 to 90")
    count = len(azimuths) * len(elevations)
    if count > MOST_FRAMES:
        raise InputError(f"These angles make {count} pictures; at most {MOST_FRAMES} are allowed.")
    if animation not in ("gif", "png", "none"):
        raise InputError(f"--animation {animation!r} is not known; use gif, png or none.")
    earlier = _free_folder(folder, force)
    wide, turned, camera, shape = size(pixels), rotation_of(rotation), _camera(fov), shape_of(shape)
    behind = _background(background, record)
    use_threads(context.obj)
    frames = frames_of(
        record, shape, azimuths=azimuths, elevations=elevations, scale=scale, size=wide, camera=camera,
        rotation=turned, subsamples=subsamples, background=behind, tell=tell,
    )  # fmt: skip
    _write_frames(folder, earlier, frames, count, animation, record.name)
    output().print(
        f"{folder}  {count} frames, sheet.png" + _animation_words(animation, count),
        markup=False,
        soft_wrap=True,
    )


def _write_frames(
    folder: Path, earlier: list[Path], frames: Any, count: int, animation: str, name: str
) -> None:
    """Write each frame as it comes, then the sheet and the animation."""
    from voldetail.image import save_png
    from voldetail.report import write_animation, write_contact_sheet
    from voldetail.report.frames import thumbnail
    from voldetail.report.pictures import encoded

    small, moving = [], []
    with remarks().status(f"rendering {count} pictures") as status:
        for index, (azimuth, elevation, picture) in enumerate(frames):
            if index == 0:
                make_folder(folder)
                remove(earlier)
            save_png(folder / f"frame-{index:03d}-az{azimuth:g}-el{elevation:g}.png", picture)
            small.append((f"azimuth {azimuth:g}, elevation {elevation:g}", thumbnail(picture)))
            if animation != "none":
                moving.append(encoded(picture))
            status.update(f"rendering: {index + 1} of {count} pictures")
        write_contact_sheet(folder / "sheet.png", small, f"{name}: light from {count} sides (degrees)")
        if len(moving) > 1:
            write_animation(folder / f"animation.{animation}", moving, ANIMATION_SECONDS * count)


def _animation_words(animation: str, count: int) -> str:
    return f" and animation.{animation}" if animation != "none" and count > 1 else ""


def _free_folder(folder: Path, force: bool) -> list[Path]:
    """Check the folder for the frames; return the frames of an earlier run in it, which ``force`` lets go."""
    check_folder(folder)
    earlier = sorted(
        p for p in folder.glob("*") if p.name.startswith(("frame-", "animation.")) or p.name == "sheet.png"
    )
    if earlier and not force:
        raise InputError(
            f"{folder} holds {earlier[0].name} already; give --force to replace it, or another folder."
        )
    return earlier


def _camera(fov: float | None) -> CameraSetup | None:
    from voldetail.setup.setup import CameraSetup

    return None if fov is None else CameraSetup(kind="perspective", field_of_view=fov)


def _background(text: str, record: Detail) -> tuple[float, float, float]:
    """The colour behind: from a number, R,G,B, or "photo"."""
    if text == "photo":
        found = record.provenance.settings.get("background") if record.provenance else None
        if not (isinstance(found, list) and len(found) == 3 and all(isinstance(v, int | float) for v in found)):
            raise InputError("--background photo is for media that were fitted to one, and this detail names none: give R,G,B.")
        r, g, b = (float(v) for v in found)  # type: ignore[arg-type]
        return r, g, b
    values = numbers(text, 3 if "," in text else 1, "--background", "one number, R,G,B or photo")
    if not all(0 <= v <= BRIGHTEST for v in values):
        raise InputError(f"--background {text} is out of range; each number has to be 0 to {BRIGHTEST:g}.")
    return values[0], values[-2 if len(values) > 1 else 0], values[-1]
