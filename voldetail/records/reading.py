"""Reading a small text file that a user names."""

from pathlib import Path

from voldetail.errors import InputError
from voldetail.files import readable

LARGEST_FILE = 2**20  # bytes; a detail has about two thousand, so more is another kind of file


def read_small_text(path: Path | str, what: str) -> str:
    """The UTF-8 text of the file at `path`, called `what` ("detail file") in errors.

    Raises InputError if it is missing, not a plain file, empty, unreadable, over LARGEST_FILE or not UTF-8.
    """
    found = readable(path, what, LARGEST_FILE)
    try:
        with found.open("rb") as stream:
            data = stream.read(LARGEST_FILE + 1)  # the file may have grown since
    except OSError as error:
        reason = error.strerror or error
        raise InputError(f"Cannot read the {what} {path}: {reason}; check the path.") from error
    if len(data) > LARGEST_FILE:
        raise InputError(f"The {what} {path} is over {LARGEST_FILE // 2**20} MB, the most that is read.")
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        at = f"byte {error.start}"
        raise InputError(f"The {what} {path} is not UTF-8 text ({at}); is it another kind of file?") from None
