"""A picture of which models are taken for which."""

from __future__ import annotations

from pathlib import Path

import matplotlib
import numpy as np
from numpy.typing import NDArray

matplotlib.use("Agg")
from matplotlib import pyplot as plt


def draw_confusion(path: Path, names: list[str], tables: dict[str, NDArray[np.intp]]) -> None:
    """Draw tables of counts, rows the model asked for, columns that of the first answer, as percentages."""
    figure, axes = plt.subplots(2, 2, figsize=(12, 12))
    for axis, (title, counts) in zip(axes.flat, tables.items(), strict=True):
        share = 100 * counts / counts.sum(axis=1, keepdims=True)
        axis.imshow(share, cmap="Blues", vmin=0, vmax=100)
        for row, column in np.argwhere(counts > 0):
            dark = share[row, column] > 60
            axis.text(column, row, f"{share[row, column]:.0f}", ha="center", va="center", fontsize=7, color="w" if dark else "k")
        axis.set_xticks(range(len(names)), names, rotation=60, ha="right", fontsize=8)
        axis.set_yticks(range(len(names)), names, fontsize=8)
        axis.set_title(f"{title}: {100 * np.trace(counts) / counts.sum():.0f} % right", loc="left", fontsize=10)
    figure.tight_layout()
    figure.savefig(path, dpi=75)
    plt.close(figure)
