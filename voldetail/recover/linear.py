"""Slopes of a relief from its shading in one linear step.

For small slopes a matt surface under one light and a sky is (Pentland, "Linear shape from shading", 1990)

    d = -t a . grad h,    t = (1 - s) |l_xy| / l_z

so that in the Fourier domain D(w) = G(w) H(w), G = -i t (a . w). What lies across the light (a . w = 0) leaves no trace; it is
held back as in Wiener's filter:

    H = (1 + m) conj(G) D / (|G|^2 + m u^2 |w|^2 + u^2 w_0^2),    u = max(t, t_0)

which along the light is the inverse of G, but for what is slower than w_0.

Paint looks the same from all sides, while shading has the power cos^2 of the angle between w and a. In each octave of |w| the
power of d is therefore split into N + S cos^2, and D is multiplied by S cos^2 / (S cos^2 + N) first: Wiener's filter, whose
signal is the shading and whose noise the paint.

Symbols
    d    relative detail of the photo's light (recover.gates)
    h    height in pixels
    l    unit vector to the light; a, its direction in the image plane
    s    share of a bare plane's light that comes from the sky
    m    how much of what is steep across the light is held back
    w_0  frequency below which the light cannot tell slopes from its own fall-off
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.fft as fft
from numpy.typing import NDArray
from scipy.optimize import nnls

from voldetail.recover.light_map import LightMap

SKY_SHARE = 0.3
"""s: that of a clear day's open shade and of rooms is between 0.1 and 0.5."""

ACROSS = 0.25
"""m. Tuned on six scans of 192 pixels under light from 45 degrees."""

SLOWEST = 0.5
"""The longest wavelength, over the shorter side, that is taken for relief."""

LEAST_TILT, MOST_TILT = 0.3, 3.0
"""Bounds of t: a lamp in front leaves no first-order shading (t_0), and one at the horizon shades by shadows."""

BLOCKS = 4
"""Blocks a side within which a near light is taken for distant."""

FADE = 0.25
"""Of the shorter side: how far the photo fades out beyond its edges, so that opposite edges do not meet."""

OCTAVES, SECTORS, LEAST_FILLED = 8, 6, 6
"""Octaves of |w| below the finest, sectors of cos^2, and how many frequencies a sector has to hold."""

WORKERS = -1
"""Threads of a Fourier transform: all."""


Direction = tuple[float, float, float]


@dataclass(frozen=True, eq=False)
class Slopes:
    """p (H, W): dh/dx, x to the right; q (H, W): dh/dy, y up; both without unit."""

    p: NDArray[np.float32]
    q: NDArray[np.float32]


def linear_slopes(detail: NDArray[np.float32], light: LightMap, *, sky_share: float = SKY_SHARE) -> Slopes:
    """Return the slopes of what has the relative detail ``detail`` (H, W) under ``light``.

    A light whose direction varies is taken for distant within overlapping blocks, whose slopes are blended.
    """
    slowest = SLOWEST * min(detail.shape)
    if not light.varies:
        return slopes_under(detail, mean_direction(light.direction), slowest, sky_share=sky_share)
    rows, columns = detail.shape
    p, q = np.zeros_like(detail), np.zeros_like(detail)
    for vertical, (top, bottom) in windows(rows):
        for horizontal, (left, right) in windows(columns):
            part = slice(top, bottom), slice(left, right)
            window = np.outer(vertical, horizontal).astype(np.float32)
            found = slopes_under(detail[part], mean_direction(light.direction[part]), slowest, sky_share=sky_share)
            p[part] += window * found.p
            q[part] += window * found.q
    return Slopes(p, q)


def mean_direction(directions: NDArray[np.float32]) -> Direction:
    """Return the unit vector along the mean of ``directions`` (H, W, 3)."""
    mean = directions.reshape(-1, 3).mean(axis=0, dtype=np.float64)
    x, y, z = mean / np.linalg.norm(mean)
    return float(x), float(y), float(z)


def windows(side: int) -> list[tuple[NDArray[np.float64], tuple[int, int]]]:
    """Return for each of the overlapping blocks along an axis its cosine window and its first and last pixel; they sum to 1."""
    middle = (np.arange(BLOCKS) + 0.5) * side / BLOCKS
    step = side / BLOCKS
    place = np.arange(side) + 0.5
    weights = np.stack([0.5 + 0.5 * np.cos(np.pi * np.clip((place - m) / step, -1.0, 1.0)) for m in middle])
    weights /= weights.sum(axis=0)
    found = []
    for weight in weights:
        inside = np.flatnonzero(weight > 0)
        first, last = int(inside[0]), int(inside[-1]) + 1
        found.append((weight[first:last], (first, last)))
    return found


def slope_filter(
    wx: NDArray[np.floating], wy: NDArray[np.floating], direction: Direction, slowest: float, sky_share: float = SKY_SHARE
) -> NDArray[np.float32]:
    """Return K by which the spectra of the slopes are w K D, at frequencies ``wx`` and ``wy`` (y up) in radians a pixel.

    direction: the unit vector to the light. slowest: the longest wavelength that is taken for relief, in pixels.
    """
    lx, ly, lz = direction
    across = float(np.hypot(lx, ly))
    a = (lx / across, ly / across) if across > 1e-6 else (1.0, 0.0)
    tilt = min((1.0 - sky_share) * across / max(lz, 1e-3), MOST_TILT)
    held = max(tilt, LEAST_TILT)
    along = a[0] * wx + a[1] * wy
    denominator = (tilt * along) ** 2 + held**2 * (ACROSS * (wx**2 + wy**2) + (2.0 * np.pi / slowest) ** 2)
    # conj(G) = i t (a . w); slopes are i w H, so two factors i make -1.
    return np.asarray(-(1.0 + ACROSS) * tilt * along / denominator, np.float32)


def slopes_under(
    detail: NDArray[np.float32], direction: Direction, slowest: float, *, sky_share: float = SKY_SHARE, parted: bool = True
) -> Slopes:
    """Return the slopes under one distant light; ``slowest``: see `slope_filter`. parted: whether paint is held back."""
    pad = max(8, round(FADE * min(detail.shape)))
    padded, (top, left) = _faded(detail, pad)
    # y up: rows run down, so its frequency changes sign.
    wy = -2.0 * np.pi * fft.fftfreq(padded.shape[0])[:, None].astype(np.float32)
    wx = 2.0 * np.pi * fft.rfftfreq(padded.shape[1])[None, :].astype(np.float32)
    spectrum = fft.rfft2(padded, workers=WORKERS)
    if parted:
        flat = max(float(np.hypot(direction[0], direction[1])), 1e-9)
        spectrum *= shading_share(spectrum, (direction[0] * wx + direction[1] * wy) / flat, np.hypot(wx, wy))
    common = spectrum * slope_filter(wx, wy, direction, slowest, sky_share)
    rows, columns = detail.shape
    p, q = (fft.irfft2(common * w, s=padded.shape, workers=WORKERS)[top : top + rows, left : left + columns] for w in (wx, wy))
    return Slopes(np.ascontiguousarray(p, np.float32), np.ascontiguousarray(q, np.float32))


def shading_share(
    spectrum: NDArray[np.complexfloating], along: NDArray[np.floating], frequency: NDArray[np.floating]
) -> NDArray[np.float32]:
    """Return which share of ``spectrum`` (H, W) is shading, S cos^2 / (S cos^2 + N): ``along`` a . w, ``frequency`` |w|.

    N and S of an octave are the line through its mean powers in SECTORS of equal ranges of cos^2, neither below 0.
    """
    squared = np.clip(along / np.maximum(frequency, 1e-9), -1.0, 1.0) ** 2
    power = np.abs(spectrum) ** 2
    octave = np.clip(np.floor(np.log2(np.maximum(frequency, 1e-9) / np.pi) + OCTAVES), 0, OCTAVES - 1).astype(np.int64)
    sector = np.minimum((squared * SECTORS).astype(np.int64), SECTORS - 1)
    index = (octave * SECTORS + sector).ravel()
    size = OCTAVES * SECTORS
    count = np.bincount(index, minlength=size).reshape(OCTAVES, SECTORS)
    mean = np.bincount(index, power.ravel(), size).reshape(OCTAVES, SECTORS) / np.maximum(count, 1)
    middle = np.bincount(index, squared.ravel(), size).reshape(OCTAVES, SECTORS) / np.maximum(count, 1)
    share = np.tile([0.0, 1.0], (OCTAVES, 1))  # too few frequencies tell nothing: all of it is kept
    for k in range(OCTAVES):
        filled = count[k] >= LEAST_FILLED
        if filled.sum() >= 3:
            columns = np.stack([np.ones(int(filled.sum())), middle[k][filled]], axis=1)
            share[k] = nnls(columns, mean[k][filled])[0]
    share = share / np.maximum(share.sum(axis=1, keepdims=True), 1e-30)
    paint, shading = share[octave, 0], share[octave, 1] * squared
    return np.asarray(shading / np.maximum(shading + paint, 1e-12), np.float32)


def _faded(detail: NDArray[np.float32], pad: int) -> tuple[NDArray[np.float32], tuple[int, int]]:
    """Return ``detail`` mirrored beyond its edges and faded to 0 there, of a size that transforms fast, and where it begins."""
    rows, columns = (fft.next_fast_len(side + 2 * pad, real=True) for side in detail.shape)
    more = (pad, rows - detail.shape[0] - pad), (pad, columns - detail.shape[1] - pad)
    padded = np.pad(detail, more, mode="reflect" if min(detail.shape) > max(*more[0], *more[1]) else "edge")
    for axis, (before, after) in enumerate(more):
        ramp = np.ones(padded.shape[axis], np.float32)
        for count, part in ((before, slice(0, before)), (after, slice(len(ramp) - after, None))):
            fall = 0.5 - 0.5 * np.cos(np.pi * (np.arange(count, dtype=np.float32) + 0.5) / count)
            ramp[part] = fall if part.start == 0 else fall[::-1]
        padded *= ramp[:, None] if axis == 0 else ramp[None, :]
    return padded, (pad, pad)
