"""`voldetail relight`: a detail under many lights."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from voldetail.cli.arguments import angles, size
from voldetail.cli.console import remarks, result
from voldetail.cli.outputs import check_folder, make_folder, remove
from voldetail.cli.shape_options import MESH_HELP, DetailFile, Rotation, Scale, rotation_of, shape_of, tell
from voldetail.cli.threads import use_threads
from voldetail.cli.view_options import Background, Fov, Subsamples, background_of, camera_of
from voldetail.errors import InputError

ANIMATION_SECONDS = 0.12  # a frame
MOST_FRAMES = 720


def relight(
    detail: DetailFile,
    azimuth: Annotated[
        str,
        typer.Option(help="Degrees: one, a list as 0,90, or START:STOP:COUNT steps without STOP, as 0:360:12."),
    ],
    elevation: Annotated[str, typer.Option(help="Degrees above the picture, over 0 to 90 (-90 to 90 for a medium); as azimuth.")],
    folder: Annotated[Path, typer.Option("--output", "-o", help="The folder for the pictures.")],
    shape: Annotated[str, typer.Argument(metavar="[MESH]", help=MESH_HELP)] = "plane",
    scale: Scale = 1.0,
    pixels: Annotated[str, typer.Option("--size", help="WIDTHxHEIGHT in pixels.")] = "480x480",
    rotation: Rotation = None,
    fov: Fov = None,
    subsamples: Subsamples = 2,
    background: Background = "0",
    animation: Annotated[str, typer.Option(help="gif, png (animated, more colours) or none.")] = "gif",
    force: Annotated[bool, typer.Option("--force", help="Replace the frames in the folder.")] = False,
) -> None:
    """Render a detail under many lights: frames, a contact sheet (sheet.png) and an animation.

    Each elevation is gone through with every azimuth. Without MESH it is a plane that fills the picture.
    """
    from voldetail.apply import relight as frames_of
    from voldetail.recover.files import load_any

    azimuths = angles(azimuth, "--azimuth", lambda a: -720 <= a <= 720, "-720 to 720")
    record = load_any(detail)
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
    wide, turned, camera, shape = size(pixels), rotation_of(rotation), camera_of(fov), shape_of(shape)
    behind = background_of(background, record)
    use_threads()
    frames = frames_of(
        record, shape, azimuths=azimuths, elevations=elevations, scale=scale, size=wide, camera=camera,
        rotation=turned, subsamples=subsamples, background=behind, tell=tell,
    )  # fmt: skip
    _write_frames(folder, earlier, frames, count, animation, record.name)
    moving = _animation_name(animation, count)
    result(
        {"folder": str(folder), "frames": count, "sheet": "sheet.png", "animation": moving},
        f"{folder}  {count} frames, sheet.png" + (f" and {moving}" if moving else ""),
    )  # fmt: skip


def _write_frames(folder: Path, earlier: list[Path], frames: Any, count: int, animation: str, name: str) -> None:
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


def _animation_name(animation: str, count: int) -> str | None:
    return f"animation.{animation}" if animation != "none" and count > 1 else None


def _free_folder(folder: Path, force: bool) -> list[Path]:
    """Check the folder for the frames; return the frames of an earlier run in it, which ``force`` lets go."""
    check_folder(folder)
    earlier = sorted(p for p in folder.glob("*") if p.name.startswith(("frame-", "animation.")) or p.name == "sheet.png")
    if earlier and not force:
        raise InputError(f"{folder} holds {earlier[0].name} already; give --force to replace it, or another folder.")
    return earlier
