"""Fits that start from a library of reliefs: what is found is the relief in the photo, whatever the light's azimuth."""

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from voldetail.cli import main
from voldetail.detail import Detail, load_detail
from voldetail.errors import InputError
from voldetail.fit import fit
from voldetail.fit.session import State
from voldetail.fit.state_file import load_state
from voldetail.fit.target import load_photo_of, make_target
from voldetail.fit.warmstart import ReliefSource, starts_from
from voldetail.fit.warmstart.choose import takes_starts
from voldetail.fit.warmstart.light import direction_at_zone
from voldetail.fit.warmstart.nearest import nearest_reliefs
from voldetail.fit.warmstart.reliefs import FINE, SPACE, library_relief
from voldetail.fit.warmstart.start import Start
from voldetail.image import Photo, save_png
from voldetail.library.building.build import build as build_library
from voldetail.library.store import Library, open_library
from voldetail.render.build import build
from voldetail.render.unit_components import components
from voldetail.results import Target
from voldetail.setup.file import setup_from
from voldetail.setup.light import lamp_of
from voldetail.setup.setup import Setup
from voldetail.setup.view import view_of

RELIEFS = 48


@pytest.fixture(scope="module")
def reliefs(tmp_path_factory: pytest.TempPathFactory) -> Library:
    folder = tmp_path_factory.mktemp("reliefs") / "lib"
    return open_library(build_library([ReliefSource(50), ReliefSource(20)], [RELIEFS, 8], folder, workers=1))


def wanted(light: str, library: str = "none", **settings: object) -> Setup:
    zone = [0, 0, FINE, FINE]
    return setup_from(
        {"photo": {"path": "rendered.png", "resolution": FINE, "zone": zone}, "light": light,
         "fit": {"library": library, **settings}}, "a test",
    )  # fmt: skip


def photo_of(detail: Detail, light: str) -> Photo:
    setup = wanted(light)
    surface = build(setup, (FINE, FINE), (0, 0, FINE, FINE))
    surface.update(detail)
    parts = components(surface, lamp_of(setup.light), subsamples=2, shininess=(16.0,))
    grey = parts.luminance(0.15, 0.5, 0.0, 16.0)
    return Photo(np.repeat(np.clip(grey, 0, 1)[..., None], 3, axis=2), "0" * 64, ())


def turned(k: int, radians: float, mirrored: bool) -> Detail:
    """Relief k as it is under a light that comes from ``radians``."""
    detail = library_relief(k).detail()
    angle = -detail.noise.angle if mirrored else detail.noise.angle
    noise = detail.noise.model_copy(update={"angle": (radians + angle) % math.pi})
    return detail.model_copy(update={"noise": noise, "seed": 77})


def stretched() -> list[int]:
    """Reliefs whose direction can be seen."""
    found = []
    for k in range(RELIEFS):
        noise = library_relief(k).detail().noise
        if max(noise.anisotropy, 1 / noise.anisotropy) > 1.6 and 0.4 < noise.angle < 1.2 and noise.scale > 4:
            found.append(k)
    return found


def test_the_relief_in_a_photo_is_found_under_light_from_any_side(reliefs: Library) -> None:
    firsts, angles = [], []
    for k, azimuth, mirrored in zip(stretched(), (70, 160, 245, -20, 118, 301), (False, True) * 3, strict=False):
        light = f"{azimuth},52"
        setup = wanted(light)
        target = make_target(setup, photo_of(turned(k, math.radians(azimuth), mirrored), light))
        found, starts = nearest_reliefs(target, setup, reliefs.series["relief 50"], 4)
        firsts.append(k in [one.number for one in found])
        if found[0].number == k:
            angles.append(found[0].mirrored == mirrored)
            detail = SPACE.decode(starts[0].kind, starts[0].candidate(SPACE).vector)
            sign = -1 if found[0].mirrored else 1
            noise = library_relief(k).detail().noise
            assert detail.noise.angle == pytest.approx((math.radians(azimuth) + sign * noise.angle) % math.pi)
            assert detail.noise.scale == pytest.approx(noise.scale, rel=1e-6)
    assert len(firsts) >= 4
    assert sum(firsts) >= len(firsts) - 1
    assert len(angles) >= 3
    assert sum(angles) >= len(angles) - 1


def test_reliefs_are_the_same_bytes_in_whatever_chunks(reliefs: Library, tmp_path: Path) -> None:
    again = open_library(build_library([ReliefSource(50), ReliefSource(20)], [RELIEFS, 8], tmp_path / "lib", chunk=7))
    assert again.header.sha256 == reliefs.header.sha256


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (["relief-45"], "There are no reliefs 'relief-45'"),
        (["relief", "brick"], "either structures or reliefs"),
        (["brick", "relief-50"], "either structures or reliefs"),
    ],
)
def test_reliefs_that_there_are_none_of(
    words: list[str], sentence: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["library", "build", *words, "--entries", "8", "-o", str(tmp_path / "lib")]) == 2
    assert sentence in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == []


def test_a_near_light_is_taken_for_a_distant_one_at_the_zones_middle() -> None:
    setup = wanted("point:1,0,1")
    view = view_of(setup.camera, (FINE, FINE), (0, 0, FINE, FINE), FINE)
    assert direction_at_zone(lamp_of(setup.light), view) == pytest.approx((0.0, math.pi / 4))
    left = view_of(setup.camera, (FINE, FINE), (0, 48, FINE // 2, FINE // 2), FINE)
    azimuth, elevation = direction_at_zone(lamp_of(setup.light), left)
    assert azimuth == pytest.approx(0.0, abs=1e-9)
    assert elevation == pytest.approx(math.atan2(1, 1.5))


def test_starts_come_from_the_series_of_the_nearest_light(reliefs: Library) -> None:
    photo = photo_of(turned(4, 0.0, False), "0,25")
    for light, series in (("0,25", "relief 20"), ("0,40", "relief 50"), ("0,80", "relief 50")):
        setup = wanted(light, str(reliefs.header.path))
        target = make_target(setup, photo)
        assert starts_from(setup, target) == nearest_reliefs(target, setup, reliefs.series[series], 160)[1]
    assert starts_from(wanted("0,25"), make_target(wanted("0,25"), photo)) == ()


def test_a_mask_that_leaves_too_little_means_no_starts(reliefs: Library, tmp_path: Path) -> None:
    white = np.zeros((FINE, FINE, 3), np.float32)
    white[70:122, 70:122] = 1.0
    save_png(tmp_path / "mask.png", white)
    setup = wanted("0,50", str(reliefs.header.path)).model_copy(update={"mask": tmp_path / "mask.png"})
    assert starts_from(setup, make_target(setup, photo_of(turned(4, 0.0, False), "0,50"))) == ()


def test_what_is_no_library_of_reliefs_is_refused(reliefs: Library, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    photo = photo_of(turned(4, 0.0, False), "0,50")
    setup = wanted("0,50", str(tmp_path / "none"))
    target = make_target(setup, photo)
    with pytest.raises(InputError, match="does not exist"):
        starts_from(setup, target)
    monkeypatch.setattr("voldetail.fit.warmstart.source.PICTURES_VERSION", 2)
    with pytest.raises(InputError, match=r"out of date: its reliefs .* voldetail library build relief -o"):
        starts_from(wanted("0,50", str(reliefs.header.path)), target)


def test_a_cache_that_cannot_be_written_is_told_and_does_without(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "cache").write_text("no folder")
    monkeypatch.setenv("VOLDETAIL_CACHE", str(tmp_path / "cache"))
    setup = wanted("0,50", "auto")
    said: list[str] = []
    target = make_target(setup, photo_of(turned(4, 0.0, False), "0,50"))
    assert starts_from(setup, target, on_remark=said.append) == ()
    assert len(said) == 1
    assert "Searching without a library" in said[0]
    assert "VOLDETAIL_CACHE" in said[0]


def test_which_fits_are_told_where_to_start() -> None:
    assert takes_starts(wanted("0,50", "auto"))
    assert takes_starts(wanted("0,50", "mine.vlib", evaluations=20))
    assert not takes_starts(wanted("0,50", "auto", evaluations=20))
    assert not takes_starts(wanted("0,50", "none"))
    assert not takes_starts(wanted("0,50", "auto", metric="published"))
    assert not takes_starts(wanted("0,50", "auto", solver="paper"))


def test_a_fit_that_is_told_where_to_start_begins_there_and_goes_on_with_its_plan(
    reliefs: Library, monkeypatch: pytest.MonkeyPatch
) -> None:
    fine = next(k for k in range(RELIEFS) if library_relief(k).detail().noise.scale > 8)
    photo, light = photo_of(turned(fine, 0.6, False), f"{math.degrees(0.6)},50"), f"{math.degrees(0.6)},50"
    setup = wanted(light, str(reliefs.header.path), evaluations=30, specular=False).model_copy(update={"colour": "none"})
    started: list[State] = []
    alone: list[State] = []

    asked: list[Setup] = []

    def few(setup: Setup, target: Target, **more: Any) -> tuple[Start, ...]:
        asked.append(setup)
        return starts_from(setup, target, **more)[:8]

    monkeypatch.setattr("voldetail.fit.fitter.starts_from", few)
    result = fit(setup, photo=photo, on_state=started.append)
    without = setup.model_copy(update={"fit": setup.fit.model_copy(update={"library": "none"})})
    fit(without, photo=photo, on_state=alone.append)
    assert [state.started for state in (*started, *alone)] == [True] * len(started) + [False] * len(alone)
    assert result.detail.provenance is not None
    assert result.detail.provenance.settings["library"] == setup.fit.library
    kinds = {start.kind for start in starts_from(setup, make_target(setup, photo))[:8]}
    assert {candidate.kind for state in started for candidate in state.pool} <= kinds
    # A state that knows of no starts goes on without, whatever the setup says now.
    asked.clear()
    fit(setup, photo=photo, start=alone[-1])
    assert not asked
    fit(setup, photo=photo, start=started[-1])
    assert len(asked) == 1


def test_the_command_starts_from_a_library_and_says_so(reliefs: Library, tmp_path: Path) -> None:
    grey: NDArray[np.float32] = photo_of(turned(6, 0.0, False), "0,50").pixels
    save_png(tmp_path / "relief.png", grey)
    words = ["fit", str(tmp_path / "relief.png"), "--light", "0,50", "--resolution", "64", "--colour", "none",
             "--library", str(reliefs.header.path), "-o", str(tmp_path / "out")]  # fmt: skip
    assert main([*words, "--evaluations", "12"]) == 0
    detail = load_detail(tmp_path / "out" / "detail.json")
    assert detail.provenance is not None
    assert detail.provenance.settings["library"] == str(reliefs.header.path)
    setup = setup_from(
        {"photo": {"path": str(tmp_path / "relief.png"), "resolution": 64}, "light": "0,50", "colour": "none",
         "fit": {"library": str(reliefs.header.path)}}, "a test",
    )  # fmt: skip
    assert load_state(tmp_path / "out" / "state.json", setup, load_photo_of(setup).sha256).started
