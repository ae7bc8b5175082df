"""The report as one HTML page that needs nothing but itself: pictures and diagrams are inside."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from html import escape
from importlib.resources import files
from io import StringIO
from pathlib import Path
from string import Template
from typing import Any

import matplotlib as mpl
from matplotlib.axes import Axes
from numpy.typing import NDArray

from voldetail.detail import describe_in_words, summary
from voldetail.files import write_text
from voldetail.report.charts import Ink, draw_convergence, draw_histograms, draw_profile, new_figure
from voldetail.report.facts import facts, light_words, overlay_words
from voldetail.report.pictures import data_uri, dimmed
from voldetail.report.verdict import verdict
from voldetail.results import FitResult, Gallery

# Stand-ins that the page's own colour replaces, so that the diagrams follow a light or dark page.
_TEXT, _FAINT = "#010203", "#010204"
_INK = Ink(text=_TEXT, faint=_FAINT)


def write_page(path: Path, result: FitResult, gallery: Gallery) -> None:
    """Write the page of a fit to ``path``, whole or not at all."""
    write_text(path, page(result, gallery))


def page(result: FitResult, gallery: Gallery) -> str:
    """The text of the page; everything that comes from a user is escaped."""
    detail = result.detail
    judged = verdict(result.distance, detail.noise_floor)
    photo, fitted = dimmed(gallery.photo, gallery.mask), dimmed(gallery.fitted, gallery.mask)
    light = light_words(result.setup.light)
    parts = {
        "name": escape(detail.name),
        "version": escape(detail.provenance.voldetail if detail.provenance else ""),
        "summary": escape(summary(detail)),
        "verdict": f"<b>{escape(_heading(judged.word))}</b> {escape(judged.sentence)}",
        "pair": figure(photo, "Photo: the zone that was fitted") + figure(fitted, "Fit: same scale, same light, same exposure"),
        "overlay": figure(gallery.overlay, f"{overlay_words(result.setup)}. Light: {light}."),
        "facts": rows([(label, text) for label, text in facts(result)]),
        "lights": "".join(figure(p, caption[:1].upper() + caption[1:]) for caption, p in gallery.lights),
        "shapes": figure(gallery.grazing, "Seen at a grazing angle")
        + figure(gallery.sphere, "On a sphere")
        + figure(gallery.mesh, f"On another shape: {gallery.mesh_name}"),
        "charts": "".join(
            f"<figure>{chart}</figure>"
            for chart in (
                _svg(
                    "histograms",
                    lambda a: draw_histograms(a, _INK, gallery.photo, gallery.fitted, gallery.mask),
                ),
                _svg("search", lambda a: draw_convergence(a, _INK, result)),
                _svg("profile", lambda a: draw_profile(a, _INK, detail)),
            )
        ),
        "parameters": "".join(
            f'<tr><th>{escape(label)}</th><td class="value">{escape(value)}</td>'
            f'<td class="unit">{escape(unit)}</td><td>{escape(sentence)}</td></tr>\n'
            for label, value, unit, sentence in describe_in_words(detail)
        ),
        "footer": escape(_footer(result)),
    }
    return filled("page.html", parts)


def filled(template: str, parts: Mapping[str, str]) -> str:
    """Return the text of a template of this package with its ``parts`` and the pages' style put in."""
    folder = files("voldetail.report")
    style = folder.joinpath("page.css").read_text(encoding="utf-8")
    return Template(folder.joinpath(template).read_text(encoding="utf-8")).substitute(parts, style=style)


def _heading(word: str) -> str:
    return word[:1].upper() + word[1:] + "."


def figure(picture: NDArray[Any], caption: str) -> str:
    """Return a linear picture with its caption."""
    high, wide = picture.shape[:2]
    text = escape(caption)
    return (
        f'<figure><img src="{data_uri(picture)}" width="{wide}" height="{high}" alt="{text}">'
        f"<figcaption>{text}</figcaption></figure>\n"
    )


def rows(pairs: list[tuple[str, str]]) -> str:
    """Return the rows of a table of labels and texts."""
    return "".join(f"<tr><th>{escape(label)}</th><td>{escape(text)}</td></tr>\n" for label, text in pairs)


def _svg(name: str, draw: Callable[[Axes], None]) -> str:
    """A diagram as inline SVG in the page's own colours."""
    # With a salt of their own the names inside the drawing are the same in every run.
    with mpl.rc_context({"svg.hashsalt": name, "svg.fonttype": "path"}):
        drawing = new_figure(5.6, 3.3)
        draw(drawing.add_axes((0.13, 0.17, 0.84, 0.7)))
        buffer = StringIO()
        drawing.savefig(buffer, format="svg", transparent=True, metadata={"Date": None, "Creator": None})
    text = buffer.getvalue()
    text = text[text.index("<svg") :]
    text = text.replace(_TEXT, "currentColor").replace(_FAINT, "var(--faint)")
    # Names must be unique on a page, and the diagrams share those of letters and axes.
    return re.sub(r'( id="|url\(#|href="#)', rf"\g<1>{name}-", text)


def _footer(result: FitResult) -> str:
    provenance = result.detail.provenance
    if provenance is None:
        return "Made by voldetail."
    return (
        f"Made by voldetail {provenance.voldetail} on {provenance.created} with Mitsuba "
        f"{provenance.mitsuba}, Dr.Jit {provenance.drjit} and NumPy {provenance.numpy}. "
        f"SHA-256 of the photo: {provenance.photo_sha256 or 'unknown'}."
    )
