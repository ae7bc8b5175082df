"""The sheet: a whole fit on one picture, to print or to lay beside others."""

from __future__ import annotations

import textwrap
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib import patheffects
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from voldetail.detail import describe_in_words, summary
from voldetail.files import write_bytes
from voldetail.report.charts import Ink, draw_convergence, draw_histograms, draw_profile, new_figure
from voldetail.report.facts import facts, overlay_words
from voldetail.report.pictures import dimmed, encoded
from voldetail.report.verdict import verdict
from voldetail.results import FitResult, Gallery
from voldetail.setup.light import angles_of

# Inches.
WIDTH, MARGIN, GAP = 14.0, 0.55, 0.2
HEADER = 1.75
MAIN, SHORTEST_MAIN = 4.95, 2.2
SIDE = WIDTH - 2 * MARGIN - 2 * MAIN - 2 * GAP
TILE = (WIDTH - 2 * MARGIN - 3 * GAP) / 4
CAPTION, CHART, ROW = 0.42, 2.3, 0.215
DPI = 100
INK = Ink()
PAPER, QUIET = "#fbfaf8", "#5a6068"


class _Page:
    """A figure that is filled from the top; positions in inches from the top left."""

    def __init__(self, height: float) -> None:
        self.height = height
        self.figure: Figure = new_figure(WIDTH, height, PAPER, DPI)
        self.top = 0.0

    def axes(self, left: float, width: float, height: float, down: float = 0.0) -> Axes:
        bottom = self.height - self.top - down - height
        box = (left / WIDTH, bottom / self.height, width / WIDTH, height / self.height)
        return self.figure.add_axes(box)

    def text(self, left: float, down: float, words: str, size: float = 9, **options: Any) -> None:
        y = 1 - (self.top + down) / self.height
        options = {"color": INK.text, "va": "top"} | options
        self.figure.text(left / WIDTH, y, words, fontsize=size, parse_math=False, **options)

    def picture(self, linear: NDArray[Any], left: float, width: float, height: float, caption: str, size: float = 9) -> Axes:
        """Show a picture at the top of its box, its caption below it."""
        axes = self.axes(left, width, height)
        axes.imshow(encoded(linear), interpolation="bicubic", aspect="equal")
        axes.set_anchor("NW")
        axes.set_axis_off()
        rows, columns = linear.shape[:2]
        shown = min(height, width * rows / columns)
        self.text(left, shown + 0.07, caption, size)
        return axes


def write_sheet(path: Path, result: FitResult, gallery: Gallery) -> None:
    """Write the sheet of a fit as the PNG ``path``, whole or not at all."""
    rows, columns = gallery.photo.shape[:2]
    main = max(min(MAIN, MAIN * rows / columns), SHORTEST_MAIN)
    table = describe_in_words(result.detail)
    lights = TILE * min(1.0, rows / columns)
    lower = (len(table) + 1) * ROW
    page = _Page(HEADER + main + lights + TILE + 3 * CAPTION + CHART + 1.25 + lower + 0.5)
    _header(page, result)
    _main_row(page, result, gallery, main)
    _lights(page, gallery, lights)
    _shapes(page, result, gallery)
    _diagrams(page, result, gallery)
    _table(page, table)
    buffer = BytesIO()
    page.figure.savefig(buffer, format="png", dpi=DPI, metadata={"Software": "voldetail"})
    write_bytes(path, buffer.getvalue())


def _header(page: _Page, result: FitResult) -> None:
    name = textwrap.shorten(result.detail.name, 70, placeholder="...")
    page.text(MARGIN, 0.4, name, 21, weight="bold")
    page.text(MARGIN, 0.9, textwrap.shorten(summary(result.detail), 175, placeholder="..."), 9.5, color=QUIET)
    sentence = verdict(result.distance, result.detail.noise_floor).sentence
    lines = textwrap.wrap(sentence + " M compares texture statistics and is 0 for the same picture.", 150)
    page.text(MARGIN, 1.17, "\n".join(lines[:3]), 10.5, linespacing=1.4)
    page.top += HEADER


def _main_row(page: _Page, result: FitResult, gallery: Gallery, height: float) -> None:
    second, third = MARGIN + MAIN + GAP, MARGIN + 2 * (MAIN + GAP)
    shown = dimmed(gallery.photo, gallery.mask)
    axes = page.picture(shown, MARGIN, MAIN, height, "Photo: the zone that was fitted", 10.5)
    direction = result.setup.light.direction
    if direction is not None:
        _arrow(axes, angles_of(direction), gallery.photo.shape[:2])
    fitted = dimmed(gallery.fitted, gallery.mask)
    page.picture(fitted, second, MAIN, height, "Fit: same scale, same light, same exposure", 10.5)
    over = gallery.overlay
    tall = min(SIDE * over.shape[0] / over.shape[1], SIDE, 0.54 * height)
    page.picture(over, third, SIDE, tall, "\n".join(textwrap.wrap(overlay_words(result.setup), 42)), 8)
    down = tall + 0.95
    if height - down > 1.0:
        draw_profile(page.axes(third + 0.5, SIDE - 0.5, height - down - 0.42, down), INK, result.detail)
    page.top += height + CAPTION


def _arrow(axes: Axes, light: tuple[float, float], shape: tuple[int, int]) -> None:
    """Draw the way the light falls: from its side of the picture inwards, the longer the lower it stands."""
    rows, columns = shape
    towards = np.array([np.cos(np.radians(light[0])), -np.sin(np.radians(light[0]))])
    low = float(np.cos(np.radians(light[1])))
    if low < 0.1:
        return
    middle, reach = np.array([columns, rows]) / 2, 0.5 * min(rows, columns)
    start, end = middle + 0.93 * reach * towards, middle + (0.93 - 0.32 * low) * reach * towards
    arrow = axes.annotate(
        "",
        xy=tuple(end),
        xytext=tuple(start),
        arrowprops={"arrowstyle": "-|>", "color": "#ffd23f", "lw": 2.6},
    )
    if arrow.arrow_patch is not None:
        arrow.arrow_patch.set_path_effects([patheffects.withStroke(linewidth=4.6, foreground="#000000b0")])


def _lights(page: _Page, gallery: Gallery, height: float) -> None:
    for index, (caption, picture) in enumerate(gallery.lights[:4]):
        left = MARGIN + index * (TILE + GAP)
        page.picture(picture, left, TILE, height, caption[:1].upper() + caption[1:])
    page.top += height + CAPTION


def _shapes(page: _Page, result: FitResult, gallery: Gallery) -> None:
    others = (
        (gallery.grazing, "Seen at a grazing angle"),
        (gallery.sphere, "On a sphere"),
        (gallery.mesh, f"On another shape: {gallery.mesh_name}"),
    )
    for index, (picture, caption) in enumerate(others):
        page.picture(picture, MARGIN + index * (TILE + GAP), TILE, TILE, caption)
    left, row = MARGIN + 3 * (TILE + GAP) + 0.1, 0.0
    page.text(left, 0, "How it was found", 11, weight="bold")
    for label, text in facts(result):
        lines = textwrap.wrap(text, 44)[: 6 if label == "Medium" else 4]
        down = 0.32 + row * 0.165
        page.text(left, down, label, 7.5, weight="bold")
        page.text(left + 0.62, down, "\n".join(lines), 7.5, linespacing=1.3)
        row += len(lines) + 0.5
    page.top += TILE + CAPTION


def _diagrams(page: _Page, result: FitResult, gallery: Gallery) -> None:
    half = (WIDTH - 2 * MARGIN - 1.5) / 2
    page.top += 0.35
    draw_histograms(page.axes(MARGIN + 0.45, half, CHART), INK, gallery.photo, gallery.fitted, gallery.mask)
    draw_convergence(page.axes(WIDTH - MARGIN - half, half, CHART), INK, result)
    page.top += CHART + 0.9


def _table(page: _Page, table: list[tuple[str, str, str, str]]) -> None:
    page.text(MARGIN, 0, "The detail, parameter by parameter", 11, weight="bold")
    page.text(MARGIN + 3.4, 0.03, "One scene unit is half the photo's longest side.", 8.5, color=QUIET)
    for index, (label, value, unit, sentence) in enumerate(table, start=1):
        down = index * ROW + 0.1
        words = f"{value} {unit}".strip()
        page.text(MARGIN, down, label, 8.5)
        # The eleven numbers of the profile are many for one line.
        page.text(MARGIN + 1.5, down, words, 8.5 if len(words) < 40 else 6.5, weight="bold")
        page.text(MARGIN + 4.8, down, textwrap.shorten(sentence, 130, placeholder="..."), 8.5, color=QUIET)
