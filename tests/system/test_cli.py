"""The command line as a whole: short fits that are stopped, killed and gone on with, and what they leave.

The pictures of the report are replaced by flat ones here, since rendering them takes longer than these fits.
"""

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

from voldetail.cli import main
from voldetail.detail import load_detail
from voldetail.fit.state_file import load_state
from voldetail.fit.target import load_photo_of
from voldetail.image import load_photo
from voldetail.image.load import load_samples
from voldetail.recover.files import load_any
from voldetail.results import Gallery
from voldetail.setup.file import load_setup

RESULTS = ["detail.json", "fit.png", "relief", "report.html", "setup.toml", "sheet.png", "state.json"]
SMALL = ["skimage:gravel", "--light", "70,50", "--zone", "160,160,96,96", "--resolution", "64"]

CHILD = """
import sys
sys.path.insert(0, {tests!r})
import test_cli, voldetail.apply
voldetail.apply.gallery = test_cli.flat_gallery
sys.exit(test_cli.main(sys.argv[1:]))
"""


def flat_gallery(result: Any, on_progress: Any = None) -> Gallery:
    grey = np.full((8, 8, 3), 0.2, np.float32)
    return Gallery(
        photo=result.target.pixels, mask=result.target.mask, overlay=grey, fitted=result.target.pixels,
        lights=(("a light", grey),), grazing=grey, sphere=grey, mesh=grey, mesh_name="cylinder",
    )  # fmt: skip


@pytest.fixture
def quick(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("voldetail.apply.gallery", flat_gallery)


@contextmanager
def child(*words: str) -> Iterator[subprocess.Popen[str]]:
    """A process of its own that runs the command; killed at the end if it is still there."""
    code = CHILD.format(tests=str(Path(__file__).parent))
    process = subprocess.Popen(
        [sys.executable, "-c", code, *words],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        # A parent in the background may have Ctrl-C ignored, and its children with it.
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
    )
    try:
        yield process
    finally:
        process.kill()
        process.communicate()


def wait_for(path: Path, process: subprocess.Popen[str], seconds: float = 60) -> None:
    end = time.monotonic() + seconds
    while not path.exists():
        assert process.poll() is None, process.communicate()
        assert time.monotonic() < end, f"{path.name} did not appear"
        time.sleep(0.02)


def check_whole(folder: Path) -> None:
    """Every file in the folder that has a name is complete."""
    for path in folder.iterdir():
        if path.name.startswith("."):
            continue  # what a killed process was writing; no reader looks at it
        if path.is_dir():
            check_whole(path)
        elif path.suffix == ".exr":
            load_samples(path, "map")
        elif path.suffix == ".json":
            json.loads(path.read_text())
        elif path.suffix == ".toml":
            load_setup(path)
        elif path.suffix == ".png":
            with Image.open(path) as picture:
                picture.load()
        else:
            assert path.read_text().rstrip().endswith("</html>")


@pytest.mark.usefixtures("quick")
def test_a_fit_from_photo_to_folder(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "deep" / "out"
    assert main(["fit", *SMALL, "--evaluations", "24", "-o", str(out)]) == 0
    shown = capsys.readouterr()
    assert sorted(p.name for p in out.iterdir()) == RESULTS
    check_whole(out)
    assert load_any(out / "relief").name == "gravel"
    assert "M = " in shown.out
    assert str(out / "report.html") in shown.out
    assert "24 pictures" in shown.err
    detail = load_detail(out / "detail.json")
    assert detail.provenance is not None
    assert detail.provenance.zone == (160, 160, 96, 96)
    with Image.open(out / "fit.png") as picture:
        assert picture.size == (64, 64)

    # The resolved setup is a scene of its own, and knows where its results are.
    setup = load_setup(out / "setup.toml")
    assert setup.output == out
    assert load_state(out / "state.json", setup, load_photo_of(setup).sha256).evaluations > 0

    before = (out / "detail.json").read_bytes()
    assert main(["fit", str(out / "setup.toml")]) == 2
    assert "--resume" in capsys.readouterr().err
    assert (out / "detail.json").read_bytes() == before
    assert main(["fit", str(out / "setup.toml"), "--resume", "--light", "71,50"]) == 2
    assert "light.direction" in capsys.readouterr().err
    assert main(["fit", str(out / "setup.toml"), "--resume"]) == 0
    assert load_detail(out / "detail.json").noise == detail.noise

    (out / ".voldetail-0123.png").write_bytes(b"half")
    (out / "notes.txt").write_text("mine")
    assert main(["fit", str(out / "setup.toml"), "--force", "--seed", "1"]) == 0
    assert sorted(p.name for p in out.iterdir()) == sorted([*RESULTS, "notes.txt"])


@pytest.mark.parametrize(
    "words",
    [
        ["--zone", "480,480,64,64"],
        ["--mask", "none.png"],
        ["--metric", "l2"],
        ["--proxy", "none.obj"],
        ["-D", "fit.sedes=3"],
        ["--resume"],
    ],
)
def test_bad_input_leaves_no_folder(words: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "out"
    assert main(["fit", "skimage:gravel", "--light", "70,50", "-o", str(out), *words]) == 2
    assert capsys.readouterr().err.count("\n") == 1
    assert not out.exists()


def test_ctrl_c_keeps_the_best_so_far(tmp_path: Path) -> None:
    out = tmp_path / "out"
    with child("fit", *SMALL, "--evaluations", "4000", "--library", "none", "-o", str(out)) as process:
        wait_for(out / "state.json", process)
        time.sleep(0.5)
        process.send_signal(signal.SIGINT)
        said, remarks = process.communicate(timeout=60)
    assert process.returncode == 0, remarks
    assert "Stopped by you" in said
    assert "Traceback" not in remarks
    assert sorted(p.name for p in out.iterdir()) == RESULTS
    check_whole(out)
    assert 0 < load_detail(out / "detail.json").provenance.evaluations < 4000  # type: ignore[union-attr]


def test_killed_at_any_moment_and_gone_on_with(tmp_path: Path) -> None:
    out = tmp_path / "out"
    words = ["fit", *SMALL, "--evaluations", "60", "-o", str(out)]
    for number, delay in enumerate((0.0, 0.4, 1.1)):
        with child(*words, *(["--resume"] if number else [])) as process:
            wait_for(out / ("setup.toml" if number == 0 else "state.json"), process)
            time.sleep(delay)
            os.kill(process.pid, signal.SIGKILL)
            process.wait()
        check_whole(out)
    with child(*words, "--resume") as process:
        said, remarks = process.communicate(timeout=120)
    assert process.returncode == 0, remarks
    assert "M = " in said
    assert sorted(p.name for p in out.iterdir()) == RESULTS
    check_whole(out)


@pytest.mark.usefixtures("quick")
def test_ctrl_c_while_the_report_is_made(tmp_path: Path, monkeypatch: pytest.MonkeyPatch,
                                         capsys: pytest.CaptureFixture[str]) -> None:  # fmt: skip
    def stop(*_: object, **__: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("voldetail.report.write_report", stop)
    assert main(["fit", *SMALL, "--evaluations", "24", "-o", str(tmp_path / "out")]) == 130
    assert "detail.json is" in capsys.readouterr().err
    load_detail(tmp_path / "out" / "detail.json")


@pytest.fixture(scope="module")
def detail(tmp_path_factory: pytest.TempPathFactory) -> Path:
    from voldetail.detail import Detail, save_detail

    path = tmp_path_factory.mktemp("detail") / "detail.json"
    save_detail(path, Detail(name="lumps"))
    return path


@pytest.mark.parametrize("name", ["out.png", "out.exr"])
def test_render(name: str, detail: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / name
    assert main(["render", str(detail), "sphere", "--size", "80x64", "--light", "135,45", "-o", str(out)]) == 0
    assert "80 x 64" in capsys.readouterr().out
    pixels = load_photo(out).pixels
    assert pixels.shape == (64, 80, 3)
    # Lit from the upper left, and black around the sphere.
    assert pixels[16:32, 24:40].mean() > 1.5 * pixels[32:48, 40:56].mean()
    assert pixels[:3, :3].max() == 0


def test_relight(detail: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "frames"
    words = [
        "relight",
        str(detail),
        "--azimuth",
        "0:360:3",
        "--elevation",
        "20,60",
        "--size",
        "48x32",
        "-o",
        str(out),
    ]
    assert main(words) == 0
    assert "6 frames" in capsys.readouterr().out
    frames = sorted(p.name for p in out.glob("frame-*"))
    assert frames[0] == "frame-000-az0-el20.png"
    assert frames[-1] == "frame-005-az240-el60.png"
    assert len(frames) == 6
    with Image.open(out / "animation.gif") as moving:
        assert moving.n_frames == 6
        assert moving.size == (48, 32)
    assert (out / "sheet.png").exists()
    low, high = (load_photo(out / name).pixels.mean() for name in (frames[0], frames[-1]))
    assert high > low  # a higher light is brighter on a plane that faces the viewer

    assert main(words) == 2
    assert "--force" in capsys.readouterr().err
    assert main([*words[:3], "0,90", *words[4:], "--force", "--animation", "none"]) == 0
    assert len(list(out.glob("frame-*"))) == 4
    assert not (out / "animation.gif").exists()


@pytest.mark.usefixtures("quick")
def test_a_light_that_is_estimated(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder = tmp_path / "out"
    words = ["fit", "skimage:brick", "--light", "auto", "--zone", "128,128,256,256", "--resolution", "64"]
    words += ["--solver", "paper", "-o", str(folder)]
    assert main([*words, "--evaluations", "5"]) == 0
    assert "Light estimated: azimuth" in capsys.readouterr().out
    detail, light = load_detail(folder / "detail.json"), load_setup(folder / "setup.toml").light
    assert detail.provenance is not None
    assert light.direction is not None
    estimated = detail.provenance.settings["light_estimated"]
    assert isinstance(estimated, dict)
    assert [float(v) for v in detail.provenance.light.split(",")] == pytest.approx([estimated["azimuth"], estimated["elevation"]])
    # The same photo gives the same light, so the state still belongs to it.
    assert main([*words, "--evaluations", "8", "--resume"]) == 0
    assert load_setup(folder / "setup.toml").light == light


def test_a_light_that_cannot_be_told(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    Image.new("RGB", (96, 96), (120, 120, 120)).save(tmp_path / "grey.png")
    folder = tmp_path / "out"
    assert main(["fit", str(tmp_path / "grey.png"), "--light", "auto", "-o", str(folder)]) == 2
    shown = capsys.readouterr()
    assert "cannot be told from its gradients" in shown.err
    assert shown.err.count("\n") == 1
    assert not folder.exists()
