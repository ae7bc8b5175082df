"""A second implementation of the noise, in NumPy and double precision, written from GD10 eq. 2 and 3.

It looks at every cell within two of a position and sorts, so it shares neither the order of the search nor
any array code with the package. Only the constants are taken from there.
"""

import itertools
import math

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from voldetail.noise import gabor as constants
from voldetail.noise import stones
from voldetail.noise.moments import MOMENT_BLOCK, MOMENT_SALT, MOMENT_SAMPLES
from voldetail.noise.plates import PLATE_SALT
from voldetail.noise.relief import ETA, OCTAVE_SALT

Floats = NDArray[np.float64]
QUATERNION = [math.sqrt(2), 1.0, math.sqrt(3) / 2, (math.sqrt(5) - 1) / 2]
TURN = Rotation.from_quat([*QUATERNION[1:], QUATERNION[0]]).as_matrix()


def hash_words(cells: NDArray[np.int64], salt: int) -> NDArray[np.uint32]:
    """pcg4d over cells (..., 2 or 3): four words (..., 4)."""
    third = cells[..., 2] if cells.shape[-1] == 3 else np.zeros(cells.shape[:-1], np.int64)
    v = [np.asarray(c).astype(np.uint32) for c in (cells[..., 0], cells[..., 1], third)]
    v.append(np.full(third.shape, salt & 0xFFFFFFFF, np.uint32))
    v = [c * np.uint32(1664525) + np.uint32(1013904223) for c in v]
    for shuffle in (True, False):
        v[0] = v[0] + v[1] * v[3]
        v[1] = v[1] + v[2] * v[0]
        v[2] = v[2] + v[0] * v[1]
        v[3] = v[3] + v[1] * v[2]
        if shuffle:
            v = [c ^ (c >> np.uint32(16)) for c in v]
    return np.stack(v, axis=-1)


def feature_points(cells: NDArray[np.int64], salt: int) -> tuple[Floats, NDArray[np.uint32]]:
    """Absolute positions (..., d) of the cells' points and the spare word (...)."""
    words = hash_words(cells, salt)
    dims = cells.shape[-1]
    return cells + (words[..., :dims] >> np.uint32(8)) / 2.0**24, words[..., 3]


def sorted_points(x: Floats, salt: int, reach: int = 2) -> tuple[Floats, Floats, NDArray[np.uint32]]:
    """Distances (N, K), vectors from point to x (N, K, d) and words (N, K) of all cells, nearest first."""
    offsets = np.array(list(itertools.product(range(-reach, reach + 1), repeat=x.shape[1])))
    points, words = feature_points(np.floor(x).astype(np.int64)[:, None] + offsets, salt)
    vectors = x[:, None] - points
    distances = np.linalg.norm(vectors, axis=-1)
    order = np.argsort(distances, axis=1, kind="stable")
    return (
        np.take_along_axis(distances, order, 1),
        np.take_along_axis(vectors, order[..., None], 1),
        np.take_along_axis(words, order, 1),
    )


def kernels(
    distances: Floats, vectors: Floats, words: NDArray[np.uint32], phi: float, theta: float, gaussian: bool
) -> tuple[Floats, Floats]:
    """Envelope and stripes of each point."""
    if gaussian:
        envelope = np.exp(-(distances**2) / (2 * constants.GAUSSIAN_SIGMA**2))
    else:
        envelope = np.exp(-distances / (2 * constants.SIGMA))
    angle = (words >> np.uint32(16)) / 65536 * theta
    direction = np.stack([np.cos(angle), np.sin(angle)] + [np.zeros_like(angle)] * (vectors.shape[-1] - 2), -1)
    if vectors.shape[-1] == 3:
        direction = direction @ TURN.T
    along = (vectors * direction).sum(-1)
    return envelope, np.cos(2 * np.pi * phi * (along + (words & np.uint32(0xFFFF)) / 65536))


def window(distances: Floats, dims: int) -> Floats:
    return np.clip(1 - (distances / constants.KERNEL_RADIUS[dims]) ** 2, 0, None) ** 2


def single_octave(x: Floats, first: int, last: int, salt: int, phi: float, theta: float, gaussian: bool = False) -> Floats:
    """N(x) of eq. 2, positions in cells (N, d)."""
    d, vectors, words = sorted_points(x, salt)
    envelope, stripes = kernels(d, vectors, words, phi, theta, gaussian)
    if last == 50:
        return (envelope * stripes * window(d, x.shape[1])).sum(1)
    total = np.zeros(len(x))
    for i in range(first - 1, last):
        fade = np.clip((d[:, last] - d[:, i]) / constants.RANK_FADE, 0, 1)
        if first > 1:
            fade = fade * np.clip((d[:, i] - d[:, first - 2]) / constants.RANK_FADE, 0, 1)
        total += envelope[:, i] * ((1 - fade) + fade * stripes[:, i])
    return total


def highest_stone(
    x: Floats, salt: int, facets: float, elongation: float, spread: float, rounded: bool
) -> tuple[Floats, NDArray[np.uint32]]:
    """Height (N,) and hash word (N,) of the body on top, from all cells within three of a position."""
    offsets = np.array(list(itertools.product(range(-3, 4), repeat=x.shape[1])))
    points, words = feature_points(np.floor(x).astype(np.int64)[:, None] + offsets, salt)
    vectors = points - x[:, None]
    mixed = (words ^ (words >> np.uint32(15))) * np.uint32(stones.SHAPE_SALT)
    mixed = mixed ^ (mixed >> np.uint32(13))
    drawn = [((mixed >> np.uint32(8 * byte)) & np.uint32(255)) / 256 for byte in range(3)]
    thin = [np.ones_like(drawn[0]), *(1 + (elongation - 1) * d for d in drawn[1:])][: x.shape[1]]
    if x.shape[1] == 2:
        angle = 2 * np.pi * (words >> np.uint32(24)) / 256
        turn = np.stack([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]]).transpose(2, 3, 0, 1)
    else:
        parts = [((words >> np.uint32(8 * byte)) & np.uint32(255)) / 256 - (0.5 - 1 / 512) for byte in range(4)]
        quaternion = np.stack([*parts[1:], parts[0]], -1).reshape(-1, 4)
        turn = Rotation.from_quat(quaternion).as_matrix().reshape(*words.shape, 3, 3)
    w = np.einsum("nkij,nkj->nki", turn, vectors) * np.stack(thin, -1)
    sizes = np.abs(w)
    angular = math.hypot(1.0, 0.5) * np.maximum(sizes.max(-1), sizes.sum(-1) / 1.5)
    gauge = (1 - facets) * np.linalg.norm(w, axis=-1) + facets * angular
    share = gauge / (stones.STONE_RADIUS[x.shape[1]] * (1 - spread * drawn[0]))
    height = 1 - share ** (2 if rounded else 1)
    top = height.argmax(1)
    rows = np.arange(len(x))
    return np.maximum(height[rows, top], 0.0), words[rows, top]


def moments(dims: int, first: int, last: int, phi: float, theta: float, gaussian: bool) -> tuple[float, float]:
    """Mean and deviation over the package's positions: powers of the root of g^(d+1) = g + 1."""
    roots = np.roots([1.0, *[0.0] * (dims - 1), -1.0, -1.0])
    golden = float(np.real(roots[np.argmax(np.real(roots))]))
    index = np.arange(1, MOMENT_SAMPLES + 1)
    x = np.stack([(index * golden ** -(a + 1.0)) % 1.0 for a in range(dims)], -1) * MOMENT_BLOCK
    values = single_octave(x, first, last, MOMENT_SALT, phi, theta, gaussian)
    return float(values.mean()), float(values.std())


def relief(
    points: Floats,
    first: int,
    last: int,
    seed: int,
    *,
    octaves: int,
    gaussian: bool,
    scale: float,
    anisotropy: float,
    angle: float,
    lacunarity: float,
    gain: float,
    stripe_frequency: float,
    stripe_spread: float,
    curve: Floats,
) -> Floats:
    """R(x) of eq. 3, positions in scene units (N, d)."""
    dims = points.shape[1]
    frame = np.eye(dims)
    frame[:2, :2] = [[math.cos(angle), math.sin(angle)], [-math.sin(angle), math.cos(angle)]]
    stretch = np.diag([scale * anisotropy] + [scale] * (dims - 1))
    x = points @ (stretch @ frame).T
    if dims == 3:
        x = x @ TURN.T
    mean, deviation = moments(dims, first, last, stripe_frequency, stripe_spread, gaussian)
    frequencies = lacunarity ** np.arange(octaves, dtype=np.float64)
    weights = gain ** np.arange(octaves) / frequencies
    total = sum(
        w * single_octave(x * f, first, last, seed + i * OCTAVE_SALT, stripe_frequency, stripe_spread, gaussian)
        for i, (w, f) in enumerate(zip(weights, frequencies, strict=True))
    )
    z = (total - mean * weights.sum()) / (ETA * deviation * np.sqrt((weights**2).sum()))
    return np.interp(z / np.sqrt(1 + z**2), np.linspace(-1, 1, len(curve)), curve)


def plates(x: Floats, salt: int, height: float, tilt: float, bevel: float) -> Floats:
    """What the planes of the cells add (N,), from the borders with all cells within three of a position."""
    dims = x.shape[1]
    distances, vectors, words = sorted_points(x, salt, 3)
    mixed = words[:, 0]
    for shift, factor in ((16, True), (15, True), (16, False)):
        mixed = mixed ^ (mixed >> np.uint32(shift))
        mixed = mixed * np.uint32(PLATE_SALT) if factor else mixed
    bits = mixed.astype(np.int64)
    azimuth = 2 * np.pi * (bits % 1024) / 1024
    z = ((bits // 1024) % 1024 + 0.5) / 512 - 1
    direction = np.stack([np.sin(np.arccos(z)) * np.cos(azimuth), np.sin(np.arccos(z)) * np.sin(azimuth), z], -1)[:, :dims]
    apart = np.linalg.norm(vectors[:, 1:] - vectors[:, :1], axis=-1)
    borders = (distances[:, 1:] ** 2 - distances[:, :1] ** 2) / (2 * apart)
    share = np.minimum(borders.min(1) / np.minimum(bevel, 1 - distances[:, 0] / 2), 1.0)
    plane = height * (bits // 2**20) / 4096 + tilt * (0.5 + (direction * vectors[:, 0]).sum(1))
    return (1 - (1 - share) ** 2) * plane
