"""Whole files or none: atomic writing, checks before reading, and content hashes."""

import hashlib
import os
import secrets
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from voldetail.errors import InputError


@contextmanager
def atomic(path: Path) -> Iterator[Path]:
    """Yield an empty temporary file beside `path` (same suffix) that replaces `path` when the block succeeds.

    The data reach the disk before the name does, so that a crash leaves the old file or the new one. When the
    block fails, the temporary file is removed and `path` is untouched. Raises InputError where the operating
    system refuses to write (not writable, disk full, `path` is a folder or a device).
    """
    target = Path(os.path.realpath(path))  # write through a symbolic link instead of replacing it
    if target.exists() and not target.is_file():
        kind = "a folder" if target.is_dir() else "not a regular file"
        raise InputError(f"Cannot write {path}: it is {kind}; give the name of a file.")
    temporary = target.with_name(f".voldetail-{secrets.token_hex(6)}{target.suffix}")
    try:
        # os.open and not mkstemp: the file gets the permissions that the user's umask asks for.
        os.close(os.open(temporary, os.O_CREAT | os.O_EXCL | os.O_WRONLY, 0o666))
        yield temporary
        flush(temporary)
        os.replace(temporary, target)
        with suppress(OSError):  # some file systems cannot flush a folder; the file is complete all the same
            flush(target.parent)
    except OSError as error:
        raise InputError(
            f"Cannot write {path}: {error.strerror or error}; give a folder that exists, is writable and has space."
        ) from error
    finally:
        with suppress(OSError):
            temporary.unlink()


def write_text(path: Path, text: str) -> None:
    """Write `text` as UTF-8 to `path`, whole or not at all (see `atomic`)."""
    write_bytes(path, text.encode("utf-8"))


def write_bytes(path: Path, data: bytes) -> None:
    """Write `data` to `path`, whole or not at all (see `atomic`)."""
    with atomic(path) as temporary:
        temporary.write_bytes(data)


def sha256(path: Path) -> str:
    """Return the SHA-256 of a file's content, 64 hexadecimal digits."""
    try:
        with open(path, "rb") as stream:
            return hashlib.file_digest(stream, "sha256").hexdigest()
    except OSError as error:
        raise InputError(f"Cannot read {path}: {error.strerror or error}; check the path.") from error


def readable(path: str | Path, what: str, max_bytes: int) -> Path:
    """Return `path` if it is a regular, non-empty, readable file of at most `max_bytes`; `what` names it in errors.

    Raises InputError otherwise. A device or a pipe is refused: reading it might never end.
    """
    path = Path(path)
    try:
        if not path.exists():
            raise InputError(f"The {what} {path} does not exist; check the path.")
        if path.is_dir():
            raise InputError(f"The {what} {path} is a folder; give a file in it.")
        if not path.is_file():
            raise InputError(f"The {what} {path} is not a regular file; give a file on disk.")
        size = path.stat().st_size
        with open(path, "rb"):
            pass
    except (OSError, ValueError) as error:  # ValueError: a null character in the name
        reason = error.strerror if isinstance(error, OSError) and error.strerror else str(error)
        raise InputError(f"Cannot read the {what} {str(path)!r}: {reason}; check the path.") from error
    if size == 0:
        raise InputError(f"The {what} {path} is empty (0 bytes); save or copy it again.")
    if size > max_bytes:
        raise InputError(
            f"The {what} {path} has {size / 2**20:.0f} MB, more than the {max_bytes / 2**20:.0f} MB that are read; "
            "give a smaller one."
        )
    return path


def flush(path: Path) -> None:
    """Bring a file or a folder to the disk. Raises OSError where that is not possible."""
    descriptor = os.open(path, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)
