"""PLY files of all types and byte orders are read as pymeshlab reads them, and others are refused by name."""

from __future__ import annotations

import itertools
import tracemalloc
from pathlib import Path

import numpy as np
import pymeshlab
import pytest
from ply_files import ply_bytes

from quadgraph.base.errors import InputError
from quadgraph.mesh.mesh_io import read_surface
from quadgraph.mesh.ply import read_ply

FORMS = ("ascii", "binary_little_endian", "binary_big_endian")
POINTS = [(0.1, 0, 0), (1, 0, 0.25), (1, 1, 0), (0, 1, -3.5), (0.5, 0.5, 1e-3), (2, 0, 7)]
XYZ = [("float", "x"), ("float", "y"), ("float", "z")]
LIST_TYPES = list(itertools.product(["char", "ushort", "uint"], ["char", "uchar", "uint"]))
FACES = [("uchar", "int", "vertex_indices")]
POLYGONS = [(0, 1, 2), (0, 1, 2, 3), (4, 3, 2, 1, 0), (5, 4, 0), (0, 1, 2, 0), (1, 1, 2)]


def theirs(path: Path) -> tuple[np.ndarray, np.ndarray]:
    meshes = pymeshlab.MeshSet()
    meshes.load_new_mesh(str(path))
    return meshes.current_mesh().vertex_matrix(), meshes.current_mesh().face_matrix()


def written(tmp_path: Path, *arguments) -> Path:
    path = tmp_path / "body.ply"
    path.write_bytes(ply_bytes(*arguments))
    return path


def agrees(path: Path) -> None:
    for ours, other in zip(read_ply(path), theirs(path), strict=True):
        np.testing.assert_array_equal(ours, other)


@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize("kind", ["float", "double"])
@pytest.mark.parametrize(
    "faces", [[(i, i + 1, i + 2) for i in range(4)], [(0, 1, 2, 3)] * 3, POLYGONS], ids=["triangles", "quads", "mixed"]
)
def test_faces_are_read_as_pymeshlab_does(tmp_path, form, kind, faces):
    vertex = ("vertex", [(kind, axis) for axis in "xyz"], POINTS)
    path = written(tmp_path, form, [vertex, ("face", FACES, [(face,) for face in faces])])
    np.testing.assert_array_equal(read_ply(path)[1], theirs(path)[1])
    turned = (form, kind) != ("binary_big_endian", "double")  # whose bytes pymeshlab does not turn
    np.testing.assert_array_equal(read_ply(path)[0], theirs(path)[0] if turned else POINTS)


def test_what_is_not_wanted_is_skipped(tmp_path):
    vertex = [("uchar", "float", "before"), ("uchar", "red"), *XYZ, ("double", "quality")]
    points = [([0.5] * (i % 3), 200, *point, 0.25) for i, point in enumerate(POINTS)]
    face = [("short", "flags"), *FACES, ("uchar", "float", "weights")]
    faces = [(0, face, [0.25] * (2 * len(face))) for face in POLYGONS]
    other = ("material", [("int", "id"), ("int", "short", "links")], [(7, (1, 2)), (8, ()), (9, (1,))])
    tables = [other, ("vertex", vertex, points), other, ("face", face, faces), other]
    agrees(written(tmp_path, "ascii", tables))
    wanted = read_ply(tmp_path / "body.ply")
    for form in FORMS[1:]:  # where pymeshlab loses its place
        for ours, known in zip(read_ply(written(tmp_path, form, tables)), wanted, strict=True):
            np.testing.assert_array_equal(ours, known)


@pytest.mark.parametrize("form", FORMS)
def test_strips_are_read_as_pymeshlab_does(tmp_path, form):
    strips = [((0, 1, 2, 3, -1, 1, 2, 3, 4, 5),), ((0, 1, 2, -1, 1, 2, 3, 4, -1),), ((3, 4, 5),)]
    lists = [("int", "int", "vertex_indices")]
    agrees(written(tmp_path, form, [("vertex", XYZ, POINTS), ("tristrips", lists, strips)]))


@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize(("count", "item"), LIST_TYPES)
def test_lists_and_positions_have_any_whole_type(tmp_path, form, count, item):
    corners = [(0, 0, 0), (9, 0, 0), (0, 8, 0), (0, 0, -7)]
    faces = [((0, 1, 2),), ((0, 3, 1),), ((0, 2, 3, 1),)]
    vertex = ("vertex", [("short", "x"), ("int", "y"), ("char", "z")], corners)
    vertices, triangles = read_ply(written(tmp_path, form, [vertex, ("face", [(count, item, "vertex_index")], faces)]))
    assert vertices.tolist() == [list(corner) for corner in corners]
    assert triangles.tolist() == [[0, 1, 2], [0, 3, 1], [0, 2, 3], [0, 3, 1]]


def test_text_is_free_in_its_lines(tmp_path):
    path = tmp_path / "body.ply"
    head, _, body = ply_bytes("ascii", [("vertex", XYZ, POINTS), ("face", FACES, [((0, 1, 2),)] * 2)]).partition(
        b"end_header\n"
    )
    for content in (
        head + b"end_header\n" + body.replace(b"\n", b" "),
        (head + b"end_header\n" + body).replace(b"\n", b"\r\n"),
        head + b"end_header\n" + body.replace(b"0 1 2", b"0\n1\n2"),
        head + b"end_header\n" + body + b"\xff what follows is not read\n",
    ):
        path.write_bytes(content)
        agrees(path)


def test_a_lost_vertex_that_no_face_has_is_left_out(tmp_path):
    points = [POINTS[0], (float("nan"), 0, 0), *POINTS[1:]]
    agrees(written(tmp_path, "binary_little_endian", [("vertex", XYZ, points), ("face", FACES, [((0, 2, 3),)])]))
    path = written(tmp_path, "ascii", [("vertex", XYZ, points), ("face", FACES, [((0, 1, 3),)])])
    with pytest.raises(InputError, match=r"vertex 1: position \[nan"):
        read_surface(path, unit="mm")


def test_many_polygons_of_mixed_lengths(tmp_path):
    random = np.random.default_rng(3)
    points = random.normal(size=(500, 3)).tolist()
    faces = [(random.integers(0, 500, size=count).tolist(),) for count in random.integers(3, 200, size=3000)]
    agrees(written(tmp_path, "binary_big_endian", [("vertex", XYZ, points), ("face", FACES, faces)]))


def refused(path: Path, content: bytes) -> str:
    path.write_bytes(content)
    with pytest.raises(InputError) as error:
        read_surface(path, unit="mm")
    assert str(path) in str(error.value)
    assert len(str(error.value)) < 480
    return str(error.value)


TRIANGLE = [("vertex", XYZ, POINTS), ("face", FACES, [((0, 1, 2),), ((0, 1, 3),)])]


@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize(
    ("tables", "words"),
    [
        ([("vertex", XYZ[:2], [(0, 1)] * 3), TRIANGLE[1]], "element vertex: properties x, y found, a number 'z'"),
        ([("vertex", XYZ, POINTS), ("face", [("int", "a")], [(1,)])], "element face: properties a found, a list"),
        ([TRIANGLE[0], ("face", [("uchar", "float", "vertex_index")], [((0, 1, 2),)])], "a list of float32 found"),
        ([TRIANGLE[0], ("face", FACES, [((0, 1, 2),), ((0, 1),)])], "element face, row 1: a list of 2 found"),
        ([TRIANGLE[0], ("face", FACES, [((0, 1, 6),)])], "vertex indices [0, 1, 6] found, allowed are 0 to 5"),
        ([TRIANGLE[0], ("face", FACES, [((0, 1, -2),)])], "vertex indices [0, 1, -2] found, allowed are 0 to 5"),
        ([TRIANGLE[0], *TRIANGLE], "element vertex: stated twice"),
        ([TRIANGLE[1]], "vertex indices [0, 1, 2] found, but there are no vertices"),
        ([TRIANGLE[0]], "0 triangles"),
    ],
)
def test_refusals_name_what_was_found(tmp_path, form, tables, words):
    assert words in refused(tmp_path / "bad.ply", ply_bytes(form, tables))


@pytest.mark.parametrize("form", FORMS)
def test_every_file_that_is_cut_off_is_refused(tmp_path, form):
    whole = ply_bytes(form, [("vertex", XYZ, POINTS), ("face", FACES, [(face,) for face in POLYGONS])])
    last = len(whole) - (2 if form == "ascii" else 1)  # the last digit of a text, of which one may remain
    for size in range(0, last, 7):
        refused(tmp_path / "cut.ply", whole[:size])


@pytest.mark.parametrize(
    ("row", "words"),
    [
        (b"3 0 1_0 3", "'1_0' is no number"),
        (b"3 0 .5 3", "0.5 found, allowed are whole numbers"),
        (b"2.5 0 1 3", "a list of 2.5 found"),
        (b"3 0 nan 3", "nan found, allowed are whole numbers"),
    ],
)
def test_text_that_cannot_be_used_is_repeated(tmp_path, row, words):
    assert words in refused(tmp_path / "bad.ply", ply_bytes("ascii", TRIANGLE).replace(b"3 0 1 3", row))


def test_memory_goes_by_the_file_and_not_by_its_header(tmp_path):
    """What a header says of rows without values, or of more than there is, takes nothing."""
    path = tmp_path / "bad.ply"
    whole = ply_bytes("ascii", TRIANGLE)
    huge = str(10**18).encode()
    for content in (
        whole.replace(b"element face 2", b"element face " + huge),
        whole.replace(b"element vertex 6", b"element vertex " + huge),
        whole.replace(b"element face 2", b"element nothing " + huge + b"\nelement face 3"),
    ):
        path.write_bytes(content)
        tracemalloc.start()
        with pytest.raises(InputError):
            read_ply(path)
        peak = tracemalloc.get_traced_memory()[1]
        tracemalloc.stop()
        assert peak < 1 << 20
