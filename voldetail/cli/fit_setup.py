"""What `voldetail fit` was given, as a Setup."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

from voldetail.cli.arguments import numbers, zone
from voldetail.errors import InputError
from voldetail.records.nearest import nearest
from voldetail.records.refusal import printable, shown
from voldetail.setup.file import Given, load_setup, setup_from_text
from voldetail.setup.light import FORMS
from voldetail.setup.setup import Setup
from voldetail.setup.shapes import SIMPLE_KINDS, named_shape

OUTPUT_ROOT = Path("voldetail-out")


def read_setup(photo: str, given: Sequence[Given], overrides: Sequence[str]) -> Setup:
    """Return the Setup of a photo or a TOML scene, changed by what was ``given``, then by -D overrides.

    Raises InputError that names the option that is wrong.
    """
    scene = photo.lower().endswith(".toml")
    if scene:
        return load_setup(photo, overrides, given)
    keys = {one.key for one in given}
    if ("light",) not in keys and not any(d.strip().startswith("light") for d in overrides):
        raise InputError(f"The light of the photo is missing: give --light as {FORMS}.")
    return setup_from_text("", overrides, given=[Given(("photo", "path"), photo, "PHOTO"), *given])


def implied(given: Sequence[Given]) -> list[Given]:
    """Return what is ``given`` with what it implies: an angle of view a perspective camera, a medium a volume."""
    keys = {one.key for one in given}
    more = []
    for one in given:
        if one.key == ("camera", "field_of_view") and ("camera", "kind") not in keys:
            more.append(Given(("camera", "kind"), "perspective", one.source))  # an orthographic camera has no angle
        if one.key == ("look",) and one.value == "medium" and ("mode",) not in keys:
            more.append(Given(("mode",), "volume", one.source))  # nothing else has a medium
    return [*given, *more]


def output_folder(setup: Setup) -> Path:
    """The folder for the results: the setup's own, or one under `voldetail-out` named by the photo."""
    return setup.output or OUTPUT_ROOT / (setup.photo.skimage or Path(setup.photo.path).stem)


def zone_of(text: str) -> Mapping[str, object]:
    """The zone in "X,Y,WIDTH,HEIGHT"."""
    return {"photo.zone": zone(text)}


def rotation_of(text: str) -> Mapping[str, object]:
    """The turns in "X,Y,Z"."""
    return {"proxy.rotation": numbers(text, 3, "--rotation", "X,Y,Z in degrees")}


def proxy_of(text: str) -> Mapping[str, object]:
    """The kind of shape, or the mesh file, that a word names."""
    named = named_shape(printable(text))
    if named is None:
        from voldetail.geometry.mesh_files import SUFFIXES

        raise InputError(
            f"--proxy {shown(text)} is not known; {nearest(text, list(SIMPLE_KINDS))} (or give a mesh file: "
            f"{', '.join(SUFFIXES)})."
        )
    return {f"proxy.{key}": value for key, value in named.items()}  # a scene may have named a mesh
