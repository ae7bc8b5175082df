"""Windowed Fourier responses of an image (GD10 eq. 4), without an FFT.

The filter is a Gaussian window times a complex exponential, and both factors split into a row and a column part.
A real image needs only the frequencies 0..3 in each direction, i.e. seven real one-dimensional filters (one for 0,
a cosine and a sine for each other). The amplitudes of (u, v) and (u, -v) are two combinations of the same parts.
Each one-dimensional pass is a product with a small banded matrix, which a BLAS does faster than tap by tap. Products
are kept so small that OpenBLAS does each in the calling thread: its other threads would go on spinning for tens of
milliseconds and take the processor from the renderer that runs next.
"""

from functools import lru_cache

import numpy as np
from numpy.lib.stride_tricks import as_strided

from voldetail.types import Array

HALF_WINDOW = 4
"""m_s of GD10 section 5: the window covers offsets -m_s + 1 to m_s."""

WINDOW = 2 * HALF_WINDOW
"""Side of the window in pixels."""

WINDOW_SIGMA = HALF_WINDOW / 2
"""Standard deviation of the Gaussian window in pixels. The paper gives none: at half of m_s the window has
fallen to exp(-2) = 0.14 at its border, so it is neither a box nor a point."""

FREQUENCIES: tuple[tuple[int, int], ...] = (
    (0, 0), (1, 0), (1, 1), (0, 1), (1, -1), (2, 0), (2, 2), (0, 2), (2, -2),
    (2, 1), (1, 2), (-2, 1), (1, -2), (3, 0), (0, 3), (3, 3), (3, -3),
)  # fmt: skip
"""The 17 frequencies (u, v) of GD10 section 5, u along x (columns) and v along y (rows downwards), in cycles per
window. The text at hand repeats "(0,2), (2,-2), (2," after (2,-2); without the repetition exactly 17 distinct pairs
remain, the number that the paper states."""

_BLOCK = 8
"""Outputs along one axis of each small matrix product; tuned on 192 x 192 pixels."""

_ONE_THREAD = 4 * 65536
"""Multiplications up to which OpenBLAS keeps a product in one thread (its GEMM_MULTITHREAD_THRESHOLD x 65536)."""

_PAIRED_WITH: dict[int, tuple[int, ...]] = {
    u: tuple(sorted({abs(v) for uu, v in FREQUENCIES if abs(uu) == u})) for u in range(HALF_WINDOW)
}
"""For each |u| of the set, the |v| that go with it."""


@lru_cache
def _kernels(frequencies: tuple[int, ...]) -> Array:
    """One-dimensional filters (K, 8): for each frequency the windowed cosine, and the sine unless it is zero."""
    offset = np.arange(-HALF_WINDOW + 1, HALF_WINDOW + 1)
    window = np.exp(-(offset**2) / (2 * WINDOW_SIGMA**2))
    rows = []
    for frequency in frequencies:
        phase = 2 * np.pi * (offset + HALF_WINDOW - 1) * frequency / WINDOW
        rows += [window * np.cos(phase)] + ([window * np.sin(phase)] if frequency else [])
    return np.asarray(rows, np.float32)


@lru_cache
def _banded(frequencies: tuple[int, ...], stride: int) -> Array:
    """The filters as a banded matrix (K * block, span): row (k, o) holds filter k shifted by stride * o."""
    kernels, block = _kernels(frequencies), _BLOCK // stride
    matrix = np.zeros((len(kernels), block, stride * (block - 1) + WINDOW), np.float32)
    for o in range(block):
        matrix[:, o, stride * o : stride * o + WINDOW] = kernels
    return np.reshape(matrix, (len(kernels) * block, -1))


def _along_rows(x: Array, frequencies: tuple[int, ...], stride: int) -> Array:
    """Filter (N, M) along its first axis -> (K, blocks, block, M): output o of block b is row b * block + o."""
    matrix, block = _banded(frequencies, stride), _BLOCK // stride
    outputs = (x.shape[0] - WINDOW) // stride + 1
    blocks = -(-outputs // block)
    span = matrix.shape[1]
    missing = (blocks - 1) * block * stride + span - x.shape[0]
    if missing > 0:
        x = np.concatenate([x, np.zeros((missing, x.shape[1]), x.dtype)])
    row, column = x.strides
    windows = as_strided(x, (blocks, span, x.shape[1]), (block * stride * row, row, column), writeable=False)
    out = np.empty((blocks, len(matrix), x.shape[1]), np.float32)
    step = max(_ONE_THREAD // matrix.size, 1)
    for start in range(0, x.shape[1], step):
        part = slice(start, start + step)
        np.matmul(matrix, windows[:, :, part], out=out[:, :, part])
    return out.reshape(blocks, -1, block, x.shape[1]).transpose(1, 0, 2, 3)


def responses(image: Array, stride: int = 1) -> Array:
    """Amplitudes |rho| of the windowed Fourier transform, GD10 eq. 4, for every window inside the image.

    `image` is (H, W) float32; the result (17, h, w) follows FREQUENCIES, with h = (H - 8) // stride + 1 and w alike.
    Element (y, x) belongs to the window whose first pixel is (stride * y, stride * x), that is to the pixel 3 further
    in each direction. Both sides of the image must be at least 8 pixels.
    """
    image = np.ascontiguousarray(image, np.float32)
    height, width = ((n - WINDOW) // stride + 1 for n in image.shape)
    all_u = tuple(range(HALF_WINDOW))
    across = _along_rows(np.ascontiguousarray(image.T), all_u, stride)  # (7, blocks, block, H)
    across = across.reshape(7, -1, image.shape[0])[:, :width].transpose(2, 0, 1)
    across = np.ascontiguousarray(across).reshape(image.shape[0], 7 * width)
    amplitudes: dict[tuple[int, int], Array] = {}
    for u, vs in _PAIRED_WITH.items():
        columns = slice(0, width) if u == 0 else slice((2 * u - 1) * width, (2 * u + 1) * width)
        parts = _along_rows(across[:, columns], vs, stride)
        k = 0
        for v in vs:
            cosine, sine = parts[k], (parts[k + 1] if v else None)
            k += 2 if v else 1
            amplitudes.update(_amplitudes(u, v, cosine, sine, width))
    out = np.empty((len(FREQUENCIES), *next(iter(amplitudes.values())).shape), np.float32)
    for index, (u, v) in enumerate(FREQUENCIES):
        key = (u, v) if u >= 0 else (-u, -v)  # conjugate for a real image: same amplitude
        np.sqrt(amplitudes[key], out=out[index])
    return out.reshape(len(FREQUENCIES), -1, width)[:, :height]


def _amplitudes(u: int, v: int, cosine: Array, sine: Array | None, width: int) -> dict[tuple[int, int], Array]:
    """Squared amplitudes of (u, v) and, where it differs, (u, -v).

    `cosine` and `sine` are the column passes by cos and sin of v, (..., width) for u = 0, else the row pass's cosine
    and sine side by side, (..., 2 * width).
    """
    if sine is None:
        return {(u, v): _square_sum(cosine[..., :width], cosine[..., width:] if u else None)}
    if u == 0:
        return {(u, v): _square_sum(cosine, sine)}
    cc, sc, cs, ss = cosine[..., :width], cosine[..., width:], sine[..., :width], sine[..., width:]
    # exp(-i(x + y)) and exp(-i(x - y)) written out; c and s of x first, of y second.
    return {(u, v): _square_sum(cc - ss, sc + cs), (u, -v): _square_sum(cc + ss, sc - cs)}


def _square_sum(x: Array, y: Array | None) -> Array:
    return x * x if y is None else x * x + y * y
