"""Figures and numbers of the benchmark of stationary tiles: medians, intervals, and variance over seeds."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
from numpy.typing import NDArray
from scipy import stats

from voldetail.files import write_text

matplotlib.use("Agg")
from matplotlib import pyplot as plt

Numbers = NDArray[np.float64]

COLOURS = {"plain": "tab:orange", "histogram": "tab:blue"}  # as in the paper
NAMES = {"plain": "toroidal PatchMatch", "histogram": "local histograms"}
COSTS = ("combined", "stationarity", "texture")


def scaled(record: dict[str, Any], costs: Numbers) -> Numbers:
    """Texture and stationarity costs (..., 2) divided by the photo's scales, as (..., 3): COSTS."""
    texture = costs[..., 0] / record["scales"]["texture"]
    stationarity = costs[..., 1] / record["scales"]["stationarity"]
    return np.stack([texture + stationarity, stationarity, texture], axis=-1)


def of_seeds(record: dict[str, Any], way: str) -> Numbers:
    """The costs (seeds, 3) of one way for a photograph."""
    return scaled(record, np.array([[s[way]["texture"], s[way]["stationarity"]] for s in record["seeds"].values()]))


def summarise(folder: Path, records: list[dict[str, Any]], best_seed: Callable[[dict[str, Any]], int]) -> None:
    """Write summary.json, figure3.png and figure4.png."""
    best = {way: np.array([of_seeds(r, way)[list(r["seeds"]).index(str(best_seed(r)))] for r in records]) for way in COLOURS}
    every = {way: [of_seeds(r, way) for r in records] for way in COLOURS}
    summary: dict[str, Any] = {
        "photographs": len(records), "seeds": min(len(r["seeds"]) for r in records), "size": records[0]["size"],
        "costs are": "divided by the photo's variance (texture) and mean difference of two pixels (stationarity)",
        "seed that is best for plain PatchMatch": {way: _spread(best[way]) for way in COLOURS},
        "lower with local histograms, of all photographs": {
            name: round(float((best["histogram"][:, i] < best["plain"][:, i]).mean()), 3) for i, name in enumerate(COSTS)
        },
        "mean over seeds": {way: _interval(np.array([v[:, 1].mean() for v in every[way]])) for way in COLOURS},
        "seconds a tile, median": {
            way: float(np.median([s[way]["seconds"] for r in records for s in r["seeds"].values()])) for way in COLOURS
        },
    }  # fmt: skip
    if summary["seeds"] > 1:
        deviations = {way: np.array([v[:, 1].std(ddof=1) for v in every[way]]) for way in COLOURS}
        summary["standard deviation over seeds"] = {way: _interval(deviations[way]) for way in COLOURS}
        summary["less deviation with local histograms"] = round(float((deviations["histogram"] < deviations["plain"]).mean()), 3)
    write_text(folder / "summary.json", json.dumps(summary, indent=1) + "\n")
    _figure3(folder / "figure3.png", records, best)
    _figure4(folder / "figure4.png", every)
    print(json.dumps(summary, indent=1))


def _spread(values: Numbers) -> dict[str, list[float]]:
    """Of each cost the median and the 5th and 95th percentile over photographs."""
    return {name: [round(float(q), 4) for q in np.quantile(values[:, i], [0.5, 0.05, 0.95])] for i, name in enumerate(COSTS)}


def _interval(values: Numbers) -> dict[str, Any]:
    """Mean and median over photographs, and half the 95 % t interval of the mean."""
    half = float(stats.t.ppf(0.975, len(values) - 1) * stats.sem(values)) if len(values) > 1 else None
    return {
        "mean": round(float(values.mean()), 4), "median": round(float(np.median(values)), 4),
        "half of the 95 % interval": None if half is None else round(half, 4),
    }  # fmt: skip


def _figure3(path: Path, records: list[dict[str, Any]], best: dict[str, Numbers]) -> None:
    """Combined cost against iterations, and the distributions of the costs at the end (MJHRW17 figure 3)."""
    figure, axes = plt.subplots(1, 4, figsize=(16, 3.6))
    for way, colour in COLOURS.items():
        traces = [scaled(r, np.array(r["trace"][way]))[:, 0] for r in records if way in r["trace"]]
        shortest = min((len(t) for t in traces), default=0)
        if shortest:
            low, middle, high = np.quantile(np.array([t[:shortest] for t in traces]), [0.05, 0.5, 0.95], axis=0)
            x = np.arange(1, shortest + 1)
            axes[0].plot(x, middle, color=colour, lw=2, label=NAMES[way])
            axes[0].plot(x, low, color=colour, lw=0.7)
            axes[0].plot(x, high, color=colour, lw=0.7)
    axes[0].set(xlabel="iteration", ylabel="combined cost", title="median, 5th and 95th percentile")
    axes[0].legend()
    for i, name in enumerate(COSTS):
        _distributions(axes[i + 1], {way: values[:, i] for way, values in best.items()}, f"{name} cost")
    _save(figure, path)


def _figure4(path: Path, every: dict[str, list[Numbers]]) -> None:
    """Mean and variance of the stationarity cost over seeds (MJHRW17 figure 4)."""
    figure, axes = plt.subplots(1, 2, figsize=(9, 3.6))
    means = {way: np.array([v[:, 1].mean() for v in values]) for way, values in every.items()}
    variances = {way: np.array([v[:, 1].var(ddof=1) if len(v) > 1 else 0.0 for v in values]) for way, values in every.items()}
    _distributions(axes[0], means, "mean stationarity cost over seeds")
    _distributions(axes[1], variances, "its variance over seeds")
    _save(figure, path)


def _distributions(axis: plt.Axes, values: dict[str, Numbers], title: str) -> None:
    bins = np.linspace(0, max(float(v.max()) for v in values.values()) or 1.0, 21)
    for way, found in values.items():
        axis.hist(found, bins=list(bins), color=COLOURS[way], alpha=0.6, label=NAMES[way])
    axis.set(title=title, ylabel="photographs")


def _save(figure: plt.Figure, path: Path) -> None:
    figure.tight_layout()
    figure.savefig(path, dpi=90)
    plt.close(figure)
