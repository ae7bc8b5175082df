"""Linear images to files, by suffix."""

from collections.abc import Callable
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
import OpenEXR
from numpy.typing import NDArray
from PIL import Image

from voldetail.errors import InputError, VoldetailError
from voldetail.files import atomic, write_bytes
from voldetail.image.srgb import to_srgb

_JPEG_QUALITY = 95  # the highest that Pillow recommends; above it files grow and pictures do not improve


def save_png(path: Path, linear: NDArray[Any]) -> None:
    """Save a linear image (H, W) or (H, W, 3) as 8-bit sRGB PNG; values outside 0 to 1 are clipped."""
    _save_pillow(path, linear, format="PNG")


def save_jpeg(path: Path, linear: NDArray[Any]) -> None:
    """Save a linear image (H, W) or (H, W, 3) as 8-bit sRGB JPEG; values outside 0 to 1 are clipped."""
    _save_pillow(path, linear, format="JPEG", quality=_JPEG_QUALITY, subsampling=0)


def save_exr(path: Path, linear: NDArray[Any]) -> None:
    """Save a linear image (H, W) or (H, W, 3) as OpenEXR, 32-bit float, compressed without loss, nothing clipped."""
    pixels = _checked(path, linear)
    names = "Y" if pixels.ndim == 2 else "RGB"
    planes = pixels[..., None] if pixels.ndim == 2 else pixels
    channels = {name: np.ascontiguousarray(planes[..., i]) for i, name in enumerate(names)}
    header = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage}
    with atomic(Path(path)) as temporary:
        try:
            OpenEXR.File(header, channels).write(str(temporary))
        except (RuntimeError, ValueError) as error:  # how the library reports a full disk
            raise OSError(str(error)) from error


WRITERS: dict[str, Callable[[Path, NDArray[Any]], None]] = {
    ".png": save_png,
    ".exr": save_exr,
    ".jpg": save_jpeg,
    ".jpeg": save_jpeg,
}


def save_image(path: str | Path, linear: NDArray[Any]) -> None:
    """Save a linear image (H, W) or (H, W, 3) in the format that the suffix of `path` names, atomically.

    `.png` and `.jpg` hold 8-bit sRGB (clipped), `.exr` linear 32-bit float. Raises InputError for another
    suffix or where nothing can be written, VoldetailError for an image with NaN or infinities.
    """
    path = Path(path)
    check_suffix(path)
    WRITERS[path.suffix.lower()](path, linear)


def check_suffix(path: str | Path) -> None:
    """Raise InputError unless `save_image` knows the suffix of `path`; ask before long work."""
    suffix = Path(path).suffix.lower()
    if suffix not in WRITERS:
        found = f"the suffix {suffix}" if suffix else "no suffix"
        raise InputError(f"Cannot save a picture as {path}: it has {found}; use one of {', '.join(WRITERS)}.")


def _save_pillow(path: Path, linear: NDArray[Any], **options: Any) -> None:
    encoded = np.rint(np.clip(to_srgb(_checked(path, linear)), 0, 1) * 255).astype(np.uint8)
    buffer = BytesIO()  # and not the file: Pillow was seen to leave half a JPEG on a full disk without a word
    Image.fromarray(encoded).save(buffer, **options)
    write_bytes(Path(path), buffer.getvalue())


def _checked(path: Path, linear: NDArray[Any]) -> NDArray[np.float32]:
    pixels = np.asarray(linear, dtype=np.float32)
    if pixels.ndim != 2 and not (pixels.ndim == 3 and pixels.shape[2] == 3):
        raise ValueError(f"an image is (H, W) or (H, W, 3), not {pixels.shape}")
    wrong = int(np.count_nonzero(~np.isfinite(pixels)))
    if wrong:
        raise VoldetailError(f"The picture for {path} holds {wrong} values that are NaN or infinite; it was not saved.")
    return pixels
