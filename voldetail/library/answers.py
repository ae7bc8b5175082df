"""The procedural textures nearest to a photo, within each model and over all models (GKHF14 section 5), and their pictures."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from voldetail.detail import StructureTexture
from voldetail.errors import InputError
from voldetail.library.compare import nearest
from voldetail.library.entries import SIDE
from voldetail.library.groups import Group, Groups
from voldetail.library.index import Index, nearest_by_index
from voldetail.library.span import Span, span_of, spanned
from voldetail.library.two_tone import recolour
from voldetail.texture.structures import MODELS, structure
from voldetail.types import Array

Tone = tuple[float, float, float]

BLACK: Tone = (0.0, 0.0, 0.0)
WHITE: Tone = (1.0, 1.0, 1.0)


@dataclass(frozen=True)
class Answer:
    """An entry that is near a photo.

    model, entry, seed, parameters: what makes the entry's structure map. rotation: radians by which it has to be turned,
    counter-clockwise, 0 to pi. swapped: whether the roles of the tones are exchanged. distance: D (equation 6). zero, one: the
    tones, sRGB-encoded, where the map is 0 and 1, exchanged already where ``swapped``.
    """

    model: str
    entry: int
    seed: int
    parameters: Mapping[str, float]
    rotation: float
    swapped: bool
    distance: float
    zero: Tone = BLACK
    one: Tone = WHITE


@dataclass(frozen=True)
class Ranking:
    """Answers over all models, nearest first, and those of each model."""

    answers: tuple[Answer, ...]
    by_model: Mapping[str, tuple[Answer, ...]]


def rank(
    groups: Groups,
    vector: ArrayLike,
    top: int = 8,
    *,
    tones: tuple[ArrayLike, ArrayLike] | None = None,
    rotations: bool = True,
    swap: bool = True,
    indexes: Mapping[str, Index] | None = None,
) -> Ranking:
    """Return the ``top`` entries nearest to the descriptor ``vector`` (750,) in each of ``groups`` and in all of them.

    Models are compared by D itself. tones: of the photo, the darker first, sRGB-encoded; by default black and white.
    rotations, swap: False compares structures as they lie, and tones in their order. indexes: of some groups, see `index`, which
    are then not compared whole; an entry or two may be missed. Entries of equal distance are in the order of the groups.
    Raises InputError for no group and what `compare.nearest` refuses.
    """
    if not groups:
        raise InputError("There is no model to look in; name one, or build a library with one.")
    dark, bright = (BLACK, WHITE) if tones is None else (_tone(tones[0]), _tone(tones[1]))
    found = {
        name: _answers(group, vector, top, (dark, bright), rotations, swap, (indexes or {}).get(name))
        for name, group in groups.items()
    }
    every = sorted((a for answers in found.values() for a in answers), key=lambda answer: answer.distance)
    return Ranking(tuple(every[:top]), found)


def picture(answer: Answer, size: int | tuple[int, int] = SIDE) -> Array:
    """Return the picture (H, W, 3), linear, of an answer in its tones, turned and swapped as found; row 0 on top.

    size: pixels a side, or (rows, columns). It shows the entry's own noise, so the library's pixels are a crop of it.
    Raises InputError for an answer that is no structure model's.
    """
    return recolour(structure_map(answer, size), answer.zero, answer.one)


def structure_map(answer: Answer, size: int | tuple[int, int] = SIDE) -> Array:
    """Return the structure map s (H, W) of an answer on the scale of 0 to 1 that it was compared on (see `span`), turned as
    found; its tones are not swapped. See `picture`."""
    span = entry_span(answer)
    return spanned(structure(MODELS[answer.model], answer.parameters, size, rotation=answer.rotation, seed=answer.seed), span)


def entry_span(answer: Answer) -> Span:
    """Return the span of the entry's picture in the library, of 256 pixels. Raises InputError for no structure model's."""
    if answer.model not in MODELS:
        raise InputError(f"{answer.model!r} is no structure model and has no picture.")
    return span_of(structure(MODELS[answer.model], answer.parameters, SIDE, seed=answer.seed))


def texture_of(answer: Answer, size: tuple[int, int] = (SIDE, SIDE), photo: str = "") -> StructureTexture:
    """Return an answer as a colour texture, for any surface: model, parameters, seed, turn and tones.

    size: rows and columns of the photo as it was compared, so that a texel is a pixel of it; photo: its file's name. Raises
    InputError for an answer that is no structure model's.
    """
    span = entry_span(answer)
    return StructureTexture(
        name=answer.model, model=answer.model, parameters=dict(answer.parameters), seed=answer.seed, rotation=answer.rotation,
        span=span, zero=answer.zero, one=answer.one, texels=(size[1], size[0]), photo=photo[:400],
    )  # fmt: skip


def _answers(
    group: Group, vector: ArrayLike, top: int, tones: tuple[Tone, Tone], rotations: bool, swap: bool, index: Index | None
) -> tuple[Answer, ...]:
    (dark, bright), count = tones, min(top, len(group.values))
    asked_for = max(count, min(top, 1))
    if index is None:
        matches = nearest(group.table, vector, asked_for, rotations=rotations, swap=swap)
    else:
        matches = nearest_by_index(group, index, vector, asked_for, rotations=rotations, swap=swap)
    return tuple(
        Answer(
            group.model, match.entry, group.seed, group.parameters(match.entry), match.rotation, match.swapped, match.distance,
            *((bright, dark) if match.swapped else (dark, bright)),
        )
        for match in matches
    )  # fmt: skip


def _tone(tone: ArrayLike) -> Tone:
    red, green, blue = (float(v) for v in np.asarray(tone, np.float64))
    return red, green, blue
