"""The report's page and sheet, made from records alone: whole, self-contained, and true to the numbers."""

import re
import subprocess
import sys
import xml.etree.ElementTree as ET
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from PIL import Image

from voldetail.detail import Detail, NoiseFloor
from voldetail.image import Photo
from voldetail.report import write_report
from voldetail.report.facts import amplitude_words, duration, facts, light_words, medium_words
from voldetail.report.page import page
from voldetail.results import AmplitudeInterval, ColourChoice, FitResult, Gallery, Identifiability
from voldetail.setup.file import setup_from
from voldetail.setup.light import parse_light


def picture(rows: int, columns: int, level: float = 0.3) -> Any:
    waves = np.sin(np.arange(rows)[:, None] / 3) * np.cos(np.arange(columns)[None] / 4)
    return np.repeat((level * (1.2 + waves))[..., None], 3, axis=2).astype(np.float32)


def result(rows: int = 48, columns: int = 64, **changes: Any) -> FitResult:
    pixels = picture(rows, columns)
    # Only what a report reads of it.
    target: Any = SimpleNamespace(
        photo=Photo(pixels, "ab" * 32, ("rotated by EXIF",)),
        mask=np.ones((rows, columns), bool),
        shape=(480, 640),
        zone=(10, 20, 128, 96),
        unevenness=0.62,
    )
    made = FitResult(
        detail=Detail(name="wall", noise_floor=NoiseFloor(other_seed=1.25, photo_halves=1.5)),
        setup=setup_from({"photo": {"path": "wall.jpg"}, "light": "135,45"}),
        target=target,
        picture=pixels[..., 0],
        covered=np.ones_like(pixels[..., 0]),
        background=(0.0, 0.0, 0.0),
        distance=2.25,
        evaluations=800,
        seconds=40.0,
        status="the plan was carried out",
        trace=((300, 9.0), (500, 4.0), (800, 2.2)),
        interrupted=False,
    )
    return replace(made, **changes)


def gallery(rows: int = 48, columns: int = 64) -> Gallery:
    shown = picture(rows, columns)
    lights = tuple((f"light from side {i}", shown * (0.5 + 0.2 * i)) for i in range(4))
    square = picture(40, 40)
    return Gallery(
        photo=shown,
        mask=np.ones((rows, columns), bool),
        overlay=picture(60, 80),
        fitted=shown * 0.9,
        lights=lights,
        grazing=square,
        sphere=square,
        mesh=square,
        mesh_name="bunny",
    )


class _Links(HTMLParser):
    def __init__(self) -> None:
        super().__init__()
        self.sources: list[str] = []
        self.ids: list[str] = []
        self.open: list[str] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        for name, value in attrs:
            if name in ("src", "srcset", "data", "action", "poster") or (name == "href" and tag == "link"):
                self.sources.append(value or "")
            if name == "id":
                self.ids.append(value or "")
        if tag not in ("meta", "img", "br", "link"):
            self.open.append(tag)

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag


def test_the_page_needs_nothing_else() -> None:
    text = page(result(), gallery())
    links = _Links()
    links.feed(text)
    assert not links.open  # every element is closed
    assert len(links.sources) == 10  # photo, fit, overlay, four lights, three shapes
    assert all(source.startswith("data:image/png;base64,") for source in links.sources)
    assert len(links.ids) == len(set(links.ids))
    assert not re.search(r"url\((?!#)|@import|<script|<link", text)
    assert "$" not in re.sub(r"base64,[^\"]*", "", text)  # no placeholder was left


def test_the_diagrams_are_drawings_in_the_colours_of_the_page() -> None:
    drawings = re.findall(r"<svg.*?</svg>", page(result(), gallery()), re.DOTALL)
    assert len(drawings) == 3
    for drawing in drawings:
        ET.fromstring(drawing)
        assert "currentColor" in drawing
        assert "#010203" not in drawing
        used = set(re.findall(r"(?:url\(#|xlink:href=\"#)([^)\"]+)", drawing))
        assert used <= set(re.findall(r' id="([^"]+)"', drawing))


def test_the_page_tells_the_numbers() -> None:
    text = page(result(), gallery())
    for words in ("M = 2.25", "1.5 times", "0.05", "scene units", "800 pictures compared in 40 s", "bunny",
                  "from the upper left (azimuth 135 degrees), 45 degrees", "rotated by EXIF"):  # fmt: skip
        assert words in text, words


def test_what_comes_from_outside_is_escaped() -> None:
    detail = Detail(name="<script>alert(1)</script>")
    shown = replace(gallery(), mesh_name='"><img src=x>')
    text = page(result(detail=detail, status="a <b> & c"), shown)
    assert "<script" not in text
    assert "<img src=x" not in text
    assert "a &lt;b&gt; &amp; c" in text


@pytest.mark.parametrize(("rows", "columns"), [(48, 64), (64, 32), (12, 96)])
def test_both_files_are_written(tmp_path: Path, rows: int, columns: int) -> None:
    paths = write_report(tmp_path, result(rows, columns), gallery(rows, columns))
    assert sorted(p.name for p in tmp_path.iterdir()) == ["report.html", "sheet.png"]
    assert {p.name for p in paths} == {"report.html", "sheet.png"}
    with Image.open(tmp_path / "sheet.png") as sheet:
        pixels = np.asarray(sheet.convert("L"))
    assert pixels.shape[1] == 1400
    # Content from top to bottom, and a clean margin: nothing is cut off at the sides.
    dark = pixels < 128
    assert dark[: pixels.shape[0] // 10].any()
    assert dark[-pixels.shape[0] // 10 :].any()
    assert not dark[:, :20].any()
    assert not dark[:, -20:].any()


def test_a_fit_that_never_reached_full_resolution_has_a_report(tmp_path: Path) -> None:
    odd = result(trace=(), detail=Detail(), distance=1e3, evaluations=1, seconds=0.0, interrupted=True)
    write_report(tmp_path, odd, gallery())
    assert (tmp_path / "sheet.png").stat().st_size > 10_000


def test_formulas_in_names_are_plain_text(tmp_path: Path) -> None:
    write_report(tmp_path, result(detail=Detail(name=r"a $\frac{ b $ c _ ^ \x")), gallery())
    assert r"a $\frac{ b $ c" in (tmp_path / "report.html").read_text(encoding="utf-8")


def test_what_the_mask_leaves_out_is_dark(tmp_path: Path) -> None:
    from voldetail.report.pictures import DIMMED, dimmed

    mask = np.zeros((4, 4), bool)
    mask[:2] = True
    shown = dimmed(np.ones((4, 4, 3), np.float32), mask)
    assert shown[:2].min() == 1
    assert shown[2:].max() == pytest.approx(DIMMED)


def test_nothing_half_written(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from voldetail.report import write

    def fail(*_: object) -> None:
        raise RuntimeError("in the middle")

    monkeypatch.setattr(write, "write_sheet", fail)
    with pytest.raises(RuntimeError):
        write_report(tmp_path, result(), gallery())
    assert [p.name for p in tmp_path.iterdir()] == ["report.html"]


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("0,30", "from the right (azimuth 0 degrees), 30 degrees above the picture"),
        ("-90,30", "from below (azimuth 270 degrees), 30 degrees above the picture"),
        ("200,30", "from the left (azimuth 200 degrees), 30 degrees above the picture"),
        ("340,30", "from the right (azimuth 340 degrees), 30 degrees above the picture"),
        ("10,85", "from the viewer's side, 85 degrees above the picture"),
        (
            "flash@0.25,0.5,1.5",
            "a flash 1.5 photo widths in front of it, nearest 25 % from the left and 50 % from the top",
        ),
        ("point:1,2,3", "a lamp at 1, 2, 3 scene units (right, up, to the viewer)"),
    ],
)  # fmt: skip
def test_lights_in_words(text: str, words: str) -> None:
    assert light_words(parse_light(text)) == words


@pytest.mark.parametrize(
    ("seconds", "words"),
    [(0, "0 s"), (59.4, "59 s"), (59.6, "1 min 00 s"), (185, "3 min 05 s"), (3720, "1 h 02 min")],
)
def test_durations(seconds: float, words: str) -> None:
    assert duration(seconds) == words


def test_a_report_starts_no_renderer() -> None:
    code = "import sys, voldetail.report; sys.exit(bool({'mitsuba', 'matplotlib.pyplot'} & set(sys.modules)))"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


@pytest.mark.parametrize(
    ("ends", "wanted"),
    [
        ((0.04, 0.06, 0.04, 0.06), "0.05 scene units; 0.04 to 0.06 would be about as near"),
        ((0.04, 0.06, 0.03, 0.2), "0.04 to 0.06 would be about as near, 0.03 to 0.2 or more if the light were up to"),
        ((0.0125, 0.06, 0.0125, 0.06), "0.0125 or less to 0.06"),
    ],
)
def test_the_amplitude_is_told_with_its_interval(ends: tuple[float, ...], wanted: str) -> None:
    looked = ((0.0125, 0.05, 0.2), (2.0, 1.0, 3.0), (2.0, 1.0, 3.0))
    assert wanted in amplitude_words(result(heights=AmplitudeInterval(*ends, *looked)))


def test_an_amplitude_without_an_interval_says_why() -> None:
    assert "not looked at" in amplitude_words(result())
    given = setup_from({"photo": {"path": "wall.jpg"}, "light": "135,45", "amplitude": 0.05})
    assert amplitude_words(result(setup=given)) == "0.05 scene units, as given"


def test_a_medium_is_told_number_by_number() -> None:
    told = (
        Identifiability("medium.extinction", 12.0, 8.0, 48.0, 3.0, 48.0),
        Identifiability("medium.thickness", 0.2, 0.1, 0.3, 0.05, 0.8),
        Identifiability("medium.albedo", 0.99, 0.2, 1.0, 0.2, 1.0),
    )
    words = medium_words(result(identifiability=told))
    assert words == (
        "extinction 12 (8 to 48 or more), shell thickness 0.2 (0.1 to 0.3); the photo does not tell scattering albedo"
    )
    assert dict(facts(result(identifiability=told)))["Medium"] == words
    assert "Amplitude" not in dict(facts(result(identifiability=told)))
    assert medium_words(result(identifiability=told[2:])) == "none of its numbers is told"


def test_colour_and_evenness_are_told() -> None:
    told = dict(facts(result()))
    assert told["Evenness"] == "unevenness 0.62 (0 is even, up to 0.45 even enough)"
    assert "Colour" not in told
    choice = ColourChoice(Detail(), "none", {"none": 1.5, "noise": 1.75}, picture(4, 4))
    assert dict(facts(result(colour=choice)))["Colour"] == "one tint; distances of colours: one tint 1.5, by example 1.75"
    even = setup_from({"photo": {"path": "wall.jpg", "stationarize": True}, "light": "135,45"})
    assert dict(facts(result(setup=even)))["Evenness"].endswith("an even picture was made of it and fitted")
