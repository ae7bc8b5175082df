"""Photographs and the structures found for them: `python -m tests.benchmarks.retrieval_photographs [FOLDER [ENTRIES]]`.

Writes results/retrieval/photographs.json, sheet_*.jpg for photographs that may be shown, and the sheets of the others to FOLDER,
where descriptors of the library are kept as well (see `retrieval_models`). Rows: photo, its structure map, and the best entry of
each of the three nearest models in the photo's tones.
"""

from __future__ import annotations

import json
import sys
from math import degrees
from pathlib import Path
from tempfile import gettempdir
from typing import Any

import matplotlib
import numpy as np
from numpy.typing import NDArray

from tests.benchmarks.retrieval_models import ENTRIES, RESULTS, library
from tests.benchmarks.retrieval_photos import Sought, ready, there
from voldetail.image import luminance, to_srgb
from voldetail.library import Answer, Novelty, Query, novelty_of, picture, rank
from voldetail.library.groups import Groups
from voldetail.metric import describe, distance

matplotlib.use("Agg")
from matplotlib import pyplot as plt

ROWS = 5
"""Photographs a sheet."""

SHOWN = 3


def answers(groups: Groups, asked: Query) -> list[Answer]:
    """Each model's best entry, nearest first."""
    found = rank(groups, asked.vector, 1, tones=(asked.tones.dark, asked.tones.bright))
    return sorted((best for (best,) in found.by_model.values()), key=lambda answer: answer.distance)


def judged(asked: Query, found: list[Answer]) -> list[float]:
    """M of pictures against the photo, in luminance."""
    reference = describe(luminance(asked.photo))
    size = asked.photo.shape[:2]
    return [distance(reference, describe(luminance(picture(a, (size[0], size[1]))), like=reference)) for a in found]


def sheet(path: Path, rows: list[tuple[Sought, Query, list[Answer], bool]]) -> None:
    """Write a sheet of photographs and answers as a JPEG."""
    figure, axes = plt.subplots(len(rows), 2 + SHOWN, figsize=(2.5 * (2 + SHOWN), 2.75 * len(rows)), squeeze=False)
    for line, (sought, asked, found, known) in zip(axes, rows, strict=True):
        about = f"{sought.name}{'' if known else ': nothing quite like it'}\n{sought.credit}"
        _show(line[0], to_srgb(asked.photo), about)
        share = f"structure\n{asked.tones.explained:.0%} in two tones"
        _show(line[1], np.repeat(asked.tones.structure[..., None], 3, axis=2), share)
        size = (asked.photo.shape[0], asked.photo.shape[1])
        for axis, answer in zip(line[2:], found, strict=False):
            how = f"{degrees(answer.rotation):.4g}°{', swapped' if answer.swapped else ''}"
            _show(axis, to_srgb(picture(answer, size)), f"{answer.model}, D {answer.distance:.2f}\n{how}")
    figure.tight_layout()
    figure.savefig(path, dpi=72, pil_kwargs={"quality": 82})
    plt.close(figure)


def _show(axis: plt.Axes, encoded: NDArray[np.float32], title: str) -> None:
    axis.imshow(np.clip(encoded, 0, 1), interpolation="antialiased")
    axis.set_title(title, fontsize=7, loc="left")
    axis.axis("off")


def main() -> None:
    folder = Path(sys.argv[1]) if len(sys.argv) > 1 else Path(gettempdir()) / "voldetail-retrieval"
    folder.mkdir(parents=True, exist_ok=True)
    RESULTS.mkdir(parents=True, exist_ok=True)
    groups = library(folder, int(sys.argv[2]) if len(sys.argv) > 2 else ENTRIES)
    rows, report = [], {}
    for sought in there():
        asked = ready(sought)
        found = answers(groups, asked)
        looks = judged(asked, found[:SHOWN])
        novelty = novelty_of(groups[found[0].model], found[0])
        assert novelty is not None
        report[sought.name] = record(sought, asked, found, looks, novelty)
        rows.append((sought, asked, found[:SHOWN], not novelty.novel))
        words = [f"{a.model} {a.distance:.2f} M {m:.1f}" for a, m in zip(found, looks, strict=False)]
        print(sought.name, not novelty.novel, round(novelty.farthest, 3), words, flush=True)
    for name, place, chosen in (
        ("sheet", RESULTS, [row for row in rows if row[0].credit]), ("other", folder, [row for row in rows if not row[0].credit])
    ):  # fmt: skip
        for first in range(0, len(chosen), ROWS):
            sheet(place / f"{name}_{first // ROWS + 1}.jpg", chosen[first : first + ROWS])
    (RESULTS / "photographs.json").write_text(json.dumps(report, indent=1) + "\n")


def record(sought: Sought, asked: Query, found: list[Answer], looks: list[float], novelty: Novelty) -> dict[str, Any]:
    """What the JSON file says of a photograph."""
    return {
        "about": sought.about, "outside": sought.outside, "explained": round(asked.tones.explained, 3),
        "known": not novelty.novel, "farthest_of_its_model": round(novelty.farthest, 3),
        "answers": [
            {
                "model": a.model, "distance": round(a.distance, 3), "M": round(m, 2), "degrees": round(degrees(a.rotation), 2),
                "swapped": a.swapped, "parameters": {key: float(f"{value:.4g}") for key, value in a.parameters.items()},
            }
            for a, m in zip(found, looks, strict=False)
        ],
    }  # fmt: skip


if __name__ == "__main__":
    main()
