"""The directives that put what is written from the code into a page."""

from __future__ import annotations

from typing import Any, ClassVar

from docutils import nodes
from docutils.statemachine import StringList
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective

from from_code.commands import command_page
from from_code.diagram import diagram
from from_code.interface import interface_page, short_arrays
from from_code.kinds import formats_page, lights_page, metrics_page, shapes_page
from from_code.papers import other_papers_page, papers_page
from from_code.records import layout_page, parameter_page, record_page
from from_code.rooms import rooms_page


class Written(SphinxDirective):
    """A directive whose content is Markdown that a function returns for the directive's argument."""

    optional_arguments = 1
    final_argument_whitespace = True
    makers: ClassVar[dict[str, Any]] = {
        "command": command_page,
        "record": record_page,
        "parameters": lambda _: parameter_page(),
        "detail-layout": lambda _: layout_page(),
        "rooms": lambda _: rooms_page(),
        "interface": interface_page,
        "formats": lambda _: formats_page(),
        "lights": lambda _: lights_page(),
        "shapes": lambda _: shapes_page(),
        "metrics": lambda _: metrics_page(),
        "papers": papers_page,
        "other-papers": lambda _: other_papers_page(),
    }

    def run(self) -> list[nodes.Node]:
        text = self.makers[self.name](self.arguments[0] if self.arguments else "")
        box = nodes.container()
        self.state.nested_parse(StringList(text.split("\n"), f"<{self.name}>"), self.content_offset, box)
        return box.children


class Diagram(SphinxDirective):
    """The picture of the rooms."""

    def run(self) -> list[nodes.Node]:
        return [nodes.raw("", diagram(), format="html")]


def _readable(app: Sphinx, what: str, name: str, found: Any, options: Any, signature: str, returned: str) -> tuple[Any, Any]:
    return signature and short_arrays(signature), returned and short_arrays(returned)


def setup(app: Sphinx) -> dict[str, bool]:
    """Make the directives known to Sphinx."""
    for name in Written.makers:
        app.add_directive(name, Written)
    app.add_directive("rooms-diagram", Diagram)
    app.connect("autodoc-process-signature", _readable)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
