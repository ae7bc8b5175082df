"""What pictures of a detail have in common: the camera, samples, and what is seen where there is nothing."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import typer

from voldetail.cli.arguments import numbers
from voldetail.errors import InputError

if TYPE_CHECKING:
    from voldetail.detail.photo_relief import AnyDetail
    from voldetail.setup.camera import CameraSetup

BRIGHTEST = 1e3

Fov = Annotated[
    float | None,
    typer.Option(min=1, max=150, help="Degrees across; a perspective camera. Default: orthographic."),
]
Background = Annotated[
    str,
    typer.Option(help="Light where there is nothing: 0 is black; a number, R,G,B (linear), or photo: what the fit found there."),
]
Subsamples = Annotated[int, typer.Option(min=1, max=8, help="Samples a pixel, each way, under a light.")]


def camera_of(fov: float | None) -> CameraSetup | None:
    from voldetail.setup.camera import CameraSetup

    return None if fov is None else CameraSetup(kind="perspective", field_of_view=fov)


def background_of(text: str, record: AnyDetail) -> tuple[float, float, float]:
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
