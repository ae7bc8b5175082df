"""The options of `voldetail fit` as a Setup."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from voldetail.cli.arguments import numbers, whole_numbers
from voldetail.errors import InputError
from voldetail.geometry.mesh_files import SUFFIXES
from voldetail.records.nearest import nearest
from voldetail.records.refusal import printable, shown
from voldetail.setup.file import load_setup, setup_from_text
from voldetail.setup.light import FORMS
from voldetail.setup.setup import Setup
from voldetail.setup.shapes import SIMPLE_KINDS

OUTPUT_ROOT = Path("voldetail-out")

# What an option sets; its value is put there unless the table below says how.
KEYS = {
    "--light": "light", "--mask": "mask", "--amplitude": "amplitude", "--resolution": "photo.resolution",
    "--solver": "fit.solver", "--metric": "fit.metric", "--seed": "seed", "--evaluations": "fit.evaluations",
    "--library": "fit.library", "--time-limit": "fit.time_limit", "--domain": "domain", "--camera": "camera.kind",
    "--fov": "camera.field_of_view", "--specular": "fit.specular", "--output": "output",
    "--mode": "mode", "--look": "look", "--colour": "colour", "--stationarize": "photo.stationarize",
}  # fmt: skip


def read_setup(photo: str, options: Mapping[str, Any], overrides: Sequence[str]) -> Setup:
    """Return the Setup of a photo or a TOML scene, with ``options`` (None: not given) and -D overrides.

    Overrides come last. Raises InputError that names the option that is wrong.
    """
    scene = photo.lower().endswith(".toml")
    named = [] if scene else [("PHOTO", f"photo.path={json.dumps(photo, ensure_ascii=False)}")]
    for option, value in options.items():
        if value is not None:
            named += [
                (f"{option} {printable(str(value))}", text) for text in _overrides(option, value, options)
            ]
    if (
        not scene
        and options.get("--light") is None
        and not any(d.strip().startswith("light") for d in overrides)
    ):
        raise InputError(f"The light of the photo is missing: give --light as {FORMS}.")
    every = [text for _, text in named] + list(overrides)
    where = printable(photo) if scene else "The setup"
    try:
        return load_setup(photo, every) if scene else setup_from_text("", every, where=where)
    except InputError as error:
        # The user typed --resolution 5 and not -D photo.resolution=5.
        sentence = str(error)
        for option, text in named:
            sentence = sentence.replace(f"{where} with -D {shown(text)}", option)
        raise InputError(sentence) from None


def output_folder(setup: Setup) -> Path:
    """The folder for the results: the setup's own, or one under `voldetail-out` named by the photo."""
    return setup.output or OUTPUT_ROOT / (setup.photo.skimage or Path(setup.photo.path).stem)


def _overrides(option: str, value: Any, options: Mapping[str, Any]) -> list[str]:
    if option == "--zone":
        zone = whole_numbers(value, 4, option, "X,Y,WIDTH,HEIGHT in pixels")
        return [f"photo.zone={zone}"]
    if option == "--proxy":
        return _proxy(value)
    if option == "--rotation":
        return [f"proxy.rotation={numbers(value, 3, option, 'X,Y,Z in degrees')}"]
    if option == "--look" and value == "medium" and options.get("--mode") is None:
        return ['look="medium"', 'mode="volume"']  # nothing else has a medium
    made = [f"{KEYS[option]}={json.dumps(value, ensure_ascii=False)}"]
    if option == "--fov" and options.get("--camera") is None:
        made.append('camera.kind="perspective"')  # an orthographic camera has no angle
    return made


def _proxy(value: str) -> list[str]:
    if value in SIMPLE_KINDS:
        return [f'proxy.kind="{value}"', "proxy.mesh="]  # a scene may have named a mesh
    if not Path(value).suffix:
        raise InputError(
            f"--proxy {shown(value)} is not known; {nearest(value, list(SIMPLE_KINDS))} (or give a mesh file: "
            f"{', '.join(SUFFIXES)})."
        )
    return ['proxy.kind="mesh"', f"proxy.mesh={json.dumps(value, ensure_ascii=False)}"]
