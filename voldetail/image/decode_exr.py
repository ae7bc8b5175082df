"""Stored values of OpenEXR files."""

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import Imath  # type: ignore[import-untyped]  # comes with OpenEXR
import numpy as np
import OpenEXR
from numpy.typing import NDArray

from voldetail.errors import InputError
from voldetail.image.samples import Samples, check_pixels

MAGIC = b"\x76\x2f\x31\x01"
_FLOAT = Imath.PixelType(Imath.PixelType.FLOAT)
_FLAT = (OpenEXR.scanlineimage, OpenEXR.tiledimage)


def decode_exr(path: Path, what: str) -> Samples:
    """Decode a flat OpenEXR file (channels R, G, B or Y, any compression), its size checked first."""
    # Two classes of the library, one for each half of the work. On damaged files InputFile crashes in its
    # header(), where File raises; and File prints what is wrong with the pixels and goes on without them,
    # where InputFile raises.
    with _stderr_closed():
        parts = OpenEXR.File(str(path), header_only=True).parts
        header = parts[0].header
        if header.get("type", OpenEXR.scanlineimage) not in _FLAT:
            raise InputError(f"The {what} {path} is a deep OpenEXR file; save it flat, with the channels R, G and B.")
        low, high = (np.asarray(corner).tolist() for corner in header["dataWindow"])
        width, height = high[0] - low[0] + 1, high[1] - low[1] + 1
        check_pixels(width, height, what, path)
        channels = {channel.name for channel in header["channels"]}
        wanted = ["R", "G", "B"] if {"R", "G", "B"} <= channels else ["Y"]
        if "Y" in wanted and ("Y" not in channels or {"RY", "BY"} & channels):
            names = ", ".join(sorted(channels)[:8]) or "none"
            raise InputError(f"The {what} {path} has the channels {names!r}; save it with R, G and B, or Y alone.")
        file: Any = OpenEXR.InputFile(str(path))
        planes = [_plane(file, name, (height, width), what, path) for name in wanted]
        alpha = _plane(file, "A", (height, width), what, path) if "A" in channels else None
        file.close()
    notes = (f"the first of {len(parts)} parts used",) if len(parts) > 1 else ()
    return Samples(planes[0] if len(planes) == 1 else np.stack(planes, axis=-1), alpha, notes=notes)


def _plane(file: Any, name: str, shape: tuple[int, int], what: str, path: Path) -> NDArray[np.float32]:
    data = file.channel(name, _FLOAT)  # half and integer channels are converted
    if len(data) != 4 * shape[0] * shape[1]:
        raise InputError(f"The {what} {path} has a subsampled channel {name}; save it with R, G and B at full size.")
    return np.frombuffer(data, dtype=np.float32).reshape(shape)


@contextmanager
def _stderr_closed() -> Iterator[None]:
    """Keep the library's own lines about damaged files off the user's terminal: it writes them to descriptor 2."""
    try:
        kept = os.dup(2)
    except OSError:  # there is no standard error to protect
        yield
        return
    nowhere = os.open(os.devnull, os.O_WRONLY)
    try:
        os.dup2(nowhere, 2)
        yield
    finally:
        os.dup2(kept, 2)
        os.close(kept)
        os.close(nowhere)
