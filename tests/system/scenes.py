"""Small scenes that several tests look at."""

from typing import Any

from voldetail.detail import Detail, with_values
from voldetail.setup.light import Light
from voldetail.setup.photo import PhotoSetup
from voldetail.setup.setup import Setup

SIDE = 64
OVERHEAD = Light(direction=(0.0, 0.0, 1.0))


def detail(**values: Any) -> Detail:
    """A detail of round bumps, a few to the picture; ``values`` by key with its dot written as two underscores."""
    given = {
        "noise.scale": 2.0, "noise.envelope": "gaussian", "noise.octaves": 1, "relief.amplitude": 0.12,
        **{key.replace("__", "."): value for key, value in values.items()},
    }  # fmt: skip
    return with_values(Detail(), given)


def setup(resolution: int = SIDE, **fields: Any) -> Setup:
    """A plane that faces the camera."""
    return Setup(photo=PhotoSetup(path="none.png", resolution=resolution), **{"light": OVERHEAD, **fields})
