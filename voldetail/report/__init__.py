"""Pictures and pages about results: the only importer of matplotlib. Reads records and never renders."""

from voldetail.report.frames import write_animation, write_contact_sheet
from voldetail.report.verdict import Verdict, verdict
from voldetail.report.write import PAGE_NAME, SHEET_NAME, write_report

__all__ = [
    "PAGE_NAME",
    "SHEET_NAME",
    "Verdict",
    "verdict",
    "write_animation",
    "write_contact_sheet",
    "write_report",
]
