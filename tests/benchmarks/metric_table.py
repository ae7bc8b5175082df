"""Scores of every metric on photographs: `python -m tests.benchmarks.metric_table [METRIC ...]` writes results/metric.

About half a minute a metric on two cores; named ones alone are scored again, the others keep the scores in table.json.
With ../shared/data beside the repository 42 textures, else scikit-image's three.
"""

import json
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image, ImageDraw

from tests.benchmarks import texture_families
from tests.benchmarks import texture_pictures as pictures
from tests.benchmarks.grain import grain_check
from tests.benchmarks.kept import keep
from tests.benchmarks.searched_decoys import searched
from tests.benchmarks.yardsticks import YARDSTICKS, distances, reference
from voldetail.files import write_text
from voldetail.image import to_srgb
from voldetail.metric import describe, distance_by_level
from voldetail.metric.layers import layers

RESULTS = Path(__file__).resolve().parents[2] / "results" / "metric"
_TILE = 120
"""Pixels of a crop shown in the sheet; distances are of the whole crop."""

KINDS = ("phase", "noise", "blur", "grain", "searched", "turned")


def nearest(photos: dict[str, pictures.Picture], metrics: tuple[str, ...]) -> dict[str, dict[str, float]]:
    """Same or different: rank-1 rate and mean average precision in per cent, the first crop of each texture asking."""
    gallery = [(name, corner) for name, photo in photos.items() for corner in pictures.corners(photo)]
    first = {name: pictures.crop(photo, pictures.corners(photo)[0]) for name, photo in photos.items()}
    asking = {metric: [reference(c, metric) for c in first.values()] for metric in metrics}
    found = {metric: np.zeros((len(first), len(gallery))) for metric in metrics}
    for column, (name, corner) in enumerate(gallery):
        picture = layers(pictures.crop(photos[name], corner))
        for metric, references in asking.items():
            found[metric][:, column] = distances(references, picture)
    return {metric: retrieval(values, list(first), [name for name, _ in gallery]) for metric, values in found.items()}


def retrieval(distances: np.ndarray, asking: list[str], gallery: list[str]) -> dict[str, float]:
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
        asking, wrong = reference(picture, metric), pictures.decoys(picture)
        forged = searched(name)
        if forged is not None:
            wrong["searched"] = forged
        near = {k: asking.distance(p) for k, p in pictures.accepted(photos[name]).items()}
        far = {k: asking.distance(p) for k, p in wrong.items()}
        crops = float(np.mean([value for kind, value in near.items() if kind.startswith("crop")]))
        for kind, value in far.items():
            ratios[kind].append(value / crops)
        if name in pictures.LIT_PHOTOS:
            # A column of its own, no part of the pairs: only what is odd in the slope of brightness can see it.
            ratios["turned"].append(asking.distance(pictures.turned(photos[name])) / crops)
        right += [a < d for a in near.values() for d in far.values()]
        clean += max(near.values()) < min(far.values())
        by_photo[name] = {kind: round(value, 4) for kind, value in (near | far).items()}
    return {
        "ratio_median": {kind: round(float(np.median(r)), 2) for kind, r in ratios.items() if r},
        "ratio_smallest": {kind: round(min(r), 2) for kind, r in ratios.items() if r},
        "pairs_right": round(100 * float(np.mean(right)), 1),
        "photos_clean": f"{clean}/{len(by_photo)}",
        "distances": by_photo,
    }


def milliseconds(picture: pictures.Picture, metric: str, repeats: int = 15) -> float:
    """Median processor time of describing a 192 x 192 picture like a reference and taking the distance.

    The metric runs in one thread, so that on a quiet machine this is the time passed.
    """
    asking, times = reference(picture, metric), []
    for _ in range(repeats):
        start = time.process_time()
        asking.distance(picture)
        times.append(time.process_time() - start)
    return round(1000 * float(np.median(times)), 1)


def paper_check(photos: dict[str, pictures.Picture]) -> dict[str, Any]:
    """GD10 figure 3 on scikit-image's photos: two crops of one photo against a crop of another, M by level."""
    found = {}
    for name in ("gravel", "grass", "brick"):
        asking = describe(pictures.crop(photos[name], (0, 0)), metric="published")
        rows = {}
        for other in ("gravel", "grass", "brick"):
            parts = distance_by_level(asking, describe(pictures.crop(photos[other], (320, 320)), like=asking))
            rows[f"crop of {other}"] = {level: round(value, 4) for level, value in (parts | {"M": sum(parts.values())}).items()}
        found[f"reference: crop of {name}"] = rows
    return found


def sheet(photos: dict[str, pictures.Picture], path: Path) -> None:
    """The decoys of the CC0 photos as pictures, with the distances of the default and of the published metric."""
    rows = []
    for name in (n for n in pictures.SHEET_PHOTOS if n in photos):
        picture = pictures.crop(photos[name], pictures.corners(photos[name])[0])
        shown = {name: picture, "other crop": pictures.accepted(photos[name])["crop 2"]} | pictures.decoys(picture)
        forged = searched(name)
        shown["searched"] = np.ones_like(picture) if forged is None else forged
        references = [reference(picture, metric) for metric in ("combined", "published")]
        tiles = []
        for title, tile in shown.items():
            values = [one.distance(tile) for one in references]
            image = Image.new("L", (_TILE, _TILE + 24), 255)
            part = np.clip(to_srgb(tile[:_TILE, :_TILE]), 0, 1)
            image.paste(Image.fromarray((part * 255).round().astype(np.uint8)), (0, 24))
            title = f"{title}\n{values[0]:.1f}    M {values[1]:.2f}"
            ImageDraw.Draw(image).text((2, 0), title, fill=0, spacing=0)
            tiles.append(np.asarray(image))
        rows.append(np.hstack(tiles))
    keep(path, Image.fromarray(np.vstack(rows)))


def table(scores: dict[str, Any]) -> str:
    """The scores as a Markdown table."""
    heads = ["metric", "rank 1, %", "mAP, %", *(f"{kind} / crop" for kind in KINDS)]
    heads += ["pairs right, %", "photos clean", "order", "steps up, %", "ms"]
    lines = ["| " + " | ".join(heads) + " |", "|---" * len(heads) + "|"]
    for metric, s in scores.items():
        median, least = s["ratio_median"], s["ratio_smallest"]
        cells = [metric, s["rank1"], s["map"], *(f"{median[k]} ({least[k]})" if k in median else "" for k in KINDS)]
        cells += [s["pairs_right"], s["photos_clean"], s["order"]["all"]["rank"], s["order"]["all"]["steps"], s["ms"]]
        lines.append("| " + " | ".join(map(str, cells)) + " |")
    return "\n".join(lines) + "\n"


def main() -> None:
    shared = RESULTS.parents[2] / "shared" / "data"
    photos = pictures.textures(shared if shared.is_dir() else None)
    metrics = tuple(sys.argv[1:]) or YARDSTICKS
    path = RESULTS / "table.json"
    scores = json.loads(path.read_text())["scores"] if sys.argv[1:] else {}
    ranked = nearest(photos, metrics)
    families = [*texture_families.rendered(), *texture_families.photographed(photos)]
    for metric in metrics:
        scores[metric] = (
            ranked[metric]
            | fooled(photos, metric)
            | {"order": texture_families.order(families, metric)}
            | {"ms": milliseconds(next(iter(photos.values()))[:192, :192], metric)}
        )
    scores = {metric: scores[metric] for metric in YARDSTICKS if metric in scores}
    RESULTS.mkdir(parents=True, exist_ok=True)
    write_text(path, json.dumps({"textures": list(photos), "scores": scores}, indent=1) + "\n")
    write_text(RESULTS / "table.md", table(scores))
    write_text(RESULTS / "paper_check.json", json.dumps(paper_check(photos), indent=1) + "\n")
    write_text(RESULTS / "grain.json", json.dumps(grain_check(photos), indent=1) + "\n")
    sheet(photos, RESULTS / "decoys.jpg")
    print(table(scores))


if __name__ == "__main__":
    main()
