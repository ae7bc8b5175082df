"""PNG files of 16 bits a channel, which Pillow cannot write in colour: height, normals and roughness need them.

The format is that of the PNG specification (third edition, W3C 2025): signature, IHDR, optional sRGB and tEXt, IDAT, IEND.
"""

from __future__ import annotations

import struct
import zlib
from collections.abc import Mapping
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from voldetail.errors import VoldetailError
from voldetail.files import write_bytes

SIGNATURE = b"\x89PNG\r\n\x1a\n"
COLOUR_TYPES = {1: 0, 3: 2}
"""Greyscale and truecolour."""

UP = 2
"""The filter of every row: the difference to the row above, which suits smooth maps; the first row's above is zero."""

PERCEPTUAL = b"\x00"
LARGEST = 65535


def save_png16(path: Path, values: NDArray[np.floating], *, srgb: bool = False, text: Mapping[str, str] | None = None) -> None:
    """Save ``values`` (H, W) or (H, W, 3), stored numbers of 0 to 1 (clipped), as a PNG of 16 bits a channel.

    srgb: whether the file says that its numbers are sRGB-encoded (they have to be already). text: keywords (Latin-1, at most 79
    letters) and texts that go with it. The file appears whole or not at all. Raises VoldetailError for NaN or infinities.
    """
    pixels = np.asarray(values, np.float64)
    pixels = pixels[..., None] if pixels.ndim == 2 else pixels
    if pixels.ndim != 3 or pixels.shape[2] not in COLOUR_TYPES:
        raise ValueError(f"a picture is (H, W) or (H, W, 3), not {pixels.shape}")
    if not np.isfinite(pixels).all():
        raise VoldetailError(f"The picture for {path} holds values that are NaN or infinite; it was not saved.")
    rows, columns, channels = pixels.shape
    words = np.rint(np.clip(pixels, 0.0, 1.0) * LARGEST).astype(">u2")
    lines = np.frombuffer(words.tobytes(), np.uint8).reshape(rows, columns * channels * 2)
    above = np.concatenate([np.zeros_like(lines[:1]), lines[:-1]])
    filtered = np.concatenate([np.full((rows, 1), UP, np.uint8), lines - above], axis=1)
    chunks = [_chunk(b"IHDR", struct.pack(">IIBBBBB", columns, rows, 16, COLOUR_TYPES[channels], 0, 0, 0))]
    if srgb:
        chunks.append(_chunk(b"sRGB", PERCEPTUAL))
    chunks += [_chunk(b"tEXt", key.encode("latin-1") + b"\0" + words_.encode("latin-1", "replace"))
               for key, words_ in (text or {}).items()]  # fmt: skip
    chunks += [_chunk(b"IDAT", zlib.compress(filtered.tobytes(), 6)), _chunk(b"IEND", b"")]
    write_bytes(Path(path), SIGNATURE + b"".join(chunks))


def _chunk(kind: bytes, data: bytes) -> bytes:
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
