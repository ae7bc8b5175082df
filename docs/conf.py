"""Sphinx's settings: furo's theme, pages in Markdown, a gallery of executed examples, and what is written from the code."""

from __future__ import annotations

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))

from voldetail import __version__

project = "voldetail"
author = "The voldetail developers"
copyright = "2026, The voldetail developers"
version = release = __version__
language = "en-GB"

extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.napoleon", "sphinx_gallery.gen_gallery", "from_code.directives"]
exclude_patterns = ["build", "from_code", "examples", "gallery/*.md5", "**/*.zip"]
suppress_warnings = ["config.cache"]  # the gallery's settings hold a class, which cannot be pickled
smartquotes = False  # an option such as --light has two hyphens

html_theme = "furo"
html_title = "voldetail"
html_show_sphinx = False
html_static_path = ["_static"]
html_css_files = ["wide.css"]
html_copy_source = False

myst_enable_extensions = ["colon_fence", "deflist"]
myst_heading_anchors = 3

autodoc_typehints = "signature"
autodoc_preserve_defaults = True
autodoc_typehints_format = "short"
python_maximum_signature_line_length = 100
autodoc_member_order = "bysource"
nitpicky = False

sphinx_gallery_conf = {
    "examples_dirs": "examples",
    "gallery_dirs": "gallery",
    "filename_pattern": r"\.py$",
    "within_subsection_order": "FileNameSortKey",
    "remove_config_comments": True,
    "download_all_examples": False,
    "show_signature": False,
    "show_memory": False,
    "min_reported_time": 1,
    "image_srcset": [],
    "thumbnail_size": (320, 224),
    "abort_on_example_error": True,
}
