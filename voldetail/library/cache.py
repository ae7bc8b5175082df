"""Where libraries live that are built on first use: one for each definition, so that a stale one is never picked up."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from pathlib import Path

from voldetail.errors import InputError
from voldetail.library.building.build import BuildProgress, build
from voldetail.library.building.plan import Plan
from voldetail.library.building.source import Source
from voldetail.library.store import Library, is_library, open_library
from voldetail.library.vectors import digest

VARIABLE = "VOLDETAIL_CACHE"
"""The environment variable that names another folder than the user's for caches."""

DIGITS = 16
"""Of a definition's hash in a library's name."""


def cache_folder() -> Path:
    """Return the folder for what can be made again: VOLDETAIL_CACHE, or the system's place for a user's caches."""
    named = os.environ.get(VARIABLE)
    if named:
        return Path(named)
    import platformdirs

    return platformdirs.user_cache_path("voldetail", appauthor=False)


def cached_path(sources: Sequence[Source], counts: int | Sequence[int], name: str = "library") -> Path:
    """Return where the library of so many entries of each source is kept, whether it is there or not.

    Its name has the hash of all that decides it: sources, counts, descriptor, weights and format. Raises InputError where the
    plan is not possible.
    """
    each = (counts,) * len(sources) if isinstance(counts, int) else tuple(counts)
    return cache_folder() / f"{name}-{digest(Plan(tuple(sources), each).definition)[:DIGITS]}.vlib"


def cached(
    sources: Sequence[Source],
    counts: int | Sequence[int],
    name: str = "library",
    *,
    workers: int | None = None,
    on_progress: Callable[[BuildProgress], None] = lambda progress: None,
) -> Library:
    """Return the library of so many entries of each source, built where the cache does not have it whole.

    Raises InputError where the cache cannot be written and for what `build` refuses.
    """
    path = cached_path(sources, counts, name)
    if is_library(path):
        try:
            return open_library(path)
        except InputError:
            pass  # damaged: built again
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(
            f"Cannot make the folder {path.parent} for libraries: {error.strerror}; name another in {VARIABLE}."
        ) from error
    return open_library(build(sources, counts, path, workers=workers, force=is_library(path), on_progress=on_progress))
