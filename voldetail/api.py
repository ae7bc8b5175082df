"""The Python interface: about a dozen names that do what the commands do.

    from voldetail.api import fit, render
    result = fit("wall.jpg", light="135,40")
    picture = render(result.detail, "sphere")
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

from voldetail.apply import Gallery, gallery, relight, render
from voldetail.detail import Detail, load_detail, save_detail
from voldetail.errors import InputError, VoldetailError
from voldetail.fit import FitResult, Progress
from voldetail.fit import fit as fit_setup
from voldetail.image import load_photo, luminance, save_image
from voldetail.metric import Descriptor, describe, distance, distance_by_level
from voldetail.report import write_report
from voldetail.setup.file import load_setup, setup_from
from voldetail.setup.light import parse_light
from voldetail.setup.setup import Light, Setup

__all__ = [
    "Descriptor",
    "Detail",
    "FitResult",
    "Gallery",
    "InputError",
    "Light",
    "Progress",
    "Setup",
    "VoldetailError",
    "describe",
    "distance",
    "distance_by_level",
    "fit",
    "gallery",
    "load_detail",
    "load_photo",
    "load_setup",
    "luminance",
    "parse_light",
    "relight",
    "render",
    "save_detail",
    "save_image",
    "write_report",
]


def fit(
    photo: str | Path | Setup, light: str | Light | None = None, *,
    on_progress: Callable[[Progress], None] = lambda progress: None, **options: Any,
) -> FitResult:
    """Return the FitResult for a photo under a light, or for a whole Setup.

    ``photo`` is a file or "skimage:gravel" (":grass", ":brick"); ``light`` as on the command line ("AZ,EL", "x,y,z",
    "flash", "point:x,y,z", or "auto" to have it estimated) or a Light. ``options`` are the fields of a Setup, nested ones
    as dictionaries: mask, proxy={"kind": "sphere"}, camera, amplitude, domain, mode="volume", look="medium", seed,
    fit={"evaluations": 500, "library": "none"}, and zone and resolution of the photo. Raises InputError for input that cannot be
    used; Ctrl-C ends the search with the best so far.
    """
    if isinstance(photo, Setup):
        return fit_setup(photo, on_progress=on_progress)
    if light is None:
        raise InputError('A light is needed: "AZ,EL" in degrees, "x,y,z", "flash", "point:x,y,z" or "auto".')
    source: dict[str, Any] = {"path": str(photo)}
    source |= {key: options.pop(key) for key in ("zone", "resolution", "encoding") if key in options}
    setup = setup_from({"photo": source, "light": light, **options}, "the call of fit")
    return fit_setup(setup, on_progress=on_progress)
