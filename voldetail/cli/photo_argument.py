"""A photo named on the command line."""

from __future__ import annotations

from pathlib import Path

from voldetail.errors import InputError


def photo_path(name: str) -> Path:
    """The file of a picture; `skimage:gravel` and the like are photographs that scikit-image ships."""
    from voldetail.setup.setup import SKIMAGE_PHOTOS, SKIMAGE_PREFIX

    if not name.startswith(SKIMAGE_PREFIX):
        return Path(name)
    from importlib.util import find_spec

    from voldetail.records.nearest import nearest

    word = name.removeprefix(SKIMAGE_PREFIX)
    found = find_spec("skimage")
    if word not in SKIMAGE_PHOTOS or found is None or found.origin is None:
        raise InputError(f"There is no photo {name[:60]!r}; {nearest(word, list(SKIMAGE_PHOTOS))}.")
    return Path(found.origin).parent / "data" / f"{word}.png"
