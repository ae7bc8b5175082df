"""Environment maps: checked, read by Mitsuba; y is up, and the picture's middle lights the side facing the viewer."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from voldetail.backend import helpers_for_files, mitsuba
from voldetail.errors import InputError
from voldetail.files import readable

SUFFIXES = (".exr", ".hdr")
LARGEST = 512 * 2**20
"""Bytes of a map: four times those of 8192 x 4096 in half floats."""


def checked_environment(path: Path) -> Path:
    """Return ``path`` if it is a file of a known kind and of at most LARGEST bytes; raises InputError for another."""
    if path.suffix.lower() not in SUFFIXES:
        raise InputError(f"The environment map {path} is not of a known kind: give an .exr or .hdr file.")
    return readable(path, "environment map", LARGEST)


def environment_emitter(path: Path) -> Any:
    """Return a Mitsuba emitter for an equirectangular map.

    Raises InputError for a file that is missing, too large, of another kind, unreadable, or with values that are not
    finite and at least 0.
    """
    mi = mitsuba()
    checked_environment(path)
    try:
        with helpers_for_files():
            stored = mi.Bitmap(str(path))
        bitmap = stored.convert(mi.Bitmap.PixelFormat.RGB, mi.Struct.Type.Float32, srgb_gamma=False)
    except RuntimeError as error:
        raise InputError(f"The environment map {path.name} cannot be read: it is damaged or not an image.") from error
    values = np.asarray(bitmap)
    if not np.isfinite(values).all() or values.min() < 0:
        raise InputError(f"The environment map {path.name} holds values that are negative or not finite: mend it first.")
    return mi.load_dict({"type": "envmap", "bitmap": bitmap})
