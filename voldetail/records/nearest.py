"""The closest known word to one that is not known, for refusals."""

from __future__ import annotations

import difflib
from collections.abc import Sequence


def nearest(word: str, known: Sequence[str]) -> str:
    """The clause that ends a refusal of an unknown word: the closest known one, or all of them."""
    close = difflib.get_close_matches(word, known, n=1, cutoff=0.5)
    return f"the nearest one is {close[0]}" if close else "known here: " + ", ".join(known)
