"""The pool of heights that a training draws from: this package's own noises, and simpler reliefs that it does not have.

Each is (SIDE, SIDE) float16 of mean 0 and deviation 1; how high and how large it is in a sample is drawn there.
"""

from __future__ import annotations

from collections.abc import Callable

import drjit as dr
import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import distance_transform_edt, gaussian_filter, map_coordinates, zoom
from scipy.spatial import cKDTree

from voldetail.backend import mitsuba
from voldetail.field.relief import relief_at
from voldetail.fit.warmstart.reliefs import library_relief

SIDE = 256
"""Pixels a side: four crops' worth."""

PIXEL = 2.0 / 192
"""Scene units a pixel, as in the library of reliefs."""

Heights = NDArray[np.float32]
Maker = Callable[[np.random.Generator], Heights]


def noise_relief(k: int, magnified: float) -> Heights:
    """Return relief ``k`` of the library, ``magnified`` times."""
    float_type = mitsuba().Float
    axis = (np.arange(SIDE, dtype=np.float32) - SIDE / 2) * np.float32(PIXEL / magnified)
    x, y = np.meshgrid(axis, axis)
    detail = library_relief(k, seed=7).detail()
    points = float_type(x.ravel()), float_type(y.ravel()), dr.zeros(float_type, x.size)
    return np.asarray(relief_at(detail, points)).reshape(SIDE, SIDE)


def spectral(rng: np.random.Generator) -> Heights:
    """Return Gaussian noise of a power law, perhaps stretched: ground, plaster, weathered rock."""
    fy, fx = np.fft.fftfreq(SIDE)[:, None], np.fft.rfftfreq(SIDE)[None, :]
    turn, stretch = rng.uniform(0, np.pi), 2.0 ** rng.uniform(0, 1.5)
    u, v = fx * np.cos(turn) + fy * np.sin(turn), (fy * np.cos(turn) - fx * np.sin(turn)) * stretch
    frequency = np.maximum(np.hypot(u, v), 1e-6)
    amplitude = frequency ** -rng.uniform(1.2, 2.6) * (frequency > 1.0 / rng.uniform(12, 160))
    phase = rng.standard_normal((SIDE, SIDE // 2 + 1)) + 1j * rng.standard_normal((SIDE, SIDE // 2 + 1))
    return np.fft.irfft2(amplitude * phase, s=(SIDE, SIDE)).astype(np.float32)


def _points(rng: np.random.Generator) -> NDArray[np.float64]:
    """Return scattered points, their mutual distance 7 to 60 pixels, over more than the square."""
    spacing = 7.0 * 2.0 ** rng.uniform(0, 3.1)
    side = int(np.ceil(SIDE / spacing)) + 4
    grid = np.stack(np.meshgrid(np.arange(side), np.arange(side)), axis=-1).reshape(-1, 2) - 1.5
    return (grid + rng.uniform(-0.5, 0.5, grid.shape) * rng.uniform(0.3, 1.0)) * spacing


def _grid() -> NDArray[np.float64]:
    return np.stack(np.meshgrid(np.arange(SIDE), np.arange(SIDE)), axis=-1).reshape(-1, 2).astype(np.float64)


def _cells(rng: np.random.Generator) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.int64], float]:
    """Return distances to the nearest and second point (SIDE, SIDE), the nearest's number, and the spacing."""
    points = _points(rng)
    place = _grid()
    if rng.random() < 0.6:
        place = place + 6.0 * np.stack([_smooth(rng, 18).ravel(), _smooth(rng, 18).ravel()], axis=-1)
    distance, index = cKDTree(points).query(place, k=2)
    shape = (SIDE, SIDE)
    spacing = float(np.sqrt(np.ptp(points[:, 0]) * np.ptp(points[:, 1]) / len(points)))
    return distance[:, 0].reshape(shape), distance[:, 1].reshape(shape), index[:, 0].reshape(shape), spacing


def _smooth(rng: np.random.Generator, sigma: float) -> NDArray[np.float64]:
    field = gaussian_filter(rng.standard_normal((SIDE, SIDE)), sigma, mode="wrap")
    return np.asarray(field / field.std())


def pebbles(rng: np.random.Generator) -> Heights:
    """Return round stones with deep gaps, each of its own height and tilt."""
    near, second, owner, spacing = _cells(rng)
    edge = np.clip((second - near) / (spacing * rng.uniform(0.3, 1.0)), 0.0, 1.0)
    body = np.sqrt(1.0 - (1.0 - edge) ** 2) if rng.random() < 0.6 else edge ** rng.uniform(0.3, 1.0)
    number = owner.max() + 1
    lift, tilts = rng.uniform(0, 1, number), rng.normal(0, rng.uniform(0, 0.5), (2, number))
    y, x = np.mgrid[0:SIDE, 0:SIDE] / spacing
    plane = tilts[0][owner] * (x % 7 - 3.5) * 0.3 + tilts[1][owner] * (y % 7 - 3.5) * 0.3
    return (body * (1.0 + rng.uniform(0, 0.8) * lift[owner]) + 0.3 * plane * body).astype(np.float32)


def facets(rng: np.random.Generator) -> Heights:
    """Return the lower envelope of many tilted planes: broken rock."""
    points = _points(rng)
    place, count = _grid(), int(rng.integers(2, 5))
    _, index = cKDTree(points).query(place, k=count)
    index = index.reshape(len(place), count)
    steep = rng.normal(0, 1, (len(points), 2))
    lift = rng.normal(0, 6, len(points))
    planes = np.einsum("nkc,nkc->nk", steep[index], place[:, None] - points[index]) + lift[index]
    found = planes.min(axis=1) if rng.random() < 0.5 else planes.max(axis=1)
    return gaussian_filter(found.reshape(SIDE, SIDE), rng.uniform(0.4, 1.5)).astype(np.float32)


def cracks(rng: np.random.Generator) -> Heights:
    """Return plates with narrow, deep cracks between them, curled at their edges."""
    near, second, owner, spacing = _cells(rng)
    gap = np.clip((second - near) / (spacing * rng.uniform(0.04, 0.2)), 0.0, 1.0)
    curl = rng.uniform(-0.5, 0.8) * (near / spacing) ** 2
    lift = rng.uniform(0, rng.uniform(0, 0.8), owner.max() + 1)[owner]
    return (gap * (1.0 + lift + curl) + rng.uniform(0, 0.08) * _smooth(rng, rng.uniform(0.8, 3))).astype(np.float32)


def ripples(rng: np.random.Generator) -> Heights:
    """Return ripples of sand, ridges of bark or of cloth: stripes that wander and branch."""
    turn, length = rng.uniform(0, np.pi), 6.0 * 2.0 ** rng.uniform(0, 3)
    y, x = np.mgrid[0:SIDE, 0:SIDE]
    phase = (x * np.cos(turn) + y * np.sin(turn)) * (2 * np.pi / length) + rng.uniform(0.3, 2.5) * _smooth(
        rng, rng.uniform(8, 40)
    )
    wave = np.sin(phase)
    sharp = np.sign(wave) * np.abs(wave) ** rng.uniform(0.4, 1.5)
    return (sharp * (1.0 + rng.uniform(0, 0.6) * _smooth(rng, 20))).astype(np.float32)


def pits(rng: np.random.Generator) -> Heights:
    """Return a plain with pits or bumps of many sizes."""
    field = np.zeros((SIDE, SIDE))
    y, x = np.mgrid[0:SIDE, 0:SIDE].astype(np.float64)
    sign = -1.0 if rng.random() < 0.6 else 1.0
    for _ in range(int(rng.integers(12, 120))):
        radius = 3.0 * 2.0 ** rng.uniform(0, 3)
        cx, cy = rng.uniform(0, SIDE, 2)
        squared = ((x - cx) ** 2 + ((y - cy) * rng.uniform(0.6, 1.6)) ** 2) / radius**2
        field = np.maximum(field, np.sqrt(np.clip(1.0 - squared, 0.0, None)) * radius)
    return (sign * field + rng.uniform(0, 2) * _smooth(rng, rng.uniform(1, 6))).astype(np.float32)


def bricks(rng: np.random.Generator) -> Heights:
    """Return courses of blocks with joints, their faces rough."""
    high, wide = rng.uniform(14, 60), rng.uniform(1.2, 3.0)
    y, x = np.mgrid[0:SIDE, 0:SIDE] + 2.5 * np.stack([_smooth(rng, 14), _smooth(rng, 14)])
    row = np.floor(y / high)
    column = x / (high * wide) + 0.5 * (row % 2) + 0.13 * row
    dx = np.minimum(column % 1, 1 - column % 1) * high * wide
    dy = np.minimum(y / high % 1, 1 - y / high % 1) * high
    joint = np.clip(np.minimum(dx, dy) / rng.uniform(1.5, 6), 0.0, 1.0)
    lift = np.sin(row * 12.9898 + np.floor(column) * 78.233) * 43758.5453 % 1
    return (joint * (1 + 0.6 * lift) + rng.uniform(0, 0.25) * _smooth(rng, rng.uniform(0.8, 4))).astype(np.float32)


def blades(rng: np.random.Generator) -> Heights:
    """Return thin strokes that lie over each other: grass, straw, fibres."""
    field = np.zeros((SIDE, SIDE))
    main, spread = rng.uniform(0, np.pi), rng.uniform(0.2, 1.6)
    for k in range(int(rng.integers(150, 500))):
        turn, length, width = main + rng.normal(0, spread), rng.uniform(15, 60), rng.uniform(1.0, 3.5)
        cx, cy = rng.uniform(0, SIDE, 2)
        reach = int(length) + 4
        y0, y1, x0, x1 = max(0, int(cy) - reach), min(SIDE, int(cy) + reach), max(0, int(cx) - reach), min(SIDE, int(cx) + reach)
        y, x = np.mgrid[y0:y1, x0:x1]
        u, v = (x - cx) * np.cos(turn) + (y - cy) * np.sin(turn), (y - cy) * np.cos(turn) - (x - cx) * np.sin(turn)
        body = np.clip(1 - (v / width) ** 2, 0, None) * np.clip(1 - (u / length) ** 2, 0, None)
        field[y0:y1, x0:x1] = np.where(
            body > 0, np.maximum(field[y0:y1, x0:x1], 0.02 * k + 1.5 * np.sqrt(body)), field[y0:y1, x0:x1]
        )
    return field.astype(np.float32)


def layered(rng: np.random.Generator) -> Heights:
    """Return terraces: slate, flaking paint, eroded layers."""
    base = _smooth(rng, rng.uniform(6, 30)) * rng.uniform(2, 6)
    steps = np.floor(base) + np.clip((base % 1) / rng.uniform(0.05, 0.5), 0, 1)
    return (steps + rng.uniform(0, 0.2) * _smooth(rng, rng.uniform(0.8, 3))).astype(np.float32)


def scratched(rng: np.random.Generator) -> Heights:
    """Return a surface with lines of cracks of all widths, by the distance to a few random curves."""
    lines = np.ones((SIDE, SIDE), bool)
    for _ in range(int(rng.integers(2, 9))):
        level = _smooth(rng, rng.uniform(8, 40))
        lines &= np.abs(level) > 0.02 * rng.uniform(0.5, 2)
    deep = np.clip(distance_transform_edt(lines) / rng.uniform(2, 10), 0, 1)
    return (deep + rng.uniform(0.02, 0.3) * _smooth(rng, rng.uniform(0.8, 5))).astype(np.float32)


MAKERS: tuple[Maker, ...] = (spectral, pebbles, facets, cracks, ripples, pits, bricks, blades, layered, scratched)


def warped(height: Heights, rng: np.random.Generator) -> Heights:
    """Return ``height`` with its places moved by a smooth field."""
    y, x = np.mgrid[0:SIDE, 0:SIDE]
    strength, sigma = rng.uniform(2, 10), rng.uniform(10, 40)
    places = [y + strength * _smooth(rng, sigma), x + strength * _smooth(rng, sigma)]
    return np.asarray(map_coordinates(height, places, order=1, mode="reflect"), np.float32)


def normalised(height: NDArray[np.floating]) -> NDArray[np.float16]:
    """Return ``height`` with mean 0 and deviation 1."""
    values = np.asarray(height, np.float64)
    return np.asarray((values - values.mean()) / max(float(values.std()), 1e-9), np.float16)


def pool(count: int, seed: int) -> NDArray[np.float16]:
    """Return ``count`` heights (count, SIDE, SIDE): a half from the package's noises, a half from the makers, some mixed.

    The same seed gives the same pool.
    """
    rng = np.random.default_rng(seed)
    out = np.empty((count, SIDE, SIDE), np.float16)
    for k in range(count):
        own = k % 2 == 0
        first = noise_relief(k // 2, float(2.0 ** rng.uniform(-0.5, 2.5))) if own else MAKERS[k // 2 % len(MAKERS)](rng)
        height = normalised(first).astype(np.float32)
        if k and rng.random() < 0.35:
            other = out[rng.integers(0, k)].astype(np.float32)
            if rng.random() < 0.5:  # another relief's finer pattern lies on it
                other = zoom(other[: SIDE // 2, : SIDE // 2], 2, order=1) if rng.random() < 0.3 else other
                height = height + rng.uniform(0.1, 0.5) * other
            else:
                height = height * (1.0 + 0.4 * np.clip(other, -2, 2))
        if rng.random() < 0.3:
            height = warped(height, rng)
        out[k] = normalised(height)
    return out
