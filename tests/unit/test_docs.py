"""What the documentation site writes from the code is complete and right: no command, record or equation is missing."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

import pytest

from from_code import bibliography, commands, diagram, interface, kinds, papers, records, rooms
from voldetail import __version__, api
from voldetail.detail import PARAMETERS
from voldetail.export import suffixes
from voldetail.metric import METRICS
from voldetail.setup.lights.table import LIGHTS
from voldetail.setup.shapes import SHAPES

ROOT = Path(__file__).resolve().parents[2]
PAGES = {path.relative_to(ROOT).as_posix(): path.read_text(encoding="utf-8") for path in (ROOT / "docs").rglob("*.md")}


def arguments_of(directive: str) -> list[str]:
    """Arguments of a directive in all pages."""
    return [found for text in PAGES.values() for found in re.findall(rf"^```\{{{directive}\}} (.+)$", text, re.M)]


def test_each_command_has_one_place() -> None:
    assert sorted(arguments_of("command")) == sorted(commands.names())


@pytest.mark.parametrize("words", ["", *commands.names()])
def test_a_command_page_has_every_option_with_a_sentence(words: str) -> None:
    page = commands.command_page(words)
    assert page.startswith(f"```text\nvoldetail {words}".rstrip())
    lines = [line for line in page.splitlines() if line.startswith("| `")]
    assert lines or words == "schema"  # which takes nothing
    assert not [line for line in lines if line.rstrip().endswith("|  |")]


def test_bounds_and_defaults_are_those_of_the_declaration() -> None:
    page = commands.command_page("texture render")
    assert "| `--zoom` | `NUMBER` 0.001 to 1000, default `1.0` |" in page
    assert "| `--output` or `-o` | `FILE`, needed |" in page


def test_parameters_and_records_are_whole() -> None:
    page = records.parameter_page()
    assert all(f"| `{p.key.split('.')[1]}` |" in page for p in PARAMETERS)
    for path in arguments_of("record"):
        assert records.record_page(path).count("\n| `") >= 2
    assert records.layout_page().startswith("```json")


@pytest.mark.parametrize(
    ("page", "names"),
    [
        (kinds.lights_page, tuple(LIGHTS)),
        (kinds.shapes_page, tuple(SHAPES)),
        (kinds.metrics_page, METRICS),
        (kinds.formats_page, suffixes()),
    ],
)
def test_kinds_have_a_row_each_with_a_sentence(page: Callable[[], str], names: tuple[str, ...]) -> None:
    assert all(f"`{name}`" in page() for name in names)
    assert "|  |\n" not in page()


def test_every_room_says_what_it_holds() -> None:
    assert [room.name for room in rooms.rooms().values() if not room.sentence] == []


def test_the_picture_has_every_room_and_lines_downwards() -> None:
    every = rooms.rooms()
    picture = diagram.diagram()
    assert all(f">{name}<" in picture or f" {name}" in picture for name in every)
    uses = rooms.downward(every)
    assert uses == {name: set(room.uses) for name, room in every.items()}  # else a circle was cut
    for name, below in rooms.needed(uses).items():
        assert below <= every[name].uses
        assert all(rooms.height(name, uses) > rooms.height(other, uses) for other in below)
    starts = [float(y) for y in re.findall(r'<path d="M[\d.]+ ([\d.]+)', picture)]
    ends = [float(y) for y in re.findall(r' ([\d.]+)"/>', picture)]
    assert starts
    assert all(a < b for a, b in zip(starts, ends, strict=True))


def test_every_place_of_a_paper_is_cited_and_every_citation_explained() -> None:
    for short, paper in bibliography.PAPERS.items():
        said, explained = set(papers.cited()[short]), set(paper.places)
        assert said - explained == set(), f"say in docs/from_code/bibliography.py what these of {short} are"
        assert explained - said == set(), f"no module cites these of {short}: take them out of docs/from_code/bibliography.py"
    assert [work for work, modules in papers.others().items() if not modules] == []


def test_modules_of_the_equations_are_the_ones_that_compute_them() -> None:
    cited = papers.cited()
    assert "noise.relief" in cited["GD10"]["eq. 3"]
    assert "metric.filters" in cited["GD10"]["eq. 4"]
    assert "texture.power" in cited["LVLD10"]["eq. 13"]
    assert "library.compare" in cited["GKHF14"]["eq. 6"]
    assert "stationary.measure" in cited["MJHRW17"]["eq. 1"]


@pytest.mark.parametrize(
    ("before", "own", "paper"),
    [
        ("as GD10 ", "", "GD10"),
        ("weights of ", "LVLD10", "LVLD10"),
        ("(Cook and DeRose 2005, ", "LVLD10", ""),
        ("(Worley 1996) and GD10 ", "MJHRW17", "GD10"),
        ("LVLD10, 2010 article, ", "GD10", "LVLD10"),
        ("of nobody, ", "", ""),
    ],
)
def test_an_equation_belongs_to_the_last_work_before_it(before: str, own: str, paper: str) -> None:
    assert papers._paper_before(before, own) == paper


def test_lists_of_equations() -> None:
    assert papers._places("equations", "2 and 3") == ["eq. 2", "eq. 3"]
    assert papers._places("Sections", "4 to 6, and 8.2") == ["section 4", "section 5", "section 6", "section 8.2"]


def test_the_citation_has_this_version() -> None:
    assert f"\nversion: {__version__}\n" in (ROOT / "CITATION.cff").read_text(encoding="utf-8")


def test_links_of_readme_and_notices_lead_somewhere() -> None:
    for name in ("README.md", "CONTRIBUTING.md", "CHANGELOG.md", "SECURITY.md"):
        text = (ROOT / name).read_text(encoding="utf-8")
        assert [link for link in re.findall(r"\]\(([^)#:]+)\)", text) if not (ROOT / link).exists()] == []


def test_the_interface_is_whole() -> None:
    kinds = {interface.kind_of(name) for name in api.__all__}
    assert set(arguments_of("interface")) == kinds
    assert all(f"voldetail.api.{name}\n" in interface.interface_page(interface.kind_of(name)) for name in api.__all__)


def test_arrays_in_signatures_are_as_in_the_source() -> None:
    long = "(a: ~numpy.ndarray[tuple[~typing.Any, ...], ~numpy.dtype[~numpy.float32]])"
    assert interface.short_arrays(long) == "(a: NDArray[float32])"
