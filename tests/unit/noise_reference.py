"""A second implementation of the noise, in NumPy and double precision, written from GD10 eq. 2 and 3.

It looks at every cell within two of a position and sorts, so it shares neither the order of the search nor
any array code with the package. Only the constants are taken from there.
"""

import itertools
import math

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from voldetail.noise import octave as constants
from voldetail.noise.gabor import ETA, OCTAVE_SALT
from voldetail.noise.moments import MOMENT_BLOCK, MOMENT_SALT, MOMENT_SAMPLES

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
    direction = np.stack(
        [np.cos(angle), np.sin(angle)] + [np.zeros_like(angle)] * (vectors.shape[-1] - 2), -1
    )
    if vectors.shape[-1] == 3:
        direction = direction @ TURN.T
    along = (vectors * direction).sum(-1)
    return envelope, np.cos(2 * np.pi * phi * (along + (words & np.uint32(0xFFFF)) / 65536))


def window(distances: Floats, dims: int) -> Floats:
    return np.clip(1 - (distances / constants.KERNEL_RADIUS[dims]) ** 2, 0, None) ** 2


def single_octave(
    x: Floats, first: int, last: int, salt: int, phi: float, theta: float, gaussian: bool = False
) -> Floats:
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


def moments(
    dims: int, first: int, last: int, phi: float, theta: float, gaussian: bool
) -> tuple[float, float]:
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
    weights = lacunarity ** -np.arange(octaves, dtype=np.float64)
    total = sum(
        w
        * single_octave(x / w, first, last, seed + i * OCTAVE_SALT, stripe_frequency, stripe_spread, gaussian)
        for i, w in enumerate(weights)
    )
    z = (total - mean * weights.sum()) / (ETA * deviation * np.sqrt((weights**2).sum()))
    return np.interp(z / np.sqrt(1 + z**2), np.linspace(-1, 1, len(curve)), curve)
