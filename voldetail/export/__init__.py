"""Details as files for other programs: one writer a format, found by the file's suffix."""

from voldetail.export.options import ExportOptions
from voldetail.export.registry import FORMATS, export, suffixes

__all__ = ["FORMATS", "ExportOptions", "export", "suffixes"]
