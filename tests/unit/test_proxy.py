"""The simple shapes: where their points and normals lie."""

import numpy as np
import pytest
from numpy.typing import NDArray

from voldetail.geometry.proxy import Proxy, make_proxy
from voldetail.geometry.topology import crosses, edges, signed_volume, weld
from voldetail.setup.proxy import ProxySetup
from voldetail.setup.shapes import SIMPLE_KINDS

EDGE = 0.08


def proxy(domain: str = "solid", edge: float = EDGE, **fields: object) -> Proxy:
    return make_proxy(ProxySetup(**fields), edge, domain)  # type: ignore[arg-type]


def face_directions(shape: Proxy) -> NDArray[np.float64]:
    normals = crosses(shape.positions.astype(np.float64), shape.faces.astype(np.int64))
    return np.asarray(normals / np.linalg.norm(normals, axis=1, keepdims=True))


@pytest.mark.parametrize("kind", list(SIMPLE_KINDS))
def test_edges_are_short_and_normals_unit_and_outward(kind: str) -> None:
    shape = proxy(kind=kind)
    ends = shape.positions[shape.faces]
    # Points put back on a curve end up a little further apart than on its chord.
    assert np.linalg.norm(ends - np.roll(ends, 1, axis=1), axis=2).max() <= EDGE * 1.02
    assert np.linalg.norm(shape.normals, axis=1) == pytest.approx(1.0, abs=1e-5)
    outward = np.einsum("fj,fcj->fc", face_directions(shape), shape.normals[shape.faces])
    # At the corner of a box three sides meet, at 1 / sqrt(3) to the mean of them.
    assert outward.min() > (0.5 if kind in ("box", "cylinder") else 0.99)
    if kind != "plane":
        position, _ = weld(shape.positions.astype(np.float64))
        joined = position[shape.faces.astype(np.int64)]
        assert edges(joined).closed
        assert signed_volume(shape.positions.astype(np.float64), shape.faces.astype(np.int64)) > 0


def test_a_plane_faces_the_viewer() -> None:
    shape = proxy(kind="plane", size=(3.0, 1.0, 0.0), position=(0.5, 0.0, -0.25))
    assert (shape.normals == np.float32([0, 0, 1])).all()
    assert shape.positions.min(axis=0) == pytest.approx([-1.0, -0.5, -0.25])
    assert shape.positions.max(axis=0) == pytest.approx([2.0, 0.5, -0.25])
    assert shape.domain[:, 2] == pytest.approx(0.0)  # the noise is the object's own


def test_a_sphere_is_round() -> None:
    shape = proxy(kind="sphere", size=(1.4, 1.4, 1.4), position=(0.1, 0.2, 0.3))
    from_centre = shape.positions - np.float32([0.1, 0.2, 0.3])
    assert np.linalg.norm(from_centre, axis=1) == pytest.approx(0.7, abs=1e-6)
    assert shape.normals == pytest.approx(from_centre / 0.7, abs=1e-5)
    assert shape.domain == pytest.approx(from_centre, abs=1e-6)


def test_an_ellipsoid_in_closed_form() -> None:
    shape = proxy(kind="ellipsoid", size=(2.0, 1.0, 0.6))
    half = np.array([1.0, 0.5, 0.3])
    assert ((shape.positions / half) ** 2).sum(axis=1) == pytest.approx(1.0, abs=1e-5)
    gradient = shape.positions / half**2
    assert shape.normals == pytest.approx(gradient / np.linalg.norm(gradient, axis=1, keepdims=True), abs=1e-4)


def test_a_cylinder_stands_upright() -> None:
    shape = proxy(kind="cylinder", size=(1.5, 2.0, 1.5))
    assert np.abs(shape.positions[:, 1]).max() == pytest.approx(1.0)
    side = np.abs(shape.positions[:, 1]) < 1 - 1e-5
    radial = shape.positions[:, [0, 2]]
    radius = np.linalg.norm(radial, axis=1)
    assert side.sum() > 1000
    assert radius[side] == pytest.approx(0.75, abs=1e-5)
    assert shape.normals[side][:, 1] == pytest.approx(0.0, abs=1e-6)
    assert shape.normals[side][:, [0, 2]] == pytest.approx(radial[side] / 0.75, abs=1e-4)
    lid = ~side & (radius < 0.74)
    assert lid.sum() > 100
    assert shape.normals[lid] == pytest.approx(np.sign(shape.positions[lid]) * [0, 1, 0])


def test_the_sides_of_a_box_are_flat_to_their_edges() -> None:
    shape = proxy(kind="box", size=(2.0, 1.0, 0.5))
    on_side = np.abs(np.abs(shape.positions) - [1.0, 0.5, 0.25]) < 1e-6
    assert on_side.any(axis=1).all()
    single = on_side.sum(axis=1) == 1
    assert single.sum() > 1000
    assert shape.normals[single] == pytest.approx(np.sign(shape.positions[single]) * on_side[single])
    double = on_side.sum(axis=1) == 2
    assert np.abs(shape.normals[double]).max(axis=1) == pytest.approx(np.sqrt(0.5), abs=1e-6)


def test_rotations_turn_about_x_then_y_then_z() -> None:
    def corner(rotation: tuple[float, float, float]) -> NDArray[np.float32]:
        return proxy(kind="plane", size=(2.0, 1.0, 0.0), edge=9.0, rotation=rotation).positions[2]  # (1, 0.5, 0)

    assert corner((90, 0, 0)) == pytest.approx([1, 0, 0.5], abs=1e-6)
    assert corner((0, 90, 0)) == pytest.approx([0, 0.5, -1], abs=1e-6)
    assert corner((0, 0, 90)) == pytest.approx([-0.5, 1, 0], abs=1e-6)
    # x: (1, 0, 0.5); y: (0.5, 0, -1); z: (0, 0.5, -1)
    assert corner((90, 90, 90)) == pytest.approx([0, 0.5, -1], abs=1e-6)
    tilted = proxy(kind="plane", rotation=(0.0, 60.0, 0.0))
    assert tilted.normals == pytest.approx(np.tile([np.sin(np.pi / 3), 0, 0.5], (len(tilted.normals), 1)), abs=1e-6)


def test_a_turn_does_not_change_the_noise_of_the_object() -> None:
    straight, turned = proxy(kind="sphere"), proxy(kind="sphere", rotation=(10.0, 20.0, 30.0), position=(1.0, 0.0, 0.0))
    assert (straight.domain == turned.domain).all()
    assert not np.allclose(straight.positions, turned.positions)


def test_the_surface_domain_of_a_cylinder_is_unrolled() -> None:
    shape = proxy("surface", kind="cylinder", size=(1.0, 2.0, 1.0))
    x, y, z = shape.positions.T
    front = (np.abs(x) < 0.3) & (z > 0.3) & (np.abs(y) < 0.9)
    angle = np.arcsin(x[front] / 0.5)
    assert shape.domain[front, 0] == pytest.approx(angle * 0.5, abs=1e-5)
    assert shape.domain[front, 1] == pytest.approx(shape.positions[front, 1])
    assert (shape.domain[:, 2] == 0).all()


def test_a_torus_in_closed_form() -> None:
    shape = proxy(kind="torus", size=(1.8, 1.8, 0.6))
    x, y, z = shape.positions.astype(np.float64).T
    around = np.hypot(x, y) - 0.6
    assert np.hypot(around, z) == pytest.approx(0.3, abs=1e-6)
    outward = np.stack([x * around / np.hypot(x, y), y * around / np.hypot(x, y), z], axis=1) / 0.3
    assert shape.normals == pytest.approx(outward, abs=1e-5)
    volume = signed_volume(shape.positions.astype(np.float64), shape.faces.astype(np.int64))
    assert volume == pytest.approx(2 * np.pi**2 * 0.6 * 0.3**2, rel=0.01)  # Pappus


@pytest.mark.parametrize(
    ("size", "says"), [((2.0, 1.8, 0.5), "as wide as it is high"), ((2.0, 2.0, 1.0), "less than half of its width")]
)
def test_a_torus_is_round_and_has_a_hole(size: tuple[float, float, float], says: str) -> None:
    with pytest.raises(ValueError, match=says):
        ProxySetup(kind="torus", size=size)


def test_an_unknown_kind_is_no_box() -> None:
    unknown = ProxySetup.model_construct(kind="cone", size=(1.0, 1.0, 1.0), rotation=(0, 0, 0), position=(0, 0, 0), mesh=None)
    with pytest.raises(ValueError, match="no kind of shape 'cone'"):
        make_proxy(unknown, 0.1)


def test_a_cylinder_has_no_slivers() -> None:
    shape = proxy(kind="cylinder", edge=0.02)
    corners = shape.positions[shape.faces].astype(np.float64)
    sides = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2)
    area = np.linalg.norm(crosses(shape.positions.astype(np.float64), shape.faces.astype(np.int64)), axis=1) / 2
    upright = np.abs(shape.normals[shape.faces][:, :, 1]).max(axis=1) < 0.5
    # An equilateral triangle has 0.43 of its longest side squared, a right-angled isosceles one 0.25.
    assert np.median((area / sides.max(axis=1) ** 2)[upright]) > 0.2
