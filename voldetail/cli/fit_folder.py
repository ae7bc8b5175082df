"""The folder of one fit: what is in it, whether it may be used, and each file written whole or not at all."""

from __future__ import annotations

import time
from pathlib import Path
from typing import TYPE_CHECKING, Any

from numpy.typing import NDArray

from voldetail.cli.outputs import check_folder, make_folder, remove
from voldetail.detail import save_detail
from voldetail.detail.relief_maps import RELIEF_FILES
from voldetail.errors import InputError
from voldetail.files import write_text
from voldetail.setup.file import setup_to_toml
from voldetail.setup.setup import Setup

if TYPE_CHECKING:
    from voldetail.fit.session import Progress, State
    from voldetail.results import FitResult

DETAIL, SETUP, STATE, PREVIEW, FIT = "detail.json", "setup.toml", "state.json", "preview.png", "fit.png"
RELIEF = "relief"
"""The folder of the photo's own relief."""

RESULTS = (DETAIL, FIT, "report.html", "sheet.png")
PREVIEW_SECONDS = 2.0  # between two previews: writing one takes some 10 ms


class FitFolder:
    """Files of a fit in ``path``; nothing is made before `begin`, so bad input leaves nothing behind."""

    def __init__(self, path: Path, setup: Setup) -> None:
        self.path = path
        self.setup = setup.model_copy(update={"output": path.absolute()})
        self.begun = False
        self.shown: NDArray[Any] | None = None
        self.shown_at = -PREVIEW_SECONDS

    def check(self, *, force: bool, resume: bool) -> None:
        """Raise InputError unless the folder may be written and holds no results that may not be replaced."""
        check_folder(self.path)
        if resume and not self.path.is_dir():
            raise InputError(f"There is nothing to go on with: {self.path} does not exist; leave --resume out.")
        held = [name for name in (*RESULTS, STATE) if (self.path / name).exists()]
        if held and not force and not (resume and STATE in held):
            raise InputError(
                f"{self.path} holds {held[0]} of a fit already: go on with it with --resume, replace it with"
                " --force, or give another folder with -o."
            )

    def resumed(self, photo_sha256: str) -> State | None:
        """The state to go on from, or None where the fit was stopped before there was one."""
        from voldetail.fit.state_file import load_state

        path = self.path / STATE
        return load_state(path, self.setup, photo_sha256) if path.exists() else None

    def begin(self, keep: bool) -> None:
        """Make the folder, clear it of an earlier fit unless ``keep``, and write the setup."""
        if self.begun:
            return
        self.begun = True
        make_folder(self.path)
        # Results of another fit beside the new setup would be taken for its own.
        stale = [] if keep else [self.path / name for name in (*RESULTS, STATE, PREVIEW)]
        stale += [] if keep else [self.path / RELIEF / name for name in RELIEF_FILES]
        remove(stale + sorted(self.path.rglob(".voldetail-*")))  # the last: what a killed process was writing
        write_text(self.path / SETUP, setup_to_toml(self.setup))

    def save_state(self, state: State, photo_sha256: str) -> None:
        """Replace the state."""
        from voldetail.fit.state_file import save_state

        save_state(self.path / STATE, state, self.setup, photo_sha256)

    def preview(self, progress: Progress) -> None:
        """Replace the preview if there is a better picture and the last one has been there a little."""
        from voldetail.image import save_png

        now = time.monotonic()
        if progress.picture is None or progress.picture is self.shown or now - self.shown_at < PREVIEW_SECONDS:
            return
        self.shown, self.shown_at = progress.picture, now
        save_png(self.path / PREVIEW, progress.picture)

    def finish(self, result: FitResult) -> None:
        """Write the detail and its picture, in the photo's colour, and take the preview away."""
        from voldetail.image import save_png

        save_detail(self.path / DETAIL, result.detail)
        save_png(self.path / FIT, result.coloured)
        remove([self.path / PREVIEW])
