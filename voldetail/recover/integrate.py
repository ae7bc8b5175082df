"""A height whose slopes are nearest to given ones.

Minimises the integral of |grad h - (p, q)|^2 (Frankot and Chellappa 1988 in the Fourier domain): Poisson's equation,
laplacian h = dp/dx + dq/dy, whose operator is diagonal in cosines on a picture with free edges (Simchony, Chellappa and Shao
1990), and in complex exponentials on a tile.
"""

from __future__ import annotations

import numpy as np
import scipy.fft as fft
from numpy.typing import NDArray

WORKERS = -1
"""Threads of a transform: all."""


def integrate(p: NDArray[np.float32], q: NDArray[np.float32], *, periodic: bool = False) -> NDArray[np.float32]:
    """Return the height (H, W) in pixels, of mean 0, of slopes ``p`` = dh/dx (right) and ``q`` = dh/dy (up), both (H, W).

    Slopes between neighbouring pixels are the means of theirs, h(x + 1) - h(x) = (p(x) + p(x + 1)) / 2. periodic: opposite edges
    meet.
    """
    if periodic:
        right = 0.5 * (p + np.roll(p, -1, axis=1))
        down = -0.5 * (q + np.roll(q, -1, axis=0))
        divergence = right - np.roll(right, 1, axis=1) + down - np.roll(down, 1, axis=0)
    else:
        right, down = np.zeros_like(p), np.zeros_like(q)
        right[:, :-1] = 0.5 * (p[:, :-1] + p[:, 1:])
        down[:-1] = -0.5 * (q[:-1] + q[1:])
        divergence = right.copy()
        divergence[:, 1:] -= right[:, :-1]
        divergence += down
        divergence[1:] -= down[:-1]
    rows, columns = p.shape
    if periodic:
        wy, wx = 2.0 * np.pi * np.arange(rows) / rows, 2.0 * np.pi * np.arange(columns // 2 + 1) / columns
        spectrum = fft.rfft2(divergence.astype(np.float32), workers=WORKERS)
    else:
        wy, wx = np.pi * np.arange(rows) / rows, np.pi * np.arange(columns) / columns
        spectrum = fft.dctn(divergence.astype(np.float32), type=2, workers=WORKERS)
    operator = (2.0 * np.cos(wy)[:, None] + 2.0 * np.cos(wx)[None, :] - 4.0).astype(np.float32)
    operator[0, 0] = 1.0
    spectrum = spectrum / operator
    spectrum[0, 0] = 0.0
    found = fft.irfft2(spectrum, s=p.shape, workers=WORKERS) if periodic else fft.idctn(spectrum, type=2, workers=WORKERS)
    return np.asarray(found, np.float32)


def without_plane(height: NDArray[np.float32], used: NDArray[np.bool_] | None = None) -> NDArray[np.float32]:
    """Return ``height`` (H, W) less the plane nearest to it where ``used``: no light tells how the whole photo is tilted."""
    rows, columns = height.shape
    y, x = np.mgrid[0:rows, 0:columns].astype(np.float32)
    x, y = x / columns - 0.5, y / rows - 0.5
    step = max(1, min(rows, columns) // 256)
    kept = np.ones(height.shape, bool) if used is None else used
    part = (slice(None, None, step), slice(None, None, step))
    chosen = kept[part] if kept[part].sum() >= 3 else np.ones_like(kept[part])
    columns_of = np.stack([x[part][chosen], y[part][chosen], np.ones(int(chosen.sum()), np.float32)], axis=1)
    plane, *_ = np.linalg.lstsq(columns_of.astype(np.float64), height[part][chosen].astype(np.float64), rcond=None)
    return np.asarray(height - (plane[0] * x + plane[1] * y + plane[2]), np.float32)
