"""Where results go: checked before any long work, so that nothing is computed in vain."""

from __future__ import annotations

import os
import shutil
from pathlib import Path

from voldetail.errors import InputError

LEAST_FREE = 2**25  # bytes; a report with its pictures takes about 5 MB


def check_file(path: Path) -> None:
    """Raise InputError unless the file ``path`` can be written."""
    if path.is_dir():
        raise InputError(f"Cannot write {path}: it is a folder; give the name of a file.")
    if path.exists() and not os.access(path, os.W_OK):
        raise InputError(f"Cannot write {path}: permission denied; give another name.")
    if not path.parent.is_dir():
        raise InputError(f"Cannot write {path}: there is no folder {path.parent}; make it or give another.")
    _check_place(path.parent, path)


def check_folder(path: Path) -> None:
    """Raise InputError unless the folder ``path`` can be written to, or be made; makes nothing."""
    place = path
    while not place.exists() and place != place.parent:
        if place.is_symlink():
            raise InputError(f"Cannot use {path}: {place} is a link to nothing; give another folder.")
        place = place.parent
    if not place.is_dir():
        raise InputError(f"Cannot use the folder {path}: {place} is a file; give another folder with -o.")
    _check_place(place, path)


def make_folder(path: Path) -> None:
    """Make the folder ``path`` with those above it."""
    try:
        path.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(f"Cannot make the folder {path}: {error.strerror or error}; give another with -o.") from error


def remove(paths: list[Path]) -> None:
    """Remove the files that are there."""
    for path in paths:
        try:
            path.unlink(missing_ok=True)
        except OSError as error:
            raise InputError(f"Cannot replace {path}: {error.strerror or error}; give another folder.") from error


def _check_place(place: Path, wanted: Path) -> None:
    if not os.access(place, os.W_OK | os.X_OK):
        raise InputError(f"Cannot write {wanted}: the folder {place} is not writable; give another.")
    try:
        usage = shutil.disk_usage(place)
    except OSError:
        return
    # Some network file systems do not tell, and say 0 of 0.
    if usage.total > 0 and usage.free < LEAST_FREE:
        raise InputError(f"Cannot write {wanted}: {usage.free / 2**20:.0f} MB are free there; free some space.")
