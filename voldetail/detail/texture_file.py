"""The texture file: a colour texture, by example or of a structure model, as versioned JSON that people can read and edit.

Both kinds have one format; a structure is known by its key `model`.
"""

from __future__ import annotations

import json
from pathlib import Path

from pydantic import ValidationError

from voldetail.detail.colour import COLOUR_VERSION, ColourTexture
from voldetail.detail.structure_texture import StructureTexture, Texture
from voldetail.errors import InputError
from voldetail.files import write_text
from voldetail.records.json_text import Migration, json_text, migrated, of_format, parsed
from voldetail.records.reading import read_small_text
from voldetail.records.refusal import printable, refusal

TEXTURE_FORMAT = "voldetail.texture"
TEXTURE_MIGRATIONS: dict[int, Migration] = {}
"""Entry n brings the parsed file of version n to version n + 1; version 1 is the first: none yet."""

_WHAT = "texture file"


def load_texture(path: Path | str) -> Texture:
    """The texture in the JSON file at `path`.

    Raises InputError if the file is missing, over 1 MB, not JSON or of a newer version, or if it has an unknown key, a
    missing one, a number out of range, a curve that decreases or axes that are no rotation.
    """
    path = Path(path)
    return texture_from_text(read_small_text(path, _WHAT), where=printable(str(path)))


def load_example(path: Path | str) -> ColourTexture:
    """The texture by example in the JSON file at `path`, whose noise has bands or lobes.

    Raises InputError as `load_texture` does, and for a structure.
    """
    found = load_texture(path)
    if isinstance(found, StructureTexture):
        where = printable(str(path))
        raise InputError(f"{where} is a structure and has no bands; give a texture that was made of a photo with texture fit.")
    return found


def save_texture(path: Path | str, texture: Texture) -> None:
    """Write `texture` as JSON, numbers to 7 significant digits; the file appears whole or not at all."""
    write_text(Path(path), texture_to_text(texture))


def texture_to_text(texture: Texture) -> str:
    """The text of the texture file; a channel has its weights or its lobes, and not an empty list of the other."""
    data = {"format": TEXTURE_FORMAT, **texture.model_dump(mode="json")}
    for channel in data.get("channels", ()):
        del channel["weights" if channel["lobes"] else "lobes"]
    return json_text(data)


def texture_from_text(text: str, where: str = "The texture") -> Texture:
    """The texture in the JSON `text`; errors (InputError) start with `where`."""
    data = parsed(text, where, _WHAT)
    of_format(data, TEXTURE_FORMAT, where, _WHAT)
    data = migrated(data, COLOUR_VERSION, TEXTURE_MIGRATIONS, where)
    del data["format"]
    if isinstance(channels := data.get("channels"), list):
        for channel in channels:
            if isinstance(channel, dict) and channel.get("lobes"):
                channel.setdefault("weights", [])
    kind: type[ColourTexture] | type[StructureTexture] = StructureTexture if "model" in data else ColourTexture
    try:
        # Through JSON again, since only there "strict" takes a list for a tuple and still refuses "3" for 3.
        return kind.model_validate_json(json.dumps(data), strict=True)
    except ValidationError as error:
        raise InputError(refusal(error, kind, where) + ".") from None
    except (ValueError, RecursionError):
        raise InputError(f"{where} holds a value that is too large or too deeply nested.") from None
