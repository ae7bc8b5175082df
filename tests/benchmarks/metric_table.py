"""Scores of every metric on photographs: `python tests/benchmarks/metric_table.py` writes results/metric.

About two minutes on two cores. With ../shared/data beside the repository 42 textures, else scikit-image's three.
"""

import dataclasses
import json
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image, ImageDraw

REPOSITORY = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(Path(__file__).parent))
sys.path.insert(1, str(REPOSITORY))

import texture_pictures as pictures  # noqa: E402

from voldetail.files import write_text  # noqa: E402
from voldetail.image import to_srgb  # noqa: E402
from voldetail.metric import METRICS, Descriptor, describe, distance, distance_by_level  # noqa: E402
from voldetail.metric.descriptor import describe_layers  # noqa: E402
from voldetail.metric.layers import layers  # noqa: E402

RESULTS = REPOSITORY / "results" / "metric"
_TILE = 120
"""Pixels of a crop shown in the sheet; distances are of the whole crop."""

KINDS = ("phase", "noise", "blur", "grain")


def nearest(photos: dict[str, pictures.Picture]) -> dict[str, dict[str, float]]:
    """Same or different: rank-1 rate and mean average precision in per cent, the first crop of each texture asking."""
    gallery = [(name, corner) for name, photo in photos.items() for corner in pictures.corners(photo)]
    first = {name: pictures.crop(photo, pictures.corners(photo)[0]) for name, photo in photos.items()}
    asking = {metric: {n: describe(c, metric=metric) for n, c in first.items()} for metric in METRICS}
    found = {metric: np.zeros((len(first), len(gallery))) for metric in METRICS}
    for column, (name, corner) in enumerate(gallery):
        picture = layers(pictures.crop(photos[name], corner))
        for metric, references in asking.items():
            measured: Descriptor | None = None
            for row, reference in enumerate(references.values()):
                if measured is None or metric == "published":  # only its features depend on the reference
                    measured = describe_layers(picture, reference)
                alike = dataclasses.replace(measured, basis=reference.basis, floors=reference.floors)
                found[metric][row, column] = distance(reference, alike)
    return {
        metric: _retrieval(distances, list(first), [name for name, _ in gallery]) for metric, distances in found.items()
    }


def _retrieval(distances: np.ndarray, asking: list[str], gallery: list[str]) -> dict[str, float]:
    hits, precision = [], []
    for name, row in zip(asking, distances, strict=True):
        itself = gallery.index(name)
        order = [i for i in np.argsort(row, kind="stable") if i != itself]
        same = np.array([gallery[i] == name for i in order])
        ranks = np.flatnonzero(same)
        hits.append(same[0])
        precision.append(np.mean((np.arange(len(ranks)) + 1) / (ranks + 1)))
    return {"rank1": round(100 * float(np.mean(hits)), 1), "map": round(100 * float(np.mean(precision)), 1)}


def fooled(photos: dict[str, pictures.Picture], metric: str) -> dict[str, Any]:
    """Decoys against accepted pictures: distances over that of the other crops, and how often the order is right."""
    ratios: dict[str, list[float]] = {kind: [] for kind in KINDS}
    right, clean, by_photo = [], 0, {}
    for name in pictures.DECOY_PHOTOS:
        if name not in photos:
            continue
        picture = pictures.crop(photos[name], pictures.corners(photos[name])[0])
        reference = describe(picture, metric=metric)
        near = {k: distance(reference, describe(p, like=reference)) for k, p in pictures.accepted(photos[name]).items()}
        far = {k: distance(reference, describe(p, like=reference)) for k, p in pictures.decoys(picture).items()}
        crops = float(np.mean([value for kind, value in near.items() if kind.startswith("crop")]))
        for kind in KINDS:
            ratios[kind].append(far[kind] / crops)
        right += [a < d for a in near.values() for d in far.values()]
        clean += max(near.values()) < min(far.values())
        by_photo[name] = {kind: round(value, 4) for kind, value in (near | far).items()}
    return {
        "ratio_median": {kind: round(float(np.median(r)), 2) for kind, r in ratios.items()},
        "ratio_smallest": {kind: round(min(r), 2) for kind, r in ratios.items()},
        "pairs_right": round(100 * float(np.mean(right)), 1),
        "photos_clean": f"{clean}/{len(by_photo)}",
        "distances": by_photo,
    }


def milliseconds(picture: pictures.Picture, metric: str, repeats: int = 15) -> float:
    """Median processor time of describing a 192 x 192 picture like a reference and taking the distance.

    The metric runs in one thread, so that on a quiet machine this is the time passed.
    """
    reference, times = describe(picture, metric=metric), []
    for _ in range(repeats):
        start = time.process_time()
        distance(reference, describe(picture, like=reference))
        times.append(time.process_time() - start)
    return round(1000 * float(np.median(times)), 1)


def paper_check(photos: dict[str, pictures.Picture]) -> dict[str, Any]:
    """GD10 figure 3 on scikit-image's photos: two crops of one photo against a crop of another, M by level."""
    found = {}
    for name in ("gravel", "grass", "brick"):
        reference = describe(pictures.crop(photos[name], (0, 0)), metric="published")
        rows = {}
        for other in ("gravel", "grass", "brick"):
            parts = distance_by_level(reference, describe(pictures.crop(photos[other], (320, 320)), like=reference))
            rows[f"crop of {other}"] = {
                level: round(value, 4) for level, value in (parts | {"M": sum(parts.values())}).items()
            }
        found[f"reference: crop of {name}"] = rows
    return found


def sheet(photos: dict[str, pictures.Picture], path: Path) -> None:
    """The decoys of the CC0 photos as pictures, with the distances of the default and of the published metric."""
    rows = []
    for name in (n for n in pictures.SHEET_PHOTOS if n in photos):
        picture = pictures.crop(photos[name], pictures.corners(photos[name])[0])
        shown = {name: picture, "other crop": pictures.accepted(photos[name])["crop 2"]} | pictures.decoys(picture)
        references = [describe(picture, metric=metric) for metric in ("combined", "published")]
        tiles = []
        for title, tile in shown.items():
            values = [distance(reference, describe(tile, like=reference)) for reference in references]
            image = Image.new("L", (_TILE, _TILE + 24), 255)
            part = np.clip(to_srgb(tile[:_TILE, :_TILE]), 0, 1)
            image.paste(Image.fromarray((part * 255).round().astype(np.uint8)), (0, 24))
            title = f"{title}\n{values[0]:.1f}    M {values[1]:.2f}"
            ImageDraw.Draw(image).text((2, 0), title, fill=0, spacing=0)
            tiles.append(np.asarray(image))
        rows.append(np.hstack(tiles))
    Image.fromarray(np.vstack(rows)).save(path, optimize=True)


def table(scores: dict[str, Any]) -> str:
    """The scores as a Markdown table."""
    lines = [
        "| metric | rank 1, % | mAP, % | phase / crop | noise / crop | blur / crop | grain / crop "
        "| pairs right, % | photos clean | ms |",
        "|---|---|---|---|---|---|---|---|---|---|",
    ]
    for metric, s in scores.items():
        ratios = " | ".join(f"{s['ratio_median'][k]} ({s['ratio_smallest'][k]})" for k in KINDS)
        cells = [metric, s["rank1"], s["map"], ratios, s["pairs_right"], s["photos_clean"], s["ms"]]
        lines.append("| " + " | ".join(map(str, cells)) + " |")
    return "\n".join(lines) + "\n"


def main() -> None:
    shared = REPOSITORY.parent / "shared" / "data"
    photos = pictures.textures(shared if shared.is_dir() else None)
    retrieval = nearest(photos)
    scores = {
        metric: retrieval[metric]
        | fooled(photos, metric)
        | {"ms": milliseconds(next(iter(photos.values()))[:192, :192], metric)}
        for metric in METRICS
    }
    RESULTS.mkdir(parents=True, exist_ok=True)
    written = {"textures": list(photos), "scores": scores}
    write_text(RESULTS / "table.json", json.dumps(written, indent=1) + "\n")
    write_text(RESULTS / "table.md", table(scores))
    write_text(RESULTS / "paper_check.json", json.dumps(paper_check(photos), indent=1) + "\n")
    sheet(photos, RESULTS / "decoys.png")
    print(table(scores))


if __name__ == "__main__":
    main()
