"""Whether a photo is new to a library, which has nothing like it.

D has no unit that says so: how near the nearest entry of a picture is that a model could have made depends on how many parameters
the model has and on how many entries. So pictures of the answer's model are made of which none is in the library, with numbers
and noise of their own, and looked for in the same way; a photo whose nearest entry is farther than all of theirs is not of that
kind.
"""

from __future__ import annotations

from dataclasses import dataclass

from voldetail.library.answers import Answer
from voldetail.library.compare import nearest
from voldetail.library.entries import SIDE, random_values
from voldetail.library.groups import Group
from voldetail.library.span import span_of, spanned
from voldetail.library.vectors import vector_of
from voldetail.texture.structures import MODELS, structure

PICTURES = 16
"""Made for it: about one picture of the model in 17 is then taken for a stranger."""

OWN_SEED = 0x6B6E6F77
"""Of their numbers and noise; not a seed that libraries are built with."""


@dataclass(frozen=True)
class Novelty:
    """How far an answer is beside pictures of its model: its distance D, and the largest of theirs."""

    model: str
    distance: float
    farthest: float

    @property
    def novel(self) -> bool:
        """Whether no other picture of the model is as far."""
        return self.distance > self.farthest

    @property
    def sentence(self) -> str:
        """Empty, or one sentence that nothing in the library is like the photo."""
        if not self.novel:
            return ""
        return (
            f"The library has nothing quite like this photo: the nearest answer, {self.model}, is {self.distance:.3f} away, and "
            f"{PICTURES} other pictures of that model are at most {self.farthest:.3f} from their nearest."
        )


def novelty_of(group: Group, answer: Answer, *, rotations: bool = True, swap: bool = True, side: int = SIDE) -> Novelty | None:
    """Return how far ``answer`` is beside ``PICTURES`` random pictures, of ``side`` pixels, of its model.

    None for entries that are of no structure model. About a second.
    """
    model = MODELS.get(answer.model)
    if model is None:
        return None
    distances = []
    for k in range(PICTURES):
        s = structure(model, random_values(model, k, OWN_SEED), side, seed=OWN_SEED)
        vector = vector_of(spanned(s, span_of(s)))
        distances.append(nearest(group.table, vector, 1, rotations=rotations, swap=swap)[0].distance)
    return Novelty(answer.model, answer.distance, max(distances))
