"""The report of a fit: a page and a sheet."""

from __future__ import annotations

from pathlib import Path

from voldetail.report.page import write_page
from voldetail.report.sheet import write_sheet
from voldetail.results import FitResult, Gallery

PAGE_NAME = "report.html"
SHEET_NAME = "sheet.png"


def write_report(folder: Path, result: FitResult, gallery: Gallery) -> tuple[Path, Path]:
    """Write `report.html` (nothing outside it is needed) and `sheet.png` to ``folder``; return their paths.

    Each file appears whole or not at all. Raises InputError where nothing can be written.
    """
    page, sheet = folder / PAGE_NAME, folder / SHEET_NAME
    write_page(page, result, gallery)
    write_sheet(sheet, result, gallery)
    return page, sheet
