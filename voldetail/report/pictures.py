"""Linear pictures as what a page shows: 8-bit sRGB, PNG bytes, data URIs."""

from __future__ import annotations

import base64
from io import BytesIO
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from voldetail.image import to_srgb

DIMMED = 0.25  # of the light of what the mask leaves out, so that it is seen but not mistaken for the match


def encoded(linear: NDArray[Any]) -> NDArray[np.uint8]:
    """8-bit sRGB (H, W, 3) of a linear picture (H, W) or (H, W, 3); clipped, NaN is black."""
    finite = np.nan_to_num(np.asarray(linear, dtype=np.float32), nan=0.0, posinf=1.0, neginf=0.0)
    made = np.rint(np.clip(to_srgb(finite), 0, 1) * 255).astype(np.uint8)
    return np.ascontiguousarray(np.repeat(made[..., None], 3, axis=2) if made.ndim == 2 else made)


def dimmed(linear: NDArray[Any], mask: NDArray[np.bool_]) -> NDArray[np.float32]:
    """A copy of a picture (H, W, 3) that is dark where ``mask`` (H, W) is False."""
    return np.asarray(np.where(mask[..., None], linear, linear * DIMMED), dtype=np.float32)


def png_bytes(linear: NDArray[Any]) -> bytes:
    """A linear picture as the bytes of an 8-bit sRGB PNG."""
    buffer = BytesIO()
    Image.fromarray(encoded(linear)).save(buffer, format="PNG", optimize=True)
    return buffer.getvalue()


def data_uri(linear: NDArray[Any]) -> str:
    """A linear picture as a data URI that a page can hold inside."""
    return "data:image/png;base64," + base64.b64encode(png_bytes(linear)).decode("ascii")
