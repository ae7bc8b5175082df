"""The page about a photo's own relief, and the same on one picture."""

from __future__ import annotations

from html import escape
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from voldetail.detail.photo_relief import MappedDetail
from voldetail.files import write_text
from voldetail.report.facts import duration
from voldetail.report.frames import write_contact_sheet
from voldetail.report.page import figure, filled, rows
from voldetail.report.write import PAGE_NAME, SHEET_NAME
from voldetail.results.relief_gallery import ReliefGallery

SURE, UNSURE = 0.6, 0.25
"""Confidence from which relief is called plain, and below which faint."""


def write_relief_report(folder: Path, detail: MappedDetail, gallery: ReliefGallery) -> tuple[Path, Path]:
    """Write `report.html` and `sheet.png` about ``detail`` to ``folder``; return their paths."""
    page, sheet = folder / PAGE_NAME, folder / SHEET_NAME
    write_text(page, relief_page(detail, gallery))
    frames = [
        ("the photo", gallery.photo), ("its relief under its light", gallery.again), ("height", gallery.height),
        ("normals", gallery.normal), ("albedo", gallery.albedo), *gallery.lights, *gallery.shapes,
        *([("the tile, 2 x 2", gallery.tile)] if gallery.tile is not None else []),
    ]  # fmt: skip
    shape = gallery.photo.shape[0], gallery.photo.shape[1]
    framed = [(caption[:1].lower() + caption[1:], _framed(picture, shape)) for caption, picture in frames]
    write_contact_sheet(sheet, framed, f"{detail.name}: the photo's own relief")
    return page, sheet


def relief_page(detail: MappedDetail, gallery: ReliefGallery) -> str:
    """The text of the page; everything that comes from a user is escaped."""
    record, r = detail.record, detail.reflectance
    made = record.provenance
    tile = (
        ""
        if gallery.tile is None
        else f'<h2>The tile, 2 x 2</h2>\n<section class="tiles">{figure(gallery.tile, "Repeated")}</section>\n'
    )
    facts = [
        ("Maps", f"{record.columns} x {record.rows} pixels, {record.texels_per_unit:.4g} a scene unit"),
        ("Light", record.light),
        ("Amplitude", f"{record.relief.amplitude:.3g} scene units from the lowest point to the highest"),
        ("Reflectance", f"Ka {r.ambient:.3g}, Kd {r.diffuse:.3g}, Ks {r.specular:.3g}, N {r.shininess:.3g}"),
        ("Confidence", f"{record.confidence:.2f}"),
        *([("Made", f"{made.created} by voldetail {made.voldetail} in {duration(made.seconds)}")] if made else []),
        *([("Difference", f"{100 * made.distance:.1f} % of the photo's mean, of the maps under its light")] if made else []),
    ]
    return filled(
        "relief.html",
        {
            "name": escape(detail.name),
            "version": escape(made.voldetail if made else ""),
            "summary": "The photo's own relief: height, normals, albedo and roughness of every pixel.",
            "verdict": f"<b>{_word(record.confidence)}</b> {escape(' '.join(record.notes))}",
            "pair": figure(gallery.photo, "Photo") + figure(gallery.again, "Its relief and albedo, rendered under its light"),
            "maps": figure(gallery.height, "Height, white is high")
            + figure(gallery.normal, "Normals, y up")
            + figure(gallery.albedo, "Albedo"),
            "lights": "".join(figure(picture, caption) for caption, picture in gallery.lights),
            "shapes": "".join(figure(picture, caption) for caption, picture in gallery.shapes),
            "tile": tile,
            "facts": rows(facts),
            "footer": escape(f"SHA-256 of the photo: {made.photo_sha256}." if made and made.photo_sha256 else "voldetail"),
        },
    )


def _word(confidence: float) -> str:
    if confidence >= SURE:
        return "Relief is plain to see."
    return "Relief is seen." if confidence >= UNSURE else "Relief is faint."


def _framed(picture: NDArray[np.float32], shape: tuple[int, int]) -> NDArray[np.float32]:
    """Return ``picture`` in the middle of a frame of ``shape``, as large as it fits."""
    from voldetail.image import resize

    rows_, columns = shape
    factor = min(rows_ / picture.shape[0], columns / picture.shape[1])
    size = max(1, round(picture.shape[0] * factor)), max(1, round(picture.shape[1] * factor))
    frame = np.ones((rows_, columns, 3), np.float32)
    top, left = (rows_ - size[0]) // 2, (columns - size[1]) // 2
    frame[top : top + size[0], left : left + size[1]] = resize(picture, size)
    return frame
