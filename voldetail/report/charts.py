"""The three diagrams of a report, drawn on axes that the caller made."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from voldetail.detail import Detail, NoiseFloor
from voldetail.image import luminance, to_srgb
from voldetail.report.verdict import number
from voldetail.results import FitResult

PHOTO_COLOUR = "#4f86c6"
FIT_COLOUR = "#e8833a"  # both legible on white and on near-black, and apart for every common colour vision
BINS = 48


@dataclass(frozen=True)
class Ink:
    """Colours of lines and text on a page."""

    text: str = "#22262b"
    faint: str = "#8a9099"


def style(axes: Axes, ink: Ink, title: str, along: str, up: str) -> None:
    """Give a diagram its title, named axes and a quiet frame."""
    axes.set_title(title, loc="left", fontsize=10, color=ink.text, pad=8)
    axes.set_xlabel(along, fontsize=8, color=ink.text)
    axes.set_ylabel(up, fontsize=8, color=ink.text)
    axes.tick_params(labelsize=8, colors=ink.text, length=3, which="both")
    axes.patch.set_alpha(0.0)
    for side, spine in axes.spines.items():
        spine.set_visible(side in ("left", "bottom"))
        spine.set_color(ink.faint)
    axes.grid(True, color=ink.faint, alpha=0.25, linewidth=0.6)
    axes.set_axisbelow(True)


def draw_histograms(axes: Axes, ink: Ink, photo: NDArray[Any], fitted: NDArray[Any], mask: NDArray[np.bool_]) -> None:
    """Draw how often each brightness occurs in photo and fit (linear pictures (H, W, 3)), inside ``mask``."""
    edges = np.linspace(0, 1, BINS + 1)
    for picture, colour, name, filled in (
        (photo, PHOTO_COLOUR, "photo", True),
        (fitted, FIT_COLOUR, "fit", False),
    ):
        values = np.clip(to_srgb(luminance(picture)[mask]), 0, 1)
        share = 100 * np.histogram(values, edges)[0] / max(values.size, 1)
        axes.stairs(share, edges, fill=filled, color=colour, alpha=0.45 if filled else 1.0, linewidth=1.6, label=name)
    style(axes, ink, "Brightness of photo and fit", "brightness on the screen, 0 black to 1 white", "pixels, %")
    axes.set_xlim(0, 1)
    _legend(axes, ink)


def draw_convergence(axes: Axes, ink: Ink, result: FitResult) -> None:
    """Draw the best distance M against the pictures compared, and the distances of equal textures."""
    # The last is what the detail file says; where nothing was compared at full resolution it is the only one.
    trace = [*result.trace, (max(result.evaluations, 1), result.distance)]
    count, best = np.array(trace, dtype=float).T
    best = np.where(best > 0, best, np.nan)
    lasting = np.append(best[:-1], best[-2:-1])  # the last improvement holds to the end
    axes.step(count[: len(lasting)], lasting, where="post", color=FIT_COLOUR, linewidth=1.8, label="best M so far")
    axes.plot(count[-1], best[-1], "o", color=FIT_COLOUR, markersize=6, label="M of the detail, with its own seed")
    axes.annotate(
        number(result.distance),
        (count[-1], best[-1]),
        textcoords="offset points",
        xytext=(0, 7),
        ha="right",
        fontsize=9,
        color=ink.text,
    )
    _draw_floors(axes, result.detail.noise_floor)
    axes.set_yscale("log")
    low, high = axes.get_ylim()
    axes.set_ylim(low / 1.15, high * (high / low) ** 0.35)  # room for the legend
    axes.set_xlim(0, 1.02 * count[-1])
    axes.axvspan(0, count[0], color=ink.faint, alpha=0.12, linewidth=0)
    if count[0] > 0.25 * count[-1]:
        words = "searching at\nhalf resolution"
        middle = 0.5 * count[0] / axes.get_xlim()[1]
        place: dict[str, Any] = {"transform": axes.transAxes, "ha": "center", "va": "center"}
        axes.text(middle, 0.6, words, fontsize=8, color=ink.text, **place)
    axes.yaxis.set_major_formatter(lambda value, _: f"{value:g}")
    axes.yaxis.set_minor_formatter(lambda value, _: f"{value:g}" if f"{value:.0e}"[0] in "25" else "")
    title = "The search: distance M between photo and fit"
    style(axes, ink, title, "pictures compared", "M (lower is nearer)")
    _legend(axes, ink)


def _draw_floors(axes: Axes, floor: NoiseFloor) -> None:
    """Draw the distances of equal textures as level lines."""
    marks = (
        (floor.photo_halves, "the photo's two halves", "--"),
        (floor.other_seed, "two seeds of the detail", ":"),
    )
    for value, name, dashes in marks:
        if value:
            axes.axhline(value, color=PHOTO_COLOUR, linestyle=dashes, linewidth=1.4, label=f"{name}: {number(value)}")


def draw_profile(axes: Axes, ink: Ink, detail: Detail) -> None:
    """Draw the profile H as heights in scene units."""
    heights = np.asarray(detail.noise.curve) * detail.relief.amplitude
    values = np.linspace(-1, 1, len(heights))
    axes.fill_between(values, heights, color=FIT_COLOUR, alpha=0.25, linewidth=0)
    axes.plot(values, heights, color=FIT_COLOUR, linewidth=1.8, marker="o", markersize=3.5)
    style(axes, ink, "Profile of the relief (H)", "noise value", "height, scene units")
    axes.set_xlim(-1, 1)
    axes.set_ylim(0, max(1.08 * float(heights.max()), 1e-6))


def _legend(axes: Axes, ink: Ink) -> None:
    legend = axes.legend(fontsize=8, frameon=False, labelcolor=ink.text)
    legend.set_zorder(5)


def new_figure(width: float, height: float, background: str | None = None, dpi: int = 100) -> Figure:
    """Return a figure (inches) of its own: no window, no state shared with other users of matplotlib."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg

    figure = Figure(figsize=(width, height), dpi=dpi)
    FigureCanvasAgg(figure)
    if background is None:
        figure.patch.set_alpha(0.0)
    else:
        figure.patch.set_facecolor(background)
    return figure
