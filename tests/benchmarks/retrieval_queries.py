"""Pictures of known parameters to look for in a library: as they are, and disturbed in ways that photographs are."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from io import BytesIO

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from voldetail.image import to_linear, to_srgb
from voldetail.library import random_values, recolour, two_tone, vector_of
from voldetail.library.entries import SIDE
from voldetail.library.span import TRIM, span_of, spanned
from voldetail.texture.structures import MODELS, StructureModel, structure

Array = NDArray[np.float32]
Change = Callable[[Array, np.random.Generator], Array]

QUERY_SEED = 1
"""Of parameters and of noise; the library has 0."""

NOISE = 0.05
JPEG_QUALITY = 50
CATEGORIES = {"kind", "phase", "arrangement"}
"""Parameters whose numbers are names: another one is as far as the whole range."""

LEAST_CONTRAST = 0.3
"""Luminance by which the two random tones of a coloured query differ, at least."""


@dataclass(frozen=True, eq=False)
class Queries:
    """One model's pictures under one disturbance: their shares of the ranges (N, parameters), and vectors (N, 750)."""

    shares: NDArray[np.float64]
    vectors: Array


def _noisy(s: Array, rng: np.random.Generator) -> Array:
    return np.asarray(np.clip(s + NOISE * rng.standard_normal(s.shape), 0.0, 1.0), np.float32)


def _compressed(s: Array, rng: np.random.Generator) -> Array:
    buffer = BytesIO()
    Image.fromarray(np.rint(255 * s).astype(np.uint8)).save(buffer, format="JPEG", quality=JPEG_QUALITY)
    return np.divide(np.asarray(Image.open(buffer)), 255, dtype=np.float32)


def _coloured(s: Array, rng: np.random.Generator) -> Array:
    """In two random tones and eight bits, read back as a photo is: its extremes become 0 and 1."""
    while True:
        tones = rng.random((2, 3))
        light = tones @ (0.2126, 0.7152, 0.0722)
        if abs(light[1] - light[0]) >= LEAST_CONTRAST:
            break
    dark, bright = tones[np.argsort(light)]
    stored = np.rint(255 * to_srgb(recolour(s, dark, bright))) / 255
    return two_tone(to_linear(stored), trim=TRIM).structure


CHANGES: dict[str, Change | None] = {
    "plain": lambda s, rng: s,
    "turned by a step": None,
    "turned": None,
    "swapped": lambda s, rng: 1 - s,
    "noise": _noisy,
    "jpeg": _compressed,
    "two tones": _coloured,
}
"""Disturbances; the turned ones are evaluated turned."""


def picture(model: StructureModel, k: int, change: str) -> Array:
    """Return query ``k`` of a model, disturbed."""
    rng = np.random.default_rng([QUERY_SEED, k])
    values = random_values(model, k, QUERY_SEED)
    made = CHANGES[change]
    if made is None:
        turn = rng.integers(1, 16) * np.pi / 16 if change == "turned by a step" else rng.random() * np.pi
        return structure(model, values, SIDE, rotation=float(turn), seed=QUERY_SEED)
    return made(structure(model, values, SIDE, seed=QUERY_SEED), rng)


def queries(name: str, change: str, count: int) -> Queries:
    """Return the first ``count`` queries of a model under one disturbance."""
    model = MODELS[name]
    values = [random_values(model, k, QUERY_SEED) for k in range(count)]
    pictures = (picture(model, k, change) for k in range(count))
    # On a photo's scale, as all that is looked for.
    vectors = np.stack([vector_of(spanned(s, span_of(s))) for s in pictures])
    return Queries(shares(model, np.array([list(v.values()) for v in values])), vectors)


def shares(model: StructureModel, values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return values (N, parameters) as shares of their ranges, lengths by ratios: what random entries are even in."""
    columns = []
    for p, column in zip(model.parameters, values.T, strict=True):
        if p.spread == "log":
            columns.append(np.log(column / p.lower) / np.log(p.upper / p.lower))
        else:
            columns.append((column - p.lower) / (p.upper - p.lower))
    return np.stack(columns, axis=1)


def gaps(model: StructureModel, stored: NDArray[np.float64], wanted: NDArray[np.float64]) -> NDArray[np.float64]:
    """|difference| of shares (entries, parameters); of categories 0 or 1."""
    found = np.abs(stored - wanted)
    for column, parameter in enumerate(model.parameters):
        if parameter.key in CATEGORIES:
            found[:, column] = found[:, column] > 0
    return found
