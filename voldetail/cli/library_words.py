"""What the commands of libraries have in common."""

from __future__ import annotations

from pathlib import Path

from voldetail.cli.console import remarks


def size_on_disk(count: float) -> str:
    """Return bytes in words, to three digits."""
    for unit in ("bytes", "kB", "MB"):
        if count < 1000:
            return f"{count:.3g} {unit}"
        count /= 1000
    return f"{count:.3g} GB"


def make_index(path: Path) -> tuple[Path, str]:
    """Make the index of the library at ``path``; return its file and a line about it."""
    from voldetail.cli.progress import ProgressView
    from voldetail.library.index import write_index
    from voldetail.library.store import open_library

    library = open_library(path)
    with ProgressView(remarks()) as view:
        view.step("making the index")
        total = library.header.entries
        made = write_index(library, lambda done: view.step(f"making the index: {done} of {total} entries"))
    return made, f"{made}  {size_on_disk(made.stat().st_size)}"
