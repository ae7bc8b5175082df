"""What a small network, trained on reliefs that voldetail made itself (voldetail.training), sees in a photo.

It is given log luminance and chroma over their local means, the light's direction at each pixel and the slopes that the linear
step (recover.linear) finds there; it says what of these is to be kept and added, log albedo, and how far its normals are likely
off. The light is turned to within 45 degrees of +x by quarter turns, which lose nothing. Larger forms than its window holds are
read from smaller copies of the photo: slopes have no unit, and those of each copy take the place of the finer one's slow part.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from importlib.resources import as_file, files

import numpy as np
from scipy.ndimage import gaussian_filter

from voldetail.image import luminance, resize
from voldetail.recover.gates import BRIGHTEST, DARKEST
from voldetail.recover.light_map import LightMap
from voldetail.recover.linear import mean_direction, slopes_under, windows
from voldetail.recover.network_layers import multiple, run
from voldetail.types import Array

SLOW = 16.0
"""Pixels: deviation of the local mean, as in training (training.samples)."""

DARK = 0.02
"""Of the mean light: added before logarithms, as in training."""

SLOWEST = 96.0
"""Pixels: the longest wave of the linear step's slopes, as in training."""

RIM = 32
"""Pixels of mirrored photo about what is read: the network's own zeros beyond the edges mean nothing."""

BLOCK, OVERLAP = 1024, 64
"""Pixels a side that are read at once, and by which such parts overlap: some 900 MB."""

SMALLEST_COPY = 96
"""Pixels of the shorter side of the smallest copy."""

COPIES = 3
"""Copies at most, each half as large as the one before."""


@dataclass(frozen=True, eq=False)
class Prediction:
    """p = dh/dx (right), q = dh/dy (up). paint: log albedo over its local mean. error: of a normal's part. All (H, W)."""

    p: Array
    q: Array
    paint: Array
    error: Array


@lru_cache(maxsize=1)
def weights() -> dict[str, Array]:
    """Return the network's arrays by name: float16 in the file, float32 here. Nothing in the file is executed."""
    with as_file(files("voldetail.recover").joinpath("weights.npz")) as path, np.load(path, allow_pickle=False) as stored:
        return {name: stored[name].astype(np.float32) for name in stored.files}


def predict(photo: Array, light: LightMap) -> Prediction:
    """Return what the network sees in ``photo`` (H, W, 3), linear light without its slow fall-off, under ``light``."""
    found = _at_one_scale(photo, light.direction)
    p, q = found.p, found.q
    size = photo.shape[:2]
    copies = []
    for k in range(1, COPIES + 1):
        rows, columns = (max(1, s // 2**k) for s in size)
        if min(rows, columns) < SMALLEST_COPY:
            break
        smaller = _at_one_scale(resize(photo, (rows, columns)), resize(light.direction, (rows, columns)))
        copies.append((smaller.p, smaller.q))
    # From the smallest up: what is slower than a copy's window comes from the copy below it.
    for k in range(len(copies) - 1, -1, -1):
        finer = copies[k - 1] if k else (p, q)
        merged = tuple(_with_slow_of(fine, coarse) for fine, coarse in zip(finer, copies[k], strict=True))
        if k:
            copies[k - 1] = merged[0], merged[1]
        else:
            p, q = merged
    return Prediction(p, q, found.paint, found.error)


def _with_slow_of(fine: Array, coarse: Array) -> Array:
    """Return ``fine`` with its slow part replaced by that of ``coarse``, which has half its pixels a side."""
    shape = (fine.shape[0], fine.shape[1])
    slow = gaussian_filter(coarse, SLOW / 2, mode="reflect", truncate=3.0)
    return np.asarray(fine - gaussian_filter(fine, SLOW, mode="reflect", truncate=3.0) + resize(slow, shape), np.float32)


def features(photo: Array) -> Array:
    """Return log luminance and log R/G, B/G (H, W, 3) over their local means."""
    light = luminance(photo)
    floor = np.float32(DARK * max(float(light.mean()), 1e-6))
    logs = np.log(photo + floor)
    values = np.stack([np.log(light + floor), logs[..., 0] - logs[..., 1], logs[..., 2] - logs[..., 1]], axis=-1)
    slow = np.stack([gaussian_filter(values[..., k], SLOW, mode="mirror", truncate=3.0) for k in range(3)], axis=-1)
    return np.asarray(values - slow, np.float32)


def _at_one_scale(photo: Array, direction: Array) -> Prediction:
    seen = features(photo)
    rows, columns = seen.shape[:2]
    spread = float(np.ptp(direction[::8, ::8].reshape(-1, 3), axis=0).max())
    if spread < 0.3:  # one turn suits all of it
        return _by_blocks(seen, direction)
    total = np.zeros((rows, columns, 4), np.float32)
    for vertical, (top, bottom) in windows(rows):
        for horizontal, (left, right) in windows(columns):
            part = slice(top, bottom), slice(left, right)
            found = _by_blocks(seen[part], direction[part])
            window = np.outer(vertical, horizontal).astype(np.float32)[..., None]
            total[part] += window * np.stack([found.p, found.q, found.paint, found.error], axis=-1)
    return Prediction(*(np.ascontiguousarray(total[..., k]) for k in range(4)))


def _by_blocks(seen: Array, direction: Array) -> Prediction:
    """Return the prediction for features (H, W, 3), in parts that fit into memory."""
    rows, columns = seen.shape[:2]
    total = np.empty((rows, columns, 4), np.float32)
    for top in range(0, rows, BLOCK):
        for left in range(0, columns, BLOCK):
            bottom, right = min(top + BLOCK, rows), min(left + BLOCK, columns)
            t, b = max(0, top - OVERLAP), min(rows, bottom + OVERLAP)
            first, end = max(0, left - OVERLAP), min(columns, right + OVERLAP)
            found = _turned(seen[t:b, first:end], direction[t:b, first:end])
            total[top:bottom, left:right] = found[top - t : bottom - t, left - first : right - first]
    p, q, log_error, paint = (np.ascontiguousarray(total[..., k]) for k in range(4))
    return Prediction(p, q, paint, np.exp(np.clip(log_error, -3.5, 1.0)))


def _turned(seen: Array, direction: Array) -> Array:
    """Return the network's answers (H, W, 4), the picture turned so that the light comes from the right, and turned back."""
    x, y, _ = mean_direction(direction)
    turns = int(np.round(-np.arctan2(y, x) / (0.5 * np.pi))) % 4
    cosine, sine = ((1, 0), (0, 1), (-1, 0), (0, -1))[turns]
    lx, ly = direction[..., 0], direction[..., 1]
    light = np.stack([cosine * lx - sine * ly, sine * lx + cosine * ly, direction[..., 2]], axis=-1)
    turned = np.rot90(np.concatenate([seen, light], axis=-1), turns)
    first = slopes_under(relative(turned[..., 0]), mean_direction(turned[..., 3:6]), SLOWEST, parted=False)
    inputs = np.concatenate([turned, first.p[..., None], first.q[..., None]], axis=-1)
    said = _padded(np.ascontiguousarray(inputs, np.float32))
    kept = said[..., 4]
    found = np.rot90(
        np.stack([first.p * kept + said[..., 0], first.q * kept + said[..., 1], said[..., 2], said[..., 3]], -1), -turns
    )
    p, q = found[..., 0], found[..., 1]
    back = [cosine * p + sine * q, cosine * q - sine * p, found[..., 2], found[..., 3]]
    return np.stack(back, axis=-1).astype(np.float32)


def relative(log: Array) -> Array:
    """Return the relative detail d of ``log``, the logarithm of luminance over its local mean."""
    return np.clip(np.exp(log) - 1.0, DARKEST, BRIGHTEST).astype(np.float32)


def _padded(inputs: Array) -> Array:
    """Return the network's answers for inputs of any size, mirrored beyond their edges."""
    arrays = weights()
    step = multiple(arrays)
    rows, columns = inputs.shape[:2]
    more = [(RIM, -(side + RIM) % step + RIM // step * step) for side in (rows, columns)]
    wide = np.pad(inputs, (*more, (0, 0)), mode="symmetric")
    return run(wide, arrays)[RIM : RIM + rows, RIM : RIM + columns]
