"""Pictures and numbers of today, so that a change of them is noticed and meant.

The numbers of `GOLDEN` were made by:  python -m tests.regression.test_goldens
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from voldetail.backend import mitsuba
from voldetail.detail import Detail, load_detail, with_values
from voldetail.field.relief import relief_at
from voldetail.fit.objective import Objective
from voldetail.fit.target import make_target
from voldetail.render.build import build
from voldetail.render.unit_components import components
from voldetail.setup.file import setup_from
from voldetail.setup.lamp import Lamp

ROOT = Path(__file__).resolve().parents[2]
FITS = sorted((ROOT / "results" / "fits").glob("*/detail.json"))

CASES = {
    "plain": {},
    "all points": {"noise.last_neighbour": 50, "noise.octaves": 3},
    "striped": {"noise.stripe_frequency": 1.5, "noise.stripe_spread": 2.0, "noise.anisotropy": 0.5, "noise.angle": 0.7},
    "grains": {"noise.weights": (1.0, -1.0, 1.0), "noise.envelope": "gaussian", "reflectance.cell_albedo": 0.4},
    "plates": {
        "noise.weights": (1.0, -1.0, 1.0),
        "noise.cell_height": 1.5,
        "noise.cell_tilt": 2.0,
        "noise.bevel": 0.15,
        "reflectance.cell_albedo": 0.2,
    },
    "stones": {
        "noise.joining": "highest",
        "noise.last_neighbour": 50,
        "noise.facets": 0.9,
        "noise.elongation": 2.0,
        "noise.size_spread": 0.4,
        "noise.octaves": 2,
        "noise.gain": 0.3,
        "noise.lacunarity": 3.0,
        "reflectance.cell_albedo": 0.3,
        "reflectance.speckle": 0.3,
    },
}


def measured(name: str) -> list[float]:
    """Return five heights and the mean and deviation of the lit picture of a case."""
    mi = mitsuba()
    detail = with_values(Detail(seed=11), CASES[name])
    places = np.array([[0.1, 0.2, 0.3], [-0.7, 0.4, 0.0], [5.5, -3.2, 1.1], [0.0, 0.0, 0.0], [-0.93, 0.77, 0.5]])
    heights = relief_at(detail, tuple(mi.Float(places[:, axis].astype(np.float32)) for axis in range(3)))
    surface = build(_setup(), (64, 64), None)
    surface.update(detail)
    picture = components(surface, Lamp((0.5, 0.5, 0.7071))).diffuse
    return [round(float(v), 5) for v in (*np.asarray(heights), picture.mean(), picture.std())]


def _setup() -> object:
    return setup_from({"photo": {"path": "none.png", "resolution": 64}, "light": "45,45"}, "golden")


GOLDEN: dict[str, list[float]] = {
    "plain": [0.50736, 0.20444, 0.39542, 0.62932, 0.27508, 0.68391, 0.11791],
    "all points": [0.66348, 0.17368, 0.4105, 0.54784, 0.39259, 0.68606, 0.11489],
    "striped": [0.82664, 0.65124, 0.57877, 0.64959, 0.30708, 0.68838, 0.09023],
    "grains": [0.30683, 0.27084, 0.25171, 0.86966, 0.17496, 0.68204, 0.17055],
    "plates": [0.24092, 0.58221, 0.17314, 0.92934, 0.18119, 0.6834, 0.12364],
    "stones": [0.58238, 0.32489, 0.19263, 0.49928, 0.17932, 0.66613, 0.16657],
}


@pytest.mark.parametrize("name", CASES)
def test_noise_and_pictures_are_those_of_the_golden_run(name: str) -> None:
    # Heights are the same to rounding on any machine; pictures differ where a shadow's edge falls on a sample.
    found = measured(name)
    assert found[:5] == pytest.approx(GOLDEN[name][:5], abs=2e-4)
    assert found[5:] == pytest.approx(GOLDEN[name][5:], rel=0.01)


@pytest.mark.parametrize("path", FITS, ids=[p.parent.name for p in FITS])
def test_a_kept_detail_replays_to_the_distance_it_was_written_with(path: Path) -> None:
    detail = load_detail(path)
    made = detail.provenance
    assert made is not None
    if not made.photo.startswith("skimage:"):
        pytest.skip(f"the photo {made.photo} is not part of a package")
    setup = setup_from(
        {"photo": {"path": made.photo, "zone": made.zone, "resolution": made.resolution}, "light": made.light}, "replay"
    )
    target = make_target(setup)
    objective = Objective(target, build(setup, target.shape, target.zone), specular=True)
    assert objective.evaluate(detail).distance == pytest.approx(made.distance, rel=0.03)


if __name__ == "__main__":
    for case in CASES:
        print(f'    "{case}": {measured(case)},')
