"""The setup file: reading with overrides, writing the resolved one, and refusals in one sentence."""

import math
from pathlib import Path

import pytest

from voldetail.errors import InputError
from voldetail.records.reading import LARGEST_FILE
from voldetail.setup.camera import CameraSetup
from voldetail.setup.file import (
    load_setup,
    setup_from,
    setup_from_text,
    setup_to_toml,
)
from voldetail.setup.light import parse_light
from voldetail.setup.proxy import ProxySetup
from voldetail.setup.shapes import SHAPES

SMALL = """
light = "70,50"
[photo]
path = "wall.jpg"
"""
SCENES = Path(__file__).resolve().parents[2] / "scenes"


def test_defaults() -> None:
    setup = setup_from_text(SMALL)
    assert (setup.photo.encoding, setup.photo.zone, setup.photo.resolution) == ("auto", None, 192)
    assert (setup.proxy.kind, setup.proxy.extent) == ("plane", (2, 2, 0))
    assert (setup.camera.kind, setup.camera.field_of_view) == ("orthographic", 40)
    assert (setup.fit.solver, setup.fit.metric, setup.fit.seeds, setup.fit.specular) == (
        "default",
        "combined",
        2,
        True,
    )
    assert (setup.mask, setup.amplitude, setup.domain, setup.seed, setup.output) == (
        None,
        None,
        "solid",
        0,
        None,
    )
    assert setup.light == parse_light("70,50")


def test_every_setting_can_be_given(tmp_path: Path) -> None:
    path = tmp_path / "all.toml"
    path.write_text(
        """
        mask = "mask.png"
        amplitude = 0.1
        domain = "surface"
        seed = 7
        output = "out"
        photo = {path = "photos/wall.jpg", encoding = "srgb", zone = [1, 2, 300, 400], resolution = 128}
        proxy = {kind = "mesh", mesh = "rock.ply", size = [1, 2, 3], rotation = [0, 90, 0]}
        camera = {kind = "perspective", field_of_view = 60, distance = 3}
        light = {kind = "flash", foot = [0.5, 0.25], height = 2, strength = 3}
        fit = {solver = "paper", metric = "published", evaluations = 10, time_limit = 5, seeds = 3}
        """
    )
    setup = load_setup(path)
    assert setup.photo.zone == (1, 2, 300, 400)
    assert setup.photo.path == str(tmp_path / "photos" / "wall.jpg")
    assert setup.photo.name == "wall.jpg"
    assert (setup.mask, setup.proxy.mesh) == (tmp_path / "mask.png", tmp_path / "rock.ply")
    assert setup.output == tmp_path / "out"
    assert setup.light.foot == (0.5, 0.25)
    assert setup.camera.distance_used == 3
    assert setup.proxy.extent == (1, 2, 3)
    assert setup_from_text(setup_to_toml(setup)) == setup


def test_relative_paths_start_at_the_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "scenes").mkdir()
    (tmp_path / "scenes" / "wall.toml").write_text(SMALL)
    monkeypatch.chdir(tmp_path)
    assert load_setup("scenes/wall.toml").photo.path == str(tmp_path / "scenes" / "wall.jpg")
    # What is typed on the command line is relative to where it is typed.
    overridden = load_setup("scenes/wall.toml", ["photo.path=other.jpg", "mask=mask.png"])
    assert overridden.photo.path == str(tmp_path / "other.jpg")
    assert overridden.mask == tmp_path / "mask.png"


def test_overrides() -> None:
    typed = [
        "photo.resolution=128",
        "fit.specular=false",
        "light=flash@0.5,0.5",
        "light.height=2",
        "fit.metric=published",
        "camera.field_of_view = 50.5",
        "photo.zone=[0, 0, 64, 64]",
        "amplitude=0.25",
        "output=1979-05-27",
        "amplitude=",
    ]
    setup = setup_from_text(SMALL, typed)
    assert setup.photo.resolution == 128
    assert setup.fit.specular is False
    assert (setup.light.kind, setup.light.foot, setup.light.height) == ("flash", (0.5, 0.5), 2)
    assert setup.fit.metric == "published"
    assert setup.camera.field_of_view == 50.5
    assert setup.photo.zone == (0, 0, 64, 64)
    assert setup.amplitude is None
    assert setup.output == Path.cwd() / "1979-05-27"  # a date to TOML, a folder to people
    assert setup_from_text(SMALL, ["light.strength=2"]).light.direction == parse_light("70,50").direction


def test_an_override_cannot_smuggle_in_another_key() -> None:
    setup = setup_from_text(SMALL, ["fit.metric=1\nseed = 5"])
    assert setup.seed == 0
    assert setup.fit.metric == "1\nseed = 5"


@pytest.mark.parametrize(
    ("override", "says"),
    [
        (
            "photo.resolutoin=5",
            "'photo.resolutoin=5': there is no setting photo.resolutoin; the nearest one is resolution",
        ),
        ("paint=1", "no setting paint"),
        (
            "photo.resolution=5000",
            "5000 is out of range; allowed: a whole number at least 64 and at most 1024 pixels",
        ),
        ("photo.resolution=128.5", "photo.resolution = 128.5 is of the wrong kind"),
        ("photo.resolution=big", "photo.resolution = 'big' is of the wrong kind"),
        ("photo.encoding=gamma", "photo.encoding = 'gamma' is not known; allowed: one of auto, srgb, linear"),
        ("photo.path=", "photo.path is missing"),
        ("photo.path=skimage:gravle", "the nearest one is gravel"),
        ("photo.zone=[1, 2]", "photo.zone[2] is missing; allowed: x, y, width, height"),
        ("photo.zone=[-1, 0, 64, 64]", "photo.zone[0] = -1 is out of range"),
        (
            "photo.zone=[0, 0, 64, 31]",
            "with -D 'photo.zone=[0, 0, 64, 31]': photo: the zone is 64 x 31 pixels",
        ),
        ("light=", "light is missing; allowed:"),
        ("light=0,0,0", "it is zero"),
        ("light=90,-5", "behind the surface"),
        ("light.direction=[0, 0, nan]", "light.direction[2] = nan is not a finite number"),
        ("light.direction=[1, 1, 0]", "behind the surface"),
        ("light.kind=sun", "light.kind = 'sun' is not known; allowed: one of directional, point, spot, flash"),
        ("light.kind=flash", "direction belongs to a light of kind"),
        ("proxy.kind=mesh", "needs the path of a mesh file"),
        ("proxy.mesh=rock.ply", 'set proxy.kind to "mesh"'),
        ("proxy.size=[1, 0, 1]", "has to be over 0"),
        ("proxy=3", "proxy = 3 is of the wrong kind; allowed: a table of settings"),
        ("camera.distance=0", "camera.distance = 0 is out of range; allowed: a number over 0"),
        ("camera.field_of_view=180", "out of range"),
        ("amplitude=0", "amplitude = 0 is out of range"),
        ("amplitude=inf", "amplitude = inf is not a finite number"),
        ("fit.specular=1", "fit.specular = 1 is of the wrong kind; allowed: true or false"),
        ("fit.solver=papre", "one of default, paper"),
        ("fit.seeds=0", "fit.seeds = 0 is out of range; allowed: a whole number at least 1 and at most 16"),
        ("fit.time_limit=-1", "seconds"),
        ("seed=4294967296", "out of range"),
        ("seed.x=1", "seed"),
        ("photo.path.x=1", "photo.path is a single value"),
        ("nothing", "not of the form key.sub=value"),
        ("=1", "not of the form key.sub=value"),
        ("photo..path=1", "not of the form key.sub=value"),
    ],
)
def test_refused_overrides(override: str, says: str) -> None:
    with pytest.raises(InputError) as refused:
        setup_from_text(SMALL, [override], where="wall.toml")
    message = str(refused.value)
    assert says in message
    assert "\n" not in message


def test_the_file_is_blamed_for_what_no_override_touched() -> None:
    text = SMALL + "resolution = 5\n"
    with pytest.raises(InputError, match=r"^wall\.toml: photo\.resolution = 5 is out of range"):
        setup_from_text(text, ["seed=3"], where="wall.toml")
    assert setup_from_text(text, ["photo.resolution=64"]).photo.resolution == 64


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("a = ", "not valid TOML"),
        ("a = 1\na = 2", "not valid TOML"),
        ("a = " + "9" * 5000, "not valid TOML"),
        ("a = " + "[" * 100_000, "not valid TOML"),
        ("seed = 0x" + "f" * 10_000 + SMALL, "too large"),
        ("", "photo is missing"),
        (
            'light = "70,50"\nphoto = "wall.jpg"',
            "photo = 'wall.jpg' is of the wrong kind; allowed: a table with path",
        ),
    ],
)
def test_broken_toml(text: str, says: str) -> None:
    with pytest.raises(InputError) as refused:
        setup_from_text(text, where="wall.toml")
    assert says in str(refused.value)
    assert str(refused.value).startswith("wall.toml")


def test_files_that_cannot_be_read(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="does not exist"):
        load_setup(tmp_path / "none.toml")
    with pytest.raises(InputError, match="folder"):
        load_setup(tmp_path)
    large = tmp_path / "large.toml"
    large.write_text(SMALL + "#" * LARGEST_FILE)
    with pytest.raises(InputError, match="MB"):
        load_setup(large)


def test_python_callers() -> None:
    setup = setup_from({"photo": {"path": Path("wall.jpg")}, "light": parse_light("flash"), "output": Path("out")})
    assert setup.light.kind == "flash"
    assert setup.output == Path.cwd() / "out"
    with pytest.raises(InputError, match=r"The setup: light is missing"):
        setup_from({"photo": {"path": "wall.jpg"}})


def test_default_distance_fills_the_view() -> None:
    camera = CameraSetup(kind="perspective", field_of_view=90)
    assert camera.distance_used == pytest.approx(1)
    assert 2 * camera.distance_used * math.tan(math.radians(90) / 2) == pytest.approx(2)


@pytest.mark.parametrize("kind", list(SHAPES))
def test_default_sizes_are_about_two_across(kind: str) -> None:
    mesh = "rock.ply" if kind == "mesh" else None
    proxy = ProxySetup.model_validate({"kind": kind, "mesh": mesh})
    assert max(proxy.extent) == 2
    again = ProxySetup.model_validate({"kind": kind, "mesh": mesh, "size": proxy.extent})
    assert again.extent == proxy.extent


@pytest.mark.parametrize("name", ["gravel", "grass", "brick"])
def test_example_scenes(name: str) -> None:
    setup = load_setup(SCENES / f"{name}.toml")
    assert setup.photo.skimage == name
    assert setup.photo.zone is not None
    x, y, width, height = setup.photo.zone
    assert max(x + width, y + height) <= 512  # the size of these photographs
    assert setup_from_text(setup_to_toml(setup)) == setup


def test_a_light_to_be_estimated() -> None:
    setup = setup_from_text(SMALL, ["light=auto"])
    assert setup.light.kind == "auto"
    assert setup_from_text(setup_to_toml(setup)) == setup
    assert setup_from_text(SMALL.replace('"70,50"', '"auto"')) == setup
    assert setup_from_text(SMALL, ["light=auto", "light.strength=2"]).light.strength == 2
