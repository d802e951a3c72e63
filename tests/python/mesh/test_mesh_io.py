"""Every format gives the same surface; every unusable file is refused with its name and the place."""

from __future__ import annotations

import hashlib
import os
from pathlib import Path

import numpy as np
import pytest
import trimesh

from quadgraph.base.errors import InputError
from quadgraph.mesh.mesh_io import read_surface, stood_up
from quadgraph.mesh.mesh_names import SUFFIXES
from quadgraph.mesh.mesh_text import read_obj
from quadgraph.mesh.surface import Surface
from shapes import cube, icosphere

QUAD_CUBE = """
v 0 0 0
v 0 0 1
v 0 1 0
v 0 1 1
v 1 0 0
v 1 0 1
v 1 1 0
v 1 1 1
vt 0 0
vt 1 1
"""
QUADS = [(1, 2, 4, 3), (5, 7, 8, 6), (1, 5, 6, 2), (3, 4, 8, 7), (1, 3, 7, 5), (2, 6, 8, 4)]


def write(surface: Surface, path: Path) -> Path:
    trimesh.Trimesh(surface.vertices, surface.triangles, process=False).export(path)
    return path


@pytest.mark.parametrize("extension", SUFFIXES)
def test_formats_agree(tmp_path: Path, extension: str) -> None:
    sphere = icosphere(2, 3)
    path = write(sphere, tmp_path / f"ball{extension}")
    source = read_surface(path, unit="cm")
    assert (source.vertices, source.triangles, source.unit_mm) == (162, 320, 10.0)
    assert source.surface.volume == pytest.approx(1000 * sphere.volume, rel=1e-6)
    assert source.surface.is_closed_manifold
    assert source.name == path.name
    assert source.sha256 == hashlib.sha256(path.read_bytes()).hexdigest()


def test_height_is_the_extent_along_y(tmp_path: Path) -> None:
    path = write(Surface(cube().vertices * (5, 2, 7), cube().triangles), tmp_path / "box.ply")
    source = read_surface(path, height_mm=100)
    assert source.unit_mm == pytest.approx(50)
    assert np.ptp(source.surface.vertices, axis=0) == pytest.approx([250, 100, 350])


def test_what_points_up_in_the_file_does_in_the_body(tmp_path: Path) -> None:
    path = tmp_path / "box.obj"
    path.write_text(trimesh.creation.box((1, 2, 3)).export(file_type="obj"))
    for up, sides in (("y", (5, 10, 15)), ("z", (5, 15, 10))):
        surface = read_surface(path, unit="cm", up=up).surface
        assert np.allclose(np.ptp(surface.vertices, axis=0), np.array(sides) * 2)
        assert surface.volume == pytest.approx(6000)  # turned, not mirrored
    assert read_surface(path, height_mm=30, up="z").unit_mm == pytest.approx(10)
    assert stood_up(np.array([[1.0, 2.0, 3.0]]), "z").tolist() == [[1.0, 3.0, -2.0]]
    with pytest.raises(InputError, match="up: 'x' found, allowed are y and z"):
        read_surface(path, unit="cm", up="x")


def test_polygons_and_texture_seams_of_obj(tmp_path: Path) -> None:
    path = tmp_path / "cube.obj"
    faces = "".join("f " + " ".join(f"{i}/{1 + k % 2}" for k, i in enumerate(quad)) + "\n" for quad in QUADS)
    path.write_text(QUAD_CUBE + faces)
    source = read_surface(path, unit="m")
    assert source.vertices == 8
    assert source.triangles == 12
    assert source.surface.is_closed_manifold
    assert source.surface.volume == pytest.approx(1e9)


def test_negative_indices_of_obj(tmp_path: Path) -> None:
    path = tmp_path / "cube.obj"
    path.write_text(QUAD_CUBE + "".join("f " + " ".join(str(i - 9) for i in quad) + "\n" for quad in QUADS))
    assert read_surface(path, unit="mm").surface.volume == pytest.approx(1)


@pytest.mark.parametrize(
    "unusual",
    [
        "v\t9 9 9\n",
        " v 9 9 9\n",
        "v 9 9 9 1 0 0 # with a colour\n",
        "f\t1 2 4 3\n",
        "f 1 2 4\n",
        "f 1 2 4 3 7 # a corner more\n",
        "f 1 \\\n2 4 3\n",
        "f -8 -7 -5 -6\n",
    ],
)
def test_a_line_of_obj_is_read_alike_among_plain_and_unusual_ones(tmp_path: Path, unusual: str) -> None:
    """Files all of whose lines are alike are read all at once, others line by line."""
    path = tmp_path / "cube.obj"
    faces = "".join("f " + " ".join(f"{i}//{i}" for i in quad) + "\n" for quad in QUADS)
    path.write_text(QUAD_CUBE + faces)
    vertices, triangles = read_obj(path)
    assert triangles.shape == (12, 3)
    assert np.abs(vertices - 0.5).max() == 0.5
    path.write_text(QUAD_CUBE + faces + unusual)
    more_vertices, more_triangles = read_obj(path)
    assert np.array_equal(more_vertices[:8], vertices)
    assert np.array_equal(more_triangles[:12], triangles)
    if "v" in unusual:
        assert np.array_equal(more_vertices[8:], [[9, 9, 9]])
    else:
        assert more_triangles[12].tolist() == [0, 1, 3]


def test_gltf_nodes_are_placed(tmp_path: Path) -> None:
    scene = trimesh.Scene()
    box = trimesh.creation.box(extents=(1, 1, 1))
    scene.add_geometry(box, transform=trimesh.transformations.translation_matrix((0, 0, 0)))
    scene.add_geometry(box, transform=trimesh.transformations.scale_and_translate(2, (10, 0, 0)))
    scene.export(tmp_path / "two.glb")
    source = read_surface(tmp_path / "two.glb", unit="mm")
    assert source.surface.components == 2
    assert source.surface.volume == pytest.approx(1 + 8)
    assert source.surface.vertices[:, 0].max() == pytest.approx(11)


def test_a_body_of_no_stated_size_is_as_large_as_usual_and_says_so(tmp_path: Path) -> None:
    found = read_surface(write(Surface(cube(2).vertices * [1, 1.5, 2], cube(2).triangles), tmp_path / "box.ply"))
    assert found.unit_mm == 25
    for part in ("box.ply", "longest side is 100 mm", "(50 x 75 x 100 mm)", "--longest", "--height", "--unit"):
        assert part in found.size_note
    assert read_surface(tmp_path / "box.ply", longest_mm=8).unit_mm == 2
    assert read_surface(tmp_path / "box.ply", height_mm=6).unit_mm == 2
    assert not read_surface(tmp_path / "box.ply", unit="cm").size_note


@pytest.mark.parametrize(("edge", "unit_mm"), [(0.08, 1000), (2.5, 1000), (80, 1.25), (0.0005, 200_000)])
def test_gltf_is_in_metres_where_that_is_plausible(tmp_path: Path, edge: float, unit_mm: float) -> None:
    found = read_surface(write(cube(edge), tmp_path / "cube.glb"))
    assert found.unit_mm == pytest.approx(unit_mm, rel=1e-5)
    assert ("metre" in found.size_note) == (unit_mm == 1000)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"unit": "inch"}, "inch"),
        ({"unit": "mm", "height_mm": 3.0}, "both unit and height"),
        ({"longest_mm": 3.0, "height_mm": 3.0}, "both height and longest"),
        ({"longest_mm": -1.0}, "longest"),
        ({"height_mm": 0.0}, "height"),
        ({"height_mm": float("nan")}, "height"),
    ],
)
def test_bad_options(tmp_path: Path, options: dict, words: str) -> None:
    path = write(cube(2), tmp_path / "cube.ply")
    with pytest.raises(InputError, match=words):
        read_surface(path, **options)


@pytest.mark.parametrize(
    ("name", "content", "words"),
    [
        ("a.txt", "x", "extension"),
        ("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n", "0 triangles"),
        ("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n", "triangle 0"),
        ("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 -9\n", "line 4"),
        ("a.obj", "v 0 0\n", "line 1"),
        ("a.obj", "v 0 0 0\nv 1 0 inf\nv 0 1 0\nf 1 2 3\n", "vertex 1"),
        ("a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 7\n", "triangle 0"),
        ("a.off", "OFF\n3 9 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n", "9 faces announced"),
        ("a.off", "OFF\n3 1 0\n0 0 nan\n1 0 0\n0 1 0\n3 0 1 2\n", "vertex 0"),
        ("a.off", "", "OFF"),
        ("a.ply", "", "PLY"),
        ("a.ply", "ply\nformat ascii 1.0\nend_header\n", "0 vertices"),
        ("a.stl", "solid nothing", "STL|0 triangles"),
        ("a.glb", "glTF", "GLB"),
        ("a.gltf", "{}", "GLTF|0 triangles"),
    ],
)
def test_unusable_files_are_refused(tmp_path: Path, name: str, content: str, words: str) -> None:
    path = tmp_path / name
    path.write_text(content)
    with pytest.raises(InputError, match=words) as refusal:
        read_surface(path, unit="mm")
    assert str(path) in str(refusal.value)


def test_truncated_binary_files_are_refused(tmp_path: Path) -> None:
    for extension in ("ply", "stl", "glb"):
        path = write(icosphere(1), tmp_path / f"ball.{extension}")
        path.write_bytes(path.read_bytes()[:-40])
        with pytest.raises(InputError, match=f"ball.{extension}"):
            read_surface(path, unit="mm")


def test_missing_file(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="No such file"):
        read_surface(tmp_path / "none.ply", unit="mm")


def test_bundled_bunny(bunny_path: Path) -> None:
    source = read_surface(bunny_path, height_mm=100)
    assert source.surface.is_closed_manifold
    assert source.surface.volume > 0
    assert np.ptp(source.surface.vertices[:, 1]) == pytest.approx(100)


def test_a_pipe_is_no_mesh(tmp_path: Path) -> None:
    """Nobody writes into it: reading it would never end."""
    os.mkfifo(tmp_path / "pipe.ply")
    with pytest.raises(InputError, match=r"pipe\.ply: cannot be read: no regular file"):
        read_surface(tmp_path / "pipe.ply", unit="mm")
