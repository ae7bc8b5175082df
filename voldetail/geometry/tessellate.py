"""Refinement of a triangle mesh until its edges are about a pixel long, without cracks."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

MAXIMUM_FACES = 1_500_000
"""Beyond this the edges stay longer than asked: a mesh of this size takes about 2 s and 1 GB to trace."""


def split_long_edges(
    attributes: NDArray[np.float64], faces: NDArray[np.int64], longest: float, limit: int = MAXIMUM_FACES
) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Return (attributes (V', K), faces (F', 3)), every edge at most ``longest`` unless ``limit`` faces is reached.

    The first three columns of ``attributes`` (V, K) are the position; midpoints get the mean of all columns. An edge is
    split for both of its faces at once, so neighbours stay joined and a displacement opens no cracks.
    """
    faces = np.asarray(faces, dtype=np.int64)
    while True:
        edges = np.sort(faces[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
        unique, inverse = np.unique(edges[:, 0] * len(attributes) + edges[:, 1], return_inverse=True)
        ends = np.stack([unique // len(attributes), unique % len(attributes)], axis=1)
        lengths = np.linalg.norm(attributes[ends[:, 0], :3] - attributes[ends[:, 1], :3], axis=1)
        long = lengths > longest
        marked = long[inverse].reshape(-1, 3)
        if not long.any() or len(faces) + int(marked.sum()) > limit:
            return attributes, faces
        middle = np.full(len(unique), -1, dtype=np.int64)
        middle[long] = len(attributes) + np.arange(int(long.sum()))
        attributes = np.concatenate([attributes, 0.5 * (attributes[ends[long, 0]] + attributes[ends[long, 1]])])
        faces = _split(faces, middle[inverse].reshape(-1, 3), marked)


def _split(faces: NDArray[np.int64], middle: NDArray[np.int64], marked: NDArray[np.bool_]) -> NDArray[np.int64]:
    """Return the faces cut at their marked edges; edge e of a face runs from corner e to corner e + 1."""
    count = marked.sum(axis=1)
    out = [faces[count == 0]]
    for edge in range(3):
        a, b, c = (np.roll(faces, -edge, axis=1)[:, i] for i in range(3))
        ab, bc, ca = (np.roll(middle, -edge, axis=1)[:, i] for i in range(3))
        one = (count == 1) & marked[:, edge]
        out += [np.stack(t, axis=1)[one] for t in ((a, ab, c), (ab, b, c))]
        two = (count == 2) & ~marked[:, (edge + 2) % 3]  # the edge from c to a stays whole
        out += [np.stack(t, axis=1)[two] for t in ((a, ab, c), (ab, bc, c), (ab, b, bc))]
        if edge == 0:
            three = count == 3
            out += [np.stack(t, axis=1)[three] for t in ((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca))]
    return np.concatenate(out)
