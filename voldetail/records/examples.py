"""Photographs of real surfaces that scikit-image ships, by name."""

from __future__ import annotations

from importlib.util import find_spec
from pathlib import Path

from voldetail.errors import InputError
from voldetail.records.nearest import nearest

PREFIX = "skimage:"
NAMES = ("gravel", "grass", "brick")


def example_name(text: str) -> str | None:
    """The name in "skimage:NAME", None where ``text`` does not begin so. Raises InputError for a name that is not known."""
    if not text.startswith(PREFIX):
        return None
    name = text.removeprefix(PREFIX)
    if name not in NAMES:
        raise InputError(f"There is no photo {text[:60]!r}; {nearest(name, list(NAMES))}.")
    return name


def picture_path(name: str | Path) -> Path:
    """The file of a picture: ``name`` itself, or the photograph that "skimage:gravel" and the like name.

    Raises InputError for another name after "skimage:", and where scikit-image is not installed.
    """
    found = example_name(str(name))
    if found is None:
        return Path(name)
    package = find_spec("skimage")
    if package is None or package.origin is None:
        raise InputError(f"The photo {name} belongs to scikit-image, which is not installed: install it, or give a file.")
    return Path(package.origin).parent / "data" / f"{found}.png"
