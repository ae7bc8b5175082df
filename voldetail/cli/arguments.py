"""Words of the command line as values; each refusal is one sentence."""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from pathlib import Path

from voldetail.errors import InputError
from voldetail.files import readable
from voldetail.records.nearest import nearest
from voldetail.records.refusal import shown

MOST_ANGLES = 360  # a picture a degree; more is a slip of the pen


def numbers(text: str, count: int, option: str, names: str) -> list[float]:
    """``count`` finite numbers from "a,b,...": ``names`` says what they are."""
    found = _floats(text.split(","))
    if found is None or len(found) != count:
        raise InputError(f"{option} {shown(text)} is not understood; give {names}, e.g. {_example(names)}.")
    return found


def whole_numbers(text: str, count: int, option: str, names: str) -> list[int]:
    """``count`` whole numbers from "a,b,..."."""
    found = numbers(text, count, option, names)
    if any(v != int(v) for v in found):
        raise InputError(f"{option} {shown(text)} has a fraction; give {names} as whole numbers.")
    return [int(v) for v in found]


ZONE_WORDS = "X,Y,WIDTH,HEIGHT in pixels"


def zone(text: str) -> tuple[int, int, int, int]:
    """The part of a photo in "X,Y,WIDTH,HEIGHT"."""
    x, y, width, height = whole_numbers(text, 4, "--zone", ZONE_WORDS)
    return x, y, width, height


def size(text: str) -> tuple[int, int]:
    """Columns and rows from "640x480"."""
    match = re.fullmatch(r"\s*(\d{1,6})\s*[xX]\s*(\d{1,6})\s*", text)
    if not match:
        raise InputError(f"--size {shown(text)} is not understood; give WIDTHxHEIGHT in pixels, e.g. 640x480.")
    return int(match[1]), int(match[2])


def angles(text: str, option: str, accept: Callable[[float], bool], allowed: str) -> list[float]:
    """Angles in degrees from "30", "0,90,180" or "START:STOP:COUNT".

    The last is COUNT equal steps from START up to, not including, STOP: 0:360:12 is 0, 30, ..., 330.
    """
    forms = "one angle, a list as 0,90,180, or START:STOP:COUNT (COUNT steps, STOP not included) as 0:360:12"
    if ":" in text:
        found = _floats(text.split(":"))
        if found is None or len(found) != 3 or found[2] != int(found[2]) or found[2] < 1:
            raise InputError(f"{option} {shown(text)} is not understood; give {forms}.")
        start, stop, count = found
        if count > MOST_ANGLES:
            raise InputError(f"{option} {shown(text)} has {count:.0f} angles; at most {MOST_ANGLES} are allowed.")
        found = [start + (stop - start) * i / count for i in range(int(count))]
    else:
        listed = _floats(text.split(","))
        if listed is None or len(listed) > MOST_ANGLES:
            raise InputError(f"{option} {shown(text)} is not understood; give {forms}.")
        found = listed
    wrong = next((v for v in found if not accept(v)), None)
    if wrong is not None:
        raise InputError(f"{option} {shown(text)} has {wrong:g} degrees, out of range; allowed: {allowed}.")
    return found


def mesh(text: str, kinds: tuple[str, ...], suffixes: tuple[str, ...], option: str = "MESH") -> str:
    """``text`` if it is a kind of proxy or a mesh file that can be opened."""
    if text in kinds:
        return text
    from voldetail.geometry.mesh_files import MAX_BYTES

    path = Path(text)
    if not path.suffix and not path.exists():
        raise InputError(
            f"{option} {shown(text)} is neither a kind of shape nor a file; {nearest(text, list(kinds))}"
            f" (or give a mesh file: {', '.join(suffixes)})."
        )
    if path.suffix.lower() not in suffixes:
        raise InputError(f"The mesh {text} has the suffix {path.suffix or 'none'}; use one of {', '.join(suffixes)}.")
    return str(readable(path, "mesh", MAX_BYTES))


def _floats(parts: list[str]) -> list[float] | None:
    try:
        found = [float(part) for part in parts]
    except ValueError:
        return None
    return found if all(map(math.isfinite, found)) else None


def _example(names: str) -> str:
    return ",".join(str(64 * i) for i in range(len(names.split(","))))
