"""The photo's own relief, which a fit makes first and keeps in its folder."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from voldetail.cli.console import explain
from voldetail.cli.fit_folder import RELIEF, FitFolder
from voldetail.cli.outputs import make_folder
from voldetail.errors import InputError

if TYPE_CHECKING:
    from voldetail.image import Photo

SIZE = 512
"""Pixels of its longest side: a second or two. `voldetail relief` makes more."""


def keep_relief(place: FitFolder, photo: Photo, on_step: Callable[[str], None]) -> None:
    """Recover the relief of a fit's ``photo`` into the fit's folder; where there is none to recover, nothing but that is said."""
    from voldetail.image import with_mask
    from voldetail.recover.files import save_relief
    from voldetail.recover.recovery import recover
    from voldetail.render.build import faces_camera

    setup = place.setup
    if setup.medium or not faces_camera(setup):
        explain("The photo's own relief is recovered from a plane that faces the camera alone.")
        return
    on_step("recovering the photo's own relief")
    try:
        found = recover(
            with_mask(photo, setup.mask), setup.light, zone=setup.photo.zone, size=SIZE,
            name=setup.photo.skimage or setup.photo.name, seed=setup.seed,
        )  # fmt: skip
    except InputError as error:
        explain(f"The photo's own relief was left out: {error}")
        return
    place.begin(keep=False)
    make_folder(place.path / RELIEF)
    save_relief(place.path / RELIEF, found.detail)
