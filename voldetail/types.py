"""Names for the arrays that the package hands around."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float32]
"""Numbers of a picture or of what is measured in it, in single precision as pictures are."""

Picture = NDArray[np.float32]
"""A linear picture (H, W) or (H, W, 3), row 0 on top."""

Mask = NDArray[np.bool_]
"""Which pixels (H, W) are used."""

Floats = NDArray[np.float64]
"""Numbers that are computed with, in double precision."""

Vector = NDArray[np.float64]
"""One point of the space that is searched, (N,)."""

Vertices = NDArray[np.float64]
"""Positions (V, 3)."""

Faces = NDArray[np.int64]
"""Corners (F, 3) of triangles."""
