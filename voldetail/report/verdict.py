"""How good a fit is, in words: its distance held against distances that mean nothing."""

from __future__ import annotations

import math
from dataclasses import dataclass

from voldetail.detail import NoiseFloor

# Judgements, not measurements: multiples of the yardstick up to which a fit is called by each word.
AS_ALIKE = 1.0
CLOSE = 2.0
ALIKE = 4.0

UNEVEN = 3.0
"""A photo whose halves differ this many times more than two seeds is no yardstick: any fit would pass."""


@dataclass(frozen=True)
class Verdict:
    """`word` for a heading, `sentence` with the numbers, `ratio` to the yardstick (None: unknown)."""

    word: str
    sentence: str
    ratio: float | None


def verdict(distance: float, floor: NoiseFloor) -> Verdict:
    """Judge M between photo and fit by M between the photo's halves or, where unknown, between two seeds.

    Two halves of one photo, or two renderings of one detail with other random numbers, are the same texture
    to anyone: a fit cannot be asked to be nearer than they are to each other.
    """
    if not math.isfinite(distance):
        return Verdict("no match", "The fit could not be compared with the photo.", None)
    parts = [
        text
        for value, text in (
            (floor.photo_halves, "the photo's two halves differ by {}"),
            (floor.other_seed, "two seeds of this detail by {}"),
        )
        if value is not None and value > 0
        for text in [text.format(number(value))]
    ]
    uneven = bool(floor.photo_halves and floor.other_seed and floor.photo_halves > UNEVEN * floor.other_seed)
    by_halves = bool(floor.photo_halves) and not uneven
    yardstick = floor.photo_halves if by_halves else floor.other_seed
    if not yardstick:
        return Verdict("not judged", f"M = {number(distance)}; there is nothing to hold it against.", None)
    ratio = distance / yardstick
    against = "the photo's halves" if by_halves else "two seeds of the detail"
    word = _word(ratio)
    meaning = {
        "as alike": f"as near to the photo as {against} are to each other",
        "close": f"close to the photo, {ratio:.1f} times as far as {against} from each other",
        "alike": f"like the photo but visibly different, {ratio:.1f} times as far as {against} from each other",
        "no match": f"not a match, {ratio:.3g} times as far as {against} from each other;"
        " check the light, the zone and the proxy, or let it search longer",
    }[word]
    caution = " The photo's halves are too unlike to judge by: it is uneven, or small." if uneven else ""
    return Verdict(word, f"M = {number(distance)} ({', '.join(parts)}): {meaning}.{caution}", ratio)


def number(value: float) -> str:
    """A distance with three digits."""
    return f"{value:.3g}" if value < 1000 else f"{value:.0f}"


def _word(ratio: float) -> str:
    for limit, word in ((AS_ALIKE, "as alike"), (CLOSE, "close"), (ALIKE, "alike")):
        if ratio <= limit:
            return word
    return "no match"
