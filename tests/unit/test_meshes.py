"""Meshes from files of every kind."""

import base64
import hashlib
import json
import struct

import numpy as np
import pytest
import trimesh
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from voldetail.errors import InputError
from voldetail.geometry.mesh_files import MAX_FACES, SUFFIXES
from voldetail.geometry.meshes import load_mesh, normalise
from voldetail.geometry.topology import consistent_winding, signed_volume, smooth_normals

FUZZ = settings(
    max_examples=200,
    deadline=None,
    derandomize=True,
    suppress_health_check=[HealthCheck.function_scoped_fixture],
)
CUBE = trimesh.creation.box()
BALL = trimesh.creation.icosphere(subdivisions=3)
POINT_PLY = """ply
format ascii 1.0
element vertex 1
property float x
property float y
property float z
end_header
0 0 0
"""
LARGE_PLY = b"""ply
format binary_little_endian 1.0
element vertex 3
property float x
property float y
property float z
element face 5000001
property list uchar int vertex_indices
end_header
"""
WRITABLE = ["obj", "ply", "stl", "off", "glb"]


def save(path, vertices, faces, **options):
    trimesh.Trimesh(vertices, faces, process=False, **options).export(path)
    return path


def save_obj(path, vertices, faces):
    """Plain text, since trimesh's own writer cleans what these tests need dirty."""
    lines = ["v " + " ".join(str(c) for c in v) for v in vertices]
    path.write_text("\n".join(lines + ["f " + " ".join(str(i + 1) for i in f) for f in faces]) + "\n")
    return path


@pytest.mark.parametrize("suffix", WRITABLE)
def test_every_format_gives_the_same_ball(tmp_path, suffix):
    BALL.export(tmp_path / f"a.{suffix}")
    mesh = load_mesh(tmp_path / f"a.{suffix}")
    assert (len(mesh.vertices), len(mesh.faces)) == (len(BALL.vertices), len(BALL.faces))
    assert mesh.watertight
    assert mesh.notes == ()
    assert mesh.vertices.dtype == mesh.normals.dtype == np.float64
    assert mesh.faces.dtype == np.int64
    assert signed_volume(mesh.vertices, mesh.faces) == pytest.approx(BALL.volume, rel=1e-5)
    # On a ball the normal is the position: within half a degree with 642 vertices.
    assert np.einsum("ij,ij->i", mesh.vertices, mesh.normals).min() > np.cos(np.radians(0.5))
    assert mesh.sha256 == hashlib.sha256((tmp_path / f"a.{suffix}").read_bytes()).hexdigest()


def test_normals_do_not_depend_on_how_a_flat_side_is_cut(tmp_path):
    mesh = load_mesh(save(tmp_path / "a.stl", CUBE.vertices, CUBE.faces))
    assert len(mesh.vertices) == 8
    # By angles all corners of a cube look along its diagonals; by areas or by faces they would not.
    np.testing.assert_allclose(mesh.normals, np.sign(mesh.vertices) / np.sqrt(3), atol=1e-12)


def test_back_to_back_faces_have_a_normal():
    vertices = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 0.0]])
    normals = smooth_normals(vertices[:3], np.array([[0, 1, 2], [0, 2, 1]]))
    np.testing.assert_allclose(np.abs(normals), [[0, 0, 1]] * 3)


def test_seams_keep_uv_and_open_no_gap(tmp_path):
    # A closed tetrahedron whose every face has texture coordinates of its own.
    (tmp_path / "a.obj").write_text(
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n"
        + "".join(f"vt {i / 10} {1 - i / 20}\n" for i in range(12))
        + "f 1/1 3/2 2/3\nf 1/4 2/5 4/6\nf 1/7 4/8 3/9\nf 2/10 3/11 4/12\n"
    )
    mesh = load_mesh(tmp_path / "a.obj")
    assert mesh.watertight
    assert mesh.uv is not None
    assert mesh.vertices.shape == (12, 3)
    assert sorted(mesh.uv[:, 0].round(6).tolist()) == pytest.approx([i / 10 for i in range(12)])
    for corner in np.unique(mesh.vertices, axis=0):
        at = (mesh.vertices == corner).all(axis=1)
        assert at.sum() == 3
        assert (mesh.normals[at] == mesh.normals[at][0]).all()
    third = np.flatnonzero(np.isclose(mesh.uv[:, 0], 0.1))[0]  # vt 2 belongs to vertex 3
    assert mesh.vertices[third].tolist() == [0, 1, 0]


def test_inside_out_is_turned_if_closed(tmp_path):
    mesh = load_mesh(save(tmp_path / "a.ply", BALL.vertices, BALL.faces[:, ::-1]))
    assert mesh.notes == ("inside out (negative volume), turned",)
    assert signed_volume(mesh.vertices, mesh.faces) > 0
    assert np.einsum("ij,ij->i", mesh.vertices, mesh.normals).min() > 0.99
    hole = load_mesh(save(tmp_path / "b.ply", BALL.vertices, BALL.faces[1:, ::-1]))
    assert hole.notes == ()
    assert not hole.watertight
    assert np.einsum("ij,ij->i", hole.vertices, hole.normals).max() < -0.9


def test_faces_that_disagree_are_turned(tmp_path):
    faces = BALL.faces.copy()
    wrong = np.random.default_rng(0).permutation(len(faces))[: len(faces) // 3]
    faces[wrong] = faces[wrong][:, ::-1]
    mesh = load_mesh(save(tmp_path / "a.ply", BALL.vertices, faces))
    assert mesh.notes == (f"{len(wrong)} faces turned to agree with their neighbours",)
    assert mesh.watertight
    assert np.einsum("ij,ij->i", mesh.vertices, mesh.normals).min() > 0.99


def test_a_moebius_strip_stays_as_it_is():
    n = 12
    strip = [(2 * i, 2 * i + 1, 2 * i + 2) for i in range(n)] + [(2 * i + 1, 2 * i + 3, 2 * i + 2) for i in range(n)]
    swap = {2 * n: 1, 2 * n + 1: 0}  # joined with a half turn
    faces = np.array([[swap.get(i, i) for i in face] for face in strip])
    turned, count = consistent_winding(faces)
    assert count == 0
    np.testing.assert_array_equal(turned, faces)


def test_degenerate_and_repeated_faces_are_dropped_with_a_note(tmp_path):
    faces = [*CUBE.faces.tolist(), [0, 0, 1], [2, 2, 2], CUBE.faces[0][::-1].tolist()]
    mesh = load_mesh(save_obj(tmp_path / "a.obj", CUBE.vertices.tolist(), faces))
    assert mesh.notes == ("2 degenerate faces dropped", "1 faces that repeat another dropped")
    assert len(mesh.faces) == 12
    assert mesh.watertight


def test_a_needle_without_area_is_degenerate(tmp_path):
    vertices = [*CUBE.vertices.tolist(), [2, 0, 0], [3, 0, 0], [4, 0, 0]]
    mesh = load_mesh(save_obj(tmp_path / "a.obj", vertices, [*CUBE.faces.tolist(), [8, 9, 10]]))
    assert mesh.notes == ("1 degenerate faces dropped",)
    assert len(mesh.vertices) == 8  # what no face uses is gone
    assert np.isfinite(mesh.normals).all()


def test_only_degenerate_faces_are_refused(tmp_path):
    with pytest.raises(InputError, match=r"All 2 faces .* degenerate"):
        load_mesh(save_obj(tmp_path / "a.obj", [[0, 0, 0], [1, 1, 1], [2, 2, 2]], [[0, 1, 2], [0, 0, 1]]))
    with pytest.raises(InputError, match=r"All 1 faces .* are degenerate"):
        load_mesh(save_obj(tmp_path / "b.obj", [[5, 5, 5]] * 3, [[0, 1, 2]]))


def test_non_manifold_edges_are_counted(tmp_path):
    vertices = [*CUBE.vertices.tolist(), [3, 3, 3]]
    a, b = CUBE.faces[0][:2].tolist()
    mesh = load_mesh(save_obj(tmp_path / "a.obj", vertices, [*CUBE.faces.tolist(), [b, a, 8]]))
    assert mesh.notes == ("1 edges shared by more than two faces (non-manifold)",)
    assert not mesh.watertight


def test_several_bodies_are_noted(tmp_path):
    both = trimesh.util.concatenate([CUBE, trimesh.creation.box(bounds=[[4, 4, 4], [5, 5, 5]])])
    both.export(tmp_path / "a.stl")
    mesh = load_mesh(tmp_path / "a.stl")
    assert mesh.notes == ("2 separate bodies",)
    assert mesh.watertight


@pytest.mark.parametrize("value", ["nan", "inf", "-inf"])
def test_vertices_that_are_no_numbers_are_refused(tmp_path, value):
    vertices = [[str(c) for c in v] for v in CUBE.vertices]
    vertices[2][1] = vertices[5][0] = value
    with pytest.raises(InputError, match="2 vertices that are NaN or infinite, the first is number 3"):
        load_mesh(save_obj(tmp_path / "a.obj", vertices, CUBE.faces.tolist()))


def test_coordinates_that_overflow_are_refused_and_tiny_ones_work(tmp_path):
    with pytest.raises(InputError, match="scale it down"):
        load_mesh(save_obj(tmp_path / "a.obj", (CUBE.vertices * 1e200).tolist(), CUBE.faces.tolist()))
    mesh = load_mesh(save_obj(tmp_path / "b.obj", (CUBE.vertices * 1e-200).tolist(), CUBE.faces.tolist()))
    assert mesh.watertight
    np.testing.assert_allclose(np.abs(normalise(mesh).vertices), 1)


@pytest.mark.parametrize(
    ("name", "content", "words"),
    [
        ("a.obj", "", "0 bytes"),
        ("a.obj", "# nothing\n", "no faces|damaged"),
        ("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n", "no faces"),
        ("a.obj", "v 0 0 0\nv 1 0 0\nf 1 2 9\n", "damaged|does not exist"),
        ("a.off", "OFF\n3 0 0\n0 0 0\n1 0 0\n0 1 0\n", "no faces|damaged"),
        ("a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 7\n", "damaged|does not exist"),
        ("a.ply", POINT_PLY, "no faces"),
        ("a.stl", "hello", "damaged|no faces"),
        ("a.glb", "glTF", "damaged"),
        ("a.gltf", "[]", "damaged|no faces"),
        ("a.gltf", "{}", "damaged|no faces"),
    ],
)  # fmt: skip
def test_what_holds_no_surface_is_refused(tmp_path, name, content, words):
    (tmp_path / name).write_text(content)
    with pytest.raises(InputError, match=words):
        load_mesh(tmp_path / name)


@pytest.mark.parametrize("name", ["a.pkl", "a.npz", "a.dict", "a.zip", "a.3mf", "a.dae", "a.step", "a.json", "a", "a.xyz"])
def test_other_suffixes_are_refused_before_the_file_is_opened(tmp_path, name):
    with pytest.raises(InputError, match=r"suffix .*\.obj, \.ply, \.stl, \.off, \.glb, \.gltf"):
        load_mesh(tmp_path / name)  # the file does not exist: that would be another sentence


def test_missing_and_folder_are_refused(tmp_path):
    (tmp_path / "folder.obj").mkdir()
    with pytest.raises(InputError, match="does not exist"):
        load_mesh(tmp_path / "a.obj")
    with pytest.raises(InputError, match="is a folder"):
        load_mesh(tmp_path / "folder.obj")


@pytest.mark.parametrize(
    ("name", "content"),
    [
        ("a.ply", LARGE_PLY),
        ("a.stl", bytes(80) + struct.pack("<I", 5_000_001) + bytes(50)),
        ("a.off", b"OFF\n# a comment\n3 5000001 0\n"),
        ("a.gltf", json.dumps({"asset": {"version": "2.0"}, "accessors": [{"count": 15_000_003}]}).encode()),
    ],
)  # fmt: skip
def test_too_many_faces_are_refused_from_the_header(tmp_path, name, content):
    assert MAX_FACES == 5_000_000
    (tmp_path / name).write_bytes(content)
    with pytest.raises(InputError, match="5000001 faces, more than the 5000000 allowed"):
        load_mesh(tmp_path / name)


def test_a_scene_that_places_one_part_too_often_is_refused(tmp_path, monkeypatch):
    monkeypatch.setattr("voldetail.geometry.mesh_files.MAX_FACES", 30)
    scene = trimesh.Scene()
    scene.add_geometry(CUBE, geom_name="cube")
    for i in range(1, 3):
        scene.graph.update(frame_to=f"n{i}", matrix=np.eye(4) * [1, 1, 1, 1] + np.eye(4, k=3) * 3 * i, geometry="cube")
    scene.export(tmp_path / "a.glb")
    with pytest.raises(InputError, match="36 faces"):
        load_mesh(tmp_path / "a.glb")
    monkeypatch.undo()
    assert load_mesh(tmp_path / "a.glb").notes == ("3 separate bodies",)


def test_a_scene_is_put_together_in_its_place_and_mirrored_parts_stay_outside_out(tmp_path):
    scene = trimesh.Scene()
    mirror = np.diag([-1.0, 2, 1, 1])
    mirror[:3, 3] = [10, 0, 0]
    scene.add_geometry(BALL, transform=mirror)
    scene.export(tmp_path / "a.glb")
    mesh = load_mesh(tmp_path / "a.glb")
    np.testing.assert_allclose([mesh.vertices.min(0), mesh.vertices.max(0)], [[9, -2, -1], [11, 2, 1]], atol=1e-3)
    assert mesh.notes == ()  # not "inside out": it was never so
    assert signed_volume(mesh.vertices, mesh.faces) == pytest.approx(2 * BALL.volume, rel=1e-4)


def gltf(uri, size):
    """A .gltf of one triangle, its buffer at `uri`."""
    return json.dumps(
        {
            "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
            "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
            "buffers": [{"uri": uri, "byteLength": size}],
            "bufferViews": [{"buffer": 0, "byteOffset": 0, "byteLength": 36},
                            {"buffer": 0, "byteOffset": 36, "byteLength": 12}],
            "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"},
                          {"bufferView": 1, "componentType": 5125, "count": 3, "type": "SCALAR"}],
        }
    )  # fmt: skip


def test_gltf_reads_its_buffer_inside_its_folder_only(tmp_path):
    triangle = struct.pack("<9f3I", 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 1, 2)
    folder = tmp_path / "in"
    folder.mkdir()
    (folder / "my data.bin").write_bytes(triangle)
    (tmp_path / "out.bin").write_bytes(triangle)
    inline = "data:application/octet-stream;base64," + base64.b64encode(triangle).decode()
    hashes = set()
    for uri in ("my%20data.bin", inline):
        (folder / "a.gltf").write_text(gltf(uri, len(triangle)))
        mesh = load_mesh(folder / "a.gltf")
        np.testing.assert_allclose(mesh.normals, [[0, 0, 1]] * 3)
        hashes.add(mesh.sha256)
    assert len(hashes) == 2
    (folder / "a.gltf").write_text(gltf("my%20data.bin", len(triangle)))
    (folder / "my data.bin").write_bytes(triangle.replace(struct.pack("<f", 1), struct.pack("<f", 2)))
    assert load_mesh(folder / "a.gltf").sha256 not in hashes  # the buffer counts
    for uri in (
        "../out.bin",
        str(tmp_path / "out.bin"),
        "http://example.com/out.bin",
        "file:///etc/hostname",
    ):
        (folder / "a.gltf").write_text(gltf(uri, len(triangle)))
        with pytest.raises(InputError, match="outside its own folder"):
            load_mesh(folder / "a.gltf")


def test_materials_and_pictures_beside_an_obj_are_not_opened(tmp_path, monkeypatch):
    text = "mtllib a.mtl\nusemtl m\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nf 1/1 2/1 3/1\n"
    (tmp_path / "a.obj").write_text(text)
    (tmp_path / "a.mtl").mkdir()  # opening it would fail
    opened = []
    real = trimesh.resolvers.FilePathResolver.get
    monkeypatch.setattr(trimesh.resolvers.FilePathResolver, "get", lambda s, n: opened.append(n) or real(s, n))
    assert load_mesh(tmp_path / "a.obj").uv is not None
    assert opened == []


def test_normalise_centres_and_scales_the_longest_side(tmp_path):
    mesh = load_mesh(save(tmp_path / "a.ply", CUBE.vertices * [1, 5, 2] + [7, 8, 9], CUBE.faces))
    for result, size in ((normalise(mesh), 2.0), (normalise(mesh, size=3.0), 3.0)):
        np.testing.assert_allclose(result.vertices.max(0), np.array([1, 5, 2]) * size / 10, rtol=1e-6)
        np.testing.assert_allclose(result.vertices.min(0), -np.array([1, 5, 2]) * size / 10, rtol=1e-6)
        np.testing.assert_array_equal(result.normals, mesh.normals)
        assert result.sha256 == mesh.sha256


@pytest.mark.parametrize(
    ("name", "faces", "watertight", "uv", "note"),
    [
        ("spot/spot.obj", 5856, True, True, None),
        ("stanford_bunny/bunny.ply", 69451, False, False, None),
        ("armadillo/armadillo.ply", 52000, True, False, None),
        ("knot/knot1.off", 6400, True, False, None),
        ("teapot/teapot.obj", 6320, False, False, "bodies"),
        ("broken_beetle/beetle.obj", 2053, False, False, "non-manifold"),
        ("broken_chair/chair_model.obj", 6374, False, False, "repeat another"),
        ("triangle_soup/soup.stl", 100, False, False, "100 separate bodies"),
    ],
)
def test_real_meshes(shared_data, name, faces, watertight, uv, note):
    mesh = load_mesh(shared_data / "meshes" / name)
    assert (len(mesh.faces), mesh.watertight, mesh.uv is not None) == (faces, watertight, uv)
    assert note is None or note in " ".join(mesh.notes)
    np.testing.assert_allclose(np.linalg.norm(mesh.normals, axis=1), 1, atol=1e-12)
    assert mesh.faces.max() == len(mesh.vertices) - 1


def test_a_million_faces_work(tmp_path):
    side = 710
    y, x = np.mgrid[0:side, 0:side]
    vertices = np.stack([x, y, np.sin(x * 0.1)], axis=-1).reshape(-1, 3).astype(float)
    corner = (y * side + x)[:-1, :-1].reshape(-1)
    upper, lower = [corner, corner + 1, corner + side], [corner + 1, corner + side + 1, corner + side]
    faces = np.concatenate([np.stack(upper, 1), np.stack(lower, 1)])
    assert len(faces) > 1_000_000
    mesh = load_mesh(save(tmp_path / "a.ply", vertices, faces))
    assert len(mesh.faces) == len(faces)
    assert mesh.normals[:, 2].min() > 0.9


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    folder = tmp_path_factory.mktemp("valid")
    ball = trimesh.creation.icosphere(subdivisions=1)
    for suffix in WRITABLE:
        ball.export(folder / f"a.{suffix}")
    ball.export(folder / "text.ply", encoding="ascii")
    ball.export(folder / "text.stl", file_type="stl_ascii")
    triangle = struct.pack("<9f3I", 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 1, 2)
    (folder / "a.gltf").write_text(gltf("data:;base64," + base64.b64encode(triangle).decode(), len(triangle)))
    return {path.name: path.read_bytes() for path in folder.iterdir()}


def check_mesh_or_sentence(path):
    """Load; either it is a usable mesh, or InputError; whatever else is raised fails the test."""
    sentence = mesh = None
    try:
        mesh = load_mesh(path)
    except InputError as error:
        sentence = str(error)
    if mesh is None:
        assert str(path) in sentence
        assert "\n" not in sentence
    else:
        assert len(mesh.faces) > 0
        assert mesh.faces.min() == 0
        assert mesh.faces.max() == len(mesh.vertices) - 1
        assert np.isfinite(mesh.vertices).all()
        np.testing.assert_allclose(np.linalg.norm(mesh.normals, axis=1), 1, atol=1e-9)


STARTS = [
    b"",
    b"ply\nformat ascii 1.0\n",
    b"solid a\nfacet ",
    b"OFF\n3 1 0\n",
    b"glTF\x02\0\0\0",
    b'{"meshes":',
]
STARTS += [b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", b"ply\nformat binary_little_endian 1.0\nelement face 9\n"]


@FUZZ
@given(start=st.sampled_from(STARTS), rest=st.binary(max_size=300), suffix=st.sampled_from(SUFFIXES))
def test_arbitrary_bytes_never_raise_anything_else(tmp_path, start, rest, suffix):
    path = tmp_path / f"fuzz{suffix}"
    path.write_bytes(start + rest)
    check_mesh_or_sentence(path)


@settings(FUZZ, max_examples=400)
@given(data=st.data())
def test_corrupted_files_never_raise_anything_else(tmp_path, files, data):
    name = data.draw(st.sampled_from(sorted(files)))
    content = bytearray(files[name])
    for _ in range(data.draw(st.integers(1, 6))):
        reach = data.draw(st.sampled_from([min(400, len(content)), len(content)]))
        at = data.draw(st.integers(0, reach - 1))
        # Digits where digits are keep text files readable, so that the numbers themselves go wrong.
        digit = chr(content[at]).isdigit() and data.draw(st.booleans())
        content[at] = data.draw(st.integers(48, 57) if digit else st.integers(0, 255))
    if data.draw(st.booleans()):
        content = content[: data.draw(st.integers(1, len(content)))]
    path = tmp_path / f"fuzz-{name}"
    path.write_bytes(content)
    check_mesh_or_sentence(path)


@settings(FUZZ, max_examples=60)
@given(
    vertices=st.lists(st.tuples(*[st.integers(-20, 20)] * 3), min_size=4, max_size=12, unique=True),
    seed=st.integers(0, 2**32 - 1),
    suffix=st.sampled_from(WRITABLE),
)
def test_round_trips_keep_every_sound_triangle(tmp_path, vertices, seed, suffix):
    points = np.array(vertices, dtype=float)
    faces = np.random.default_rng(seed).integers(0, len(points), (10, 3))
    areas = np.linalg.norm(np.cross(points[faces[:, 1]] - points[faces[:, 0]], points[faces[:, 2]] - points[faces[:, 0]]), axis=1)
    expected = {frozenset(map(tuple, points[f])) for f, area in zip(faces, areas, strict=True) if area > 0}
    path = save(tmp_path / f"a.{suffix}", points, faces)
    if not expected:
        with pytest.raises(InputError):
            load_mesh(path)
        return
    mesh = load_mesh(path)
    found = [frozenset(map(tuple, mesh.vertices[f])) for f in mesh.faces]
    assert set(found) == expected
    assert len(found) == len(expected)
