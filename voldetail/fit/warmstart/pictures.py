"""Vectors of the relief library: reliefs rendered under one light, brought to one exposure and described."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor

import numpy as np
from numpy.typing import NDArray

from voldetail.backend import mitsuba
from voldetail.fit.warmstart.exposure import exposed
from voldetail.fit.warmstart.reliefs import FINE, SIDE, LibraryRelief
from voldetail.metric import Descriptor, describe
from voldetail.metric.vector import combined_vector
from voldetail.render.build import build
from voldetail.render.unit_components import Components, components
from voldetail.setup.file import setup_from
from voldetail.setup.light import lamp_of

AMBIENT, DIFFUSE = 0.3, 0.6
"""Ka and Kd of the pictures. Only their ratio counts, and the fit solves for both: shadows half filled were ordered more like the
fit's comparison than darker ones (see `exposure`)."""

SHININESS = (16.0,)
"""Of a highlight that is not used: matt pictures."""

SUBSAMPLES = 2
"""Squared samples a pixel, a fit's own number."""


def vectors(reliefs: Iterable[LibraryRelief], elevation: float) -> Iterator[NDArray[np.float16]]:
    """Yield the vector of each relief (L,), lit from the right at ``elevation`` degrees above the plane.

    While one is described, by NumPy in one thread, the next is rendered, by Dr.Jit in all.
    """
    mitsuba()
    reference = _reference()
    setup = setup_from(
        {"photo": {"path": "relief", "resolution": SIDE, "zone": [0, 0, FINE, FINE]}, "light": f"0,{elevation:g}"}, "the library",
    )  # fmt: skip
    surface, lamp = build(setup, (FINE, FINE), (0, 0, FINE, FINE)), lamp_of(setup.light)
    with ThreadPoolExecutor(1) as worker:
        waiting: Future[NDArray[np.float16]] | None = None
        for relief in reliefs:
            surface.update(relief.detail())
            parts = components(surface, lamp, subsamples=SUBSAMPLES, shininess=SHININESS)
            if waiting is not None:
                yield waiting.result()
            waiting = worker.submit(_described, parts, reference)
        if waiting is not None:
            yield waiting.result()


def _described(parts: Components, reference: Descriptor) -> NDArray[np.float16]:
    picture = exposed(parts.luminance(AMBIENT, DIFFUSE, 0.0, SHININESS[0]))
    return combined_vector(describe(picture, like=reference)).astype(np.float16)


def _reference() -> Descriptor:
    """Any descriptor: what is measured does not hang on it."""
    return describe(np.random.default_rng(0).random((SIDE, SIDE)).astype(np.float32))
