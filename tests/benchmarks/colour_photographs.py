"""Colour textures by example on twenty photographs, beside Heeger & Bergen's synthesis, judged by two judges.

Run with:  python -m tests.benchmarks.colour_photographs -o results/colour [--only NAME ...] [--again] [--unshown FOLDER]
Each photograph's numbers are written when it is done; a second run skips those that are there, and --again does them anew.
Photographs whose licence does not allow to show them give numbers only; their rows go to --unshown FOLDER if one is given.
The synthesis needs pyrtools, which the extra "test" brings.
"""

from __future__ import annotations

import argparse
import json
import time
from collections.abc import Sequence
from pathlib import Path
from statistics import median
from typing import Any

import numpy as np
from PIL import Image

from tests.benchmarks import colour_sheets as sheets
from tests.benchmarks.colour_judges import JUDGES
from tests.benchmarks.colour_list import PHOTOS, ColourPhoto, Picture, crops, is_there, load
from tests.benchmarks.kept import keep
from tests.benchmarks.relit import markdown
from tests.benchmarks.rivals.heeger_bergen import synthesise
from voldetail.detail.colour import ColourTexture
from voldetail.files import write_text
from voldetail.image import to_linear, to_srgb
from voldetail.texture import analyse, load_example, picture, save_texture

LARGER, EDITED = "rock_weathered", "stone_slab"
MORPHED = ("stone_slab", "veined_rock")
CARVED = ("stone_slab", "veined_rock", "rock_weathered")
OVERVIEW_SIDE = 128

MADE = ("ours", "heeger_bergen")


def run(photo: ColourPhoto, output: Path, unshown: Path | None) -> dict[str, Any]:
    """Analyse, synthesise and judge one photograph; writes its texture and, where it may be, its row."""
    example, *others = crops(load(photo), photo.side)
    started = time.perf_counter()
    texture = analyse(example, name=photo.name, photo_name=Path(photo.path).name)
    analysed = time.perf_counter()
    ours = picture(texture, (photo.side, photo.side))
    drawn = time.perf_counter()
    rival = synthesise(example, (photo.side, photo.side))
    ended = time.perf_counter()
    (output / "textures").mkdir(parents=True, exist_ok=True)
    save_texture(output / "textures" / f"{photo.name}.json", texture)
    place = output / "rows" if photo.shown else unshown
    if place is not None:
        tiles = [
            (f"{photo.name.replace('_', ' ')}: photograph", example), (f"ours, {numbers(texture)} numbers", ours),
            ("Heeger & Bergen 1995", rival),
        ]  # fmt: skip
        keep(place / f"{photo.name}.jpg", sheets.row(tiles))
    return {
        "name": photo.name, "kind": photo.kind, "about": photo.about, "licence": photo.licence, "shown": photo.shown,
        "side": photo.side, "crops": len(others) + 1, "numbers": numbers(texture),
        "directed": any(c.lobes for c in texture.channels),
        "seconds": {"analysis": round(analysed - started, 2), "picture": round(drawn - analysed, 2),
                    "heeger_bergen": round(ended - drawn, 2)},
        **judged(example, others, {"ours": ours, "heeger_bergen": rival}),
    }  # fmt: skip


def judged(example: Picture, others: Sequence[Picture], made: dict[str, Picture]) -> dict[str, Any]:
    """Return each judge's distances from the example, in units of the mean distance of the photo's other crops.

    What was made is rounded to 8 bits as the photo was.
    """
    record: dict[str, Any] = {}
    for name, judge in JUDGES.items():
        seen = judge(example)
        own = [seen.distance(other) for other in others]
        unit = float(np.mean(own))
        record[name] = {
            "other_crops": [round(min(own) / unit, 2), round(max(own) / unit, 2)],
            **{key: round(seen.distance(in_8_bits(shown)) / unit, 2) for key, shown in made.items()},
        }
    return record


def in_8_bits(shown: Picture) -> Picture:
    """Return a linear picture as it comes back from a file."""
    return to_linear(np.round(np.clip(to_srgb(shown), 0, 1) * 255) / 255)


def numbers(texture: ColourTexture) -> int:
    """Return how many numbers the texture is: weights, five a lobe, samples of the curves and the rotation's nine."""
    return sum(len(c.weights) + 5 * len(c.lobes) + len(c.curve) for c in texture.channels) + len(texture.axes)


def table(records: Sequence[dict[str, Any]]) -> str:
    """Return the figures in Markdown: first the medians, then each photograph."""
    summary = []
    for kind in ("stochastic", "structured"):
        some = [record for record in records if record["kind"] == kind]
        for judge in JUDGES if some else ():
            wins = sum(record[judge]["ours"] < record[judge]["heeger_bergen"] for record in some)
            middle = [f"{median(record[judge][key] for record in some):.2f}" for key in MADE]
            farthest = f"{median(record[judge]['other_crops'][1] for record in some):.2f}"
            summary.append([kind, judge, *middle, farthest, f"{wins} of {len(some)}"])
    names = ["ours", "Heeger & Bergen"]
    rows = []
    for record in records:
        figures = [f"{record[judge][key]:.2f}" for judge in JUDGES for key in MADE]
        spreads = [" to ".join(f"{end:.2f}" for end in record[judge]["other_crops"]) for judge in JUDGES]
        rows.append([record["name"].replace("_", " "), record["about"], *figures, *spreads, record["licence"]])
    header = ["photograph", "what it shows"]
    header += [f"{name}, by {judge}" for judge in JUDGES for name in names]
    header += [f"other crops, by {judge}" for judge in JUDGES]
    return (
        "Distances from a crop of the photograph, in units of the mean distance of the photograph's other crops.\n\n"
        "Medians:\n\n"
        + markdown(["kind", "judge", *names, "farthest other crop", "ours nearer than Heeger & Bergen"], summary)
        + "\nEach photograph:\n\n" + markdown([*header, "licence"], rows)
    )  # fmt: skip


def overview(output: Path, records: Sequence[dict[str, Any]]) -> None:
    """Write overview.jpg: the middle of photo, ours and Heeger & Bergen of all that may be shown."""
    lines = []
    for record in records:
        path = output / "rows" / f"{record['name']}.jpg"
        if record["shown"] and path.exists():
            title = f"{record['name'].replace('_', ' ')}: photograph | ours | Heeger & Bergen"
            lines.append(sheets.tiles_of(Image.open(path).convert("RGB"), title, record["side"], OVERVIEW_SIDE))
    if lines:
        keep(output / "overview.jpg", sheets.stacked(lines, 2))


def extras(output: Path, again: bool) -> None:
    """Write what only a formula can give, where the textures that it needs are there."""
    textures = {path.stem: load_example(path) for path in sorted((output / "textures").glob("*.json"))}
    needs = {"larger": (LARGER,), "morph": MORPHED, "edit": (EDITED,), "solid": CARVED}
    for name, wanted in needs.items():
        path = output / f"{name}.jpg"
        if not set(wanted) <= textures.keys() or (path.exists() and not again):
            continue
        chosen = [textures[one] for one in wanted]
        if name == "larger":
            photo = next(photo for photo in PHOTOS if photo.name == LARGER)
            keep(path, sheets.larger_row(crops(load(photo), photo.side)[0], chosen[0]))
        elif name == "morph":
            # Both of bands: lobes and bands cannot be mixed.
            found = [next(photo for photo in PHOTOS if photo.name == one) for one in wanted]
            plain = [analyse(crops(load(p), p.side)[0], name=p.name, directed=False) for p in found]
            keep(path, sheets.morph_row(*plain))
        elif name == "edit":
            keep(path, sheets.edit_row(*chosen))
        else:
            keep(path, sheets.solid_row(chosen))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("-o", "--output", type=Path, default=Path("results/colour"))
    parser.add_argument("--unshown", type=Path)
    parser.add_argument("--only", nargs="+", default=[])
    parser.add_argument("--again", action="store_true")
    arguments = parser.parse_args()
    written = arguments.output / "colour.json"
    known = {record["name"]: record for record in json.loads(written.read_text())} if written.exists() else {}
    for photo in PHOTOS:
        if (arguments.only and photo.name not in arguments.only) or (photo.name in known and not arguments.again):
            continue
        if not is_there(photo):
            print(f"{photo.name}: skipped, {photo.path} is not there")
            continue
        known[photo.name] = run(photo, arguments.output, arguments.unshown)
        print(json.dumps(known[photo.name]), flush=True)
        ordered = [known[one.name] for one in PHOTOS if one.name in known]
        write_text(written, json.dumps(ordered, indent=1) + "\n")
    ordered = [known[one.name] for one in PHOTOS if one.name in known]
    write_text(arguments.output / "colour.md", table(ordered))
    overview(arguments.output, ordered)
    extras(arguments.output, arguments.again)


if __name__ == "__main__":
    main()
