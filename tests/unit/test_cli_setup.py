"""The options of fit as a Setup."""

import inspect
from pathlib import Path
from typing import Any

import pytest

from voldetail.cli.commands.fit import fit
from voldetail.cli.fit_setup import implied, output_folder, read_setup
from voldetail.cli.settings import field_of, given, setting
from voldetail.errors import InputError
from voldetail.setup.setup import Setup

SCENES = Path(__file__).resolve().parents[2] / "scenes"


def read(*overrides: str, photo: str = "skimage:gravel", **options: Any) -> Setup:
    return read_setup(photo, implied(list(given(fit, options))), overrides)


def test_every_option_reaches_the_setup() -> None:
    setup = read(
        light="70,50", mask="m.png", amplitude=0.2, resolution=128, solver="paper", metric="published",
        seed=7, evaluations=50, time_limit=9.0, domain="surface", camera="perspective", fov=50.0,
        specular=False, output="there", zone="1,2,64,80", proxy="sphere", rotation="1,2,3",
    )  # fmt: skip
    assert setup.mask == Path.cwd() / "m.png"
    assert setup.output == Path.cwd() / "there"
    assert (setup.amplitude, setup.seed, setup.domain) == (0.2, 7, "surface")
    assert (setup.photo.zone, setup.photo.resolution) == ((1, 2, 64, 80), 128)
    assert (setup.fit.solver, setup.fit.metric, setup.fit.evaluations) == ("paper", "published", 50)
    assert (setup.fit.time_limit, setup.fit.specular) == (9.0, False)
    assert (setup.camera.kind, setup.camera.field_of_view) == ("perspective", 50.0)
    assert (setup.proxy.kind, setup.proxy.rotation) == ("sphere", (1, 2, 3))


def test_options_not_given_leave_the_defaults() -> None:
    plain = read(
        light="70,50",
        **dict.fromkeys(name for name in inspect.signature(fit).parameters if name not in ("photo", "light")),
    )
    assert plain == read(light="70,50")
    assert plain.photo.resolution == 192


def test_a_scene_with_options_and_overrides() -> None:
    setup = read("seed=5", photo=str(SCENES / "gravel.toml"), light="10,20", seed=3)
    assert setup.seed == 5  # -D comes last
    assert setup.light != read(photo=str(SCENES / "gravel.toml")).light
    assert setup.photo.zone is not None


def test_an_angle_makes_the_camera_perspective() -> None:
    assert read(light="1,2", fov=30.0).camera.kind == "perspective"
    assert read(light="1,2", fov=30.0, camera="orthographic").camera.kind == "orthographic"


def test_a_mesh_file_as_proxy() -> None:
    setup = read(light="1,2", proxy="rock.ply")
    assert (setup.proxy.kind, setup.proxy.mesh) == ("mesh", Path.cwd() / "rock.ply")


@pytest.mark.parametrize("name", ['a "quoted" name.png', "caf\u00e9 \U0001f600.png", "back\\slash.png", "123", "true"])
def test_odd_file_names(name: str) -> None:
    assert read(photo=name, light="1,2").photo.path == str(Path.cwd() / name)


@pytest.mark.parametrize(
    ("options", "says"),
    [
        ({}, "give --light as AZ,EL in degrees, x,y,z, flash"),
        ({"light": "sun"}, "The light 'sun' is not understood"),
        ({"light": "1,2", "resolution": 5}, "--resolution 5: photo.resolution = 5 is out of range"),
        ({"light": "1,2", "proxy": "shpere"}, "--proxy 'shpere' is not known; the nearest one is sphere"),
        ({"light": "1,2", "zone": "1,2"}, "--zone '1,2' is not understood"),
        ({"light": "1,2", "zone": "1,2,9,9"}, "at least 32"),
        ({"light": "1,2", "solver": "papre"}, "--solver papre"),
        ({"light": "1,2", "amplitude": -1.0}, "--amplitude -1.0"),
        ({"light": "1,2", "amplitude": float("nan")}, "--amplitude nan"),
        ({"light": "1,2", "camera": "fisheye"}, "orthographic, perspective"),
    ],
)
def test_refusals_name_the_option(options: dict[str, Any], says: str) -> None:
    with pytest.raises(InputError) as refused:
        read(**options)
    assert says in str(refused.value)
    assert "\n" not in str(refused.value)


def test_where_results_go_by_default() -> None:
    assert output_folder(read(light="1,2")) == Path("voldetail-out/gravel")
    assert output_folder(read(photo="a/wall.old.jpg", light="1,2")) == Path("voldetail-out/wall.old")
    assert output_folder(read(light="1,2", output="x")) == Path.cwd() / "x"


def test_an_option_says_what_its_field_says() -> None:
    option = setting("photo.resolution", panel="Where")
    assert option.help == "The longest side of the zone after resampling, in pixels."
    assert field_of("fit.evaluations").description in (setting("fit.evaluations", panel="x").help or "")
    for wrong in ("photo.size", "seed.root", "nothing"):
        with pytest.raises(KeyError):
            field_of(wrong)
