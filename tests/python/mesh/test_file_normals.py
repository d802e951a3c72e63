"""Normals of mesh files are those of the displayed surface: hard edges stay hard, smooth ones smooth, at any angle."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from gltf_files import Builder
from quadgraph.baking import bare, pipeline
from quadgraph.baking.bodies import BodyMesh, bake_bodies
from quadgraph.baking.placing import BodyPlacement
from quadgraph.base.errors import InputError
from quadgraph.file import qgraph_file
from quadgraph.mesh.creases import parted, unit
from quadgraph.mesh.looks import file_normals
from quadgraph.mesh.surface import FileFrame, Surface
from shapes import cube, icosphere, join, moved, write_obj

TOL = 1e-5  # of normals that went through texts and single precision


def flat(surface: Surface) -> np.ndarray:
    """(m, 3, 3) the triangles' own normals at their corners."""
    return np.repeat(unit(surface.doubled_normals)[:, None], 3, axis=1)


def radial(surface: Surface) -> np.ndarray:
    """(m, 3, 3) normals away from 0 at the corners."""
    return unit(surface.corners)


def obj(surface: Surface, normals: np.ndarray, path: Path) -> Path:
    lines = ["v {} {} {}".format(*place) for place in surface.vertices]
    lines += ["vn {} {} {}".format(*normal) for normal in normals.reshape(-1, 3)]
    for f, corners in enumerate(surface.triangles + 1):
        lines.append("f " + " ".join(f"{corner}//{3 * f + k + 1}" for k, corner in enumerate(corners)))
    path.write_text("\n".join(lines) + "\n")
    return path


def ply(surface: Surface, normals: np.ndarray, path: Path, names: tuple[str, ...] = ("nx", "ny", "nz")) -> Path:
    """Each corner has a vertex of its own."""
    rows = np.column_stack([surface.corners.reshape(-1, 3), normals.reshape(-1, 3)[:, : len(names)]])
    header = ["ply", "format ascii 1.0", f"element vertex {len(rows)}"]
    header += [f"property float {name}" for name in ("x", "y", "z", *names)]
    header += [f"element face {len(surface.triangles)}", "property list uchar int vertex_indices", "end_header"]
    lines = [" ".join(map(repr, row)) for row in rows.tolist()]
    lines += [f"3 {3 * f} {3 * f + 1} {3 * f + 2}" for f in range(len(surface.triangles))]
    path.write_text("\n".join(header + lines) + "\n")
    return path


def glb(surface: Surface, normals: np.ndarray, path: Path, **node: object) -> Path:
    builder = Builder()
    own = Surface(surface.corners.reshape(-1, 3), np.arange(surface.triangles.size).reshape(-1, 3))
    mesh = builder.mesh(own, NORMAL=builder.add(normals.reshape(-1, 3)))
    builder.document["nodes"] = [{"mesh": mesh} | node]
    return builder.write(path)


def found(path: Path, surface: Surface) -> file_normals.FoundNormals:
    return file_normals.find(path, surface, FileFrame().placed)


@pytest.mark.parametrize(("write", "name"), [(obj, "a.obj"), (ply, "a.ply"), (glb, "a.glb")])
@pytest.mark.parametrize("make", [flat, radial])
def test_normals_of_each_format_come_to_their_corners(write, name, make, tmp_path):
    ball = icosphere(1, 10)
    normals = make(ball)
    got = found(write(ball, normals, tmp_path / name), ball)
    assert (got.rule, got.share, got.note) == ("file", 1.0, "")
    assert np.abs(got.at_corners - normals).max() < TOL


def test_a_hard_edge_stays_hard_and_a_smooth_one_smooth_at_any_angle():
    ball, box = icosphere(2, 10), cube(10)
    vertex, triangles, normals = parted(ball, flat(ball))  # edges of 10 to 15 degrees, all hard
    assert len(vertex) == 3 * len(ball.triangles)
    assert np.abs(normals[triangles] - flat(ball)).max() < 1e-12
    vertex, triangles, normals = parted(box, radial(box))  # edges of 90 degrees, all smooth
    assert np.array_equal(vertex, np.arange(8))
    assert np.abs(normals - unit(box.vertices)).max() < 1e-12


def test_corners_without_a_normal_get_computed_ones():
    box, given = cube(10), radial(cube(10))
    given[4:] = 0
    vertex, triangles, normals = parted(box, given)
    assert np.abs(normals[triangles][:4] - given[:4]).max() < 1e-12
    assert np.abs(normals[triangles][4:] - flat(box)[4:]).max() < 1e-12
    assert np.array_equal(vertex[triangles], box.triangles)


def test_nodes_of_gltf_turn_stretch_and_mirror_their_normals(tmp_path):
    ball = icosphere(2, 1)
    node = {"rotation": [0, 0, np.sin(0.3), np.cos(0.3)], "scale": [-1.0, 2.0, 3.0], "translation": [5.0, 0.0, 0.0]}
    got = file_normals.read(glb(ball, radial(ball), tmp_path / "a.glb", **node))
    assert got is not None
    c, s = np.cos(0.6), np.sin(0.6)
    turn = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
    local = (got[0] - [5, 0, 0]) @ turn  # on the ellipsoid of half axes 1, 2, 3
    expected = unit(local / [1, 4, 9]) @ turn.T
    assert np.abs(unit(got[1]) - expected).max() < TOL


def test_normals_on_the_wrong_side_are_left_out_and_told(tmp_path):
    ball = icosphere(1, 10)
    normals = radial(ball)
    assert "point into" in found(obj(ball, -normals, tmp_path / "all.obj"), ball).note
    assert found(tmp_path / "all.obj", ball).rule == "angle"
    normals[:3] *= -1
    normals[3, 0], normals[4, 1] = 0, np.nan
    some = found(obj(ball, normals, tmp_path / "some.obj"), ball)
    assert some.rule == "file"
    assert "11 of 240 corners" in some.note
    assert not some.at_corners[:3].any()
    assert np.isfinite(some.at_corners).all()
    assert np.allclose(np.linalg.norm(some.at_corners[5:], axis=2), 1)
    none = found(obj(ball, 0 * normals, tmp_path / "none.obj"), ball)
    assert none.rule == "angle"
    assert "of no length" in none.note


def test_files_without_normals_are_as_before(tmp_path):
    ball = icosphere(1, 10)
    got = found(write_obj(ball, tmp_path / "a.obj"), ball)
    assert (got.rule, got.at_corners, got.note) == ("angle", None, "")
    (tmp_path / "b.off").write_text("OFF\n")
    assert file_normals.read(tmp_path / "b.off") is None


def test_obj_files_are_read_in_whatever_way_they_are_written(tmp_path):
    """Corners without a normal, counted from the end, lines that are moved to the right, polygons of several sizes."""
    head = ["v 0 0 0", "v 1 0 0", "v 1 1 0", "v 0 1 0", "v .5 .5 1"]
    normals = ["vn 0 0 -2", "vn 1 0 1", "vn 0 1 1"]
    plain = "\n".join([*head, *normals, "f 1//1 2//2 3//3", "f 1/7/1 3/8/3 4/9/2"])
    (tmp_path / "plain.obj").write_text(plain)
    other = "\n".join([*head, "  vn 0 0 -2", *normals[1:], "f -5//-3 -4//-2 -3//-1", "f 1//1 3//3 4//2"])
    (tmp_path / "other.obj").write_text(other)
    for found, expected in zip(
        *(file_normals.read(tmp_path / f"{name}.obj") for name in ("plain", "other")), strict=True
    ):
        assert np.array_equal(found, expected)
    (tmp_path / "some.obj").write_text("\n".join([*head, *normals, "f 1//1 2 3/1/3", "f 1//1 2//2 3//3 4//1"]))
    soup = file_normals.read(tmp_path / "some.obj")
    assert soup is not None
    assert soup[1].tolist()[0] == [[0, 0, -2], [0, 0, 0], [0, 1, 1]]
    assert soup[0].shape == (3, 3, 3)


def refused(path: Path, words: str) -> None:
    with pytest.raises(InputError, match=words) as error:
        found(path, icosphere(1, 10))
    assert path.name in str(error.value)


def test_normals_that_cannot_be_read_are_refused_by_name(tmp_path):
    ball = icosphere(1, 10)
    text = obj(ball, radial(ball), tmp_path / "a.obj").read_text()
    for old, new, words in (
        ("//1 ", "//999 ", r"normal 999, but there are 240 \(vn\).*--normals angle"),
        ("//1 ", "//-999 ", "line .*cannot read the normals"),
        ("vn ", "vn x", "line 43: cannot read the normals"),
    ):
        (tmp_path / "bad.obj").write_text(text.replace(old, new, 1))
        refused(tmp_path / "bad.obj", words)
    refused(ply(ball, radial(ball), tmp_path / "a.ply", ("nx", "ny")), "properties .* a number 'nz' is wanted")
    builder = Builder()
    mesh = builder.mesh(ball, NORMAL=builder.add(np.ones((5, 3))))
    builder.document["nodes"] = [{"mesh": mesh}]
    refused(builder.write(tmp_path / "a.glb"), "NORMAL: 5 x 3 numbers found, 42 x 3 are wanted.*--normals angle")
    with pytest.raises(InputError, match="normals: 'smooth' found"):
        file_normals.check("smooth")


def displayed(path: Path) -> tuple[Surface, np.ndarray, dict]:
    file = qgraph_file.read(path)
    vertices, triangles, normals = (file.sections[f"display/{name}"] for name in ("vertices", "triangles", "normals"))
    return Surface(vertices.astype(float), triangles.astype(np.int64)), normals[triangles], file.metadata


def test_a_bake_keeps_them_and_says_so(tmp_path):
    box = cube(10)
    mesh = obj(box, radial(box), tmp_path / "a.obj")
    for rule, share in (("file", 1.0), ("angle", 0.0)):
        report = pipeline.bake(mesh, tmp_path / "a.qgraph", pipeline.BakeOptions(unit="mm", up="z", normals=rule))
        shown, normals, metadata = displayed(tmp_path / "a.qgraph")
        assert metadata["normals"] == report.normals == {"rule": rule, "share": share}
        assert np.abs(normals - (radial(shown) if rule == "file" else flat(shown))).max() < TOL
    assert "smooth up to edges" in file_normals.sentence({"rule": "angle", "share": 0})


def test_repairs_keep_the_normals_of_triangles_that_stay(tmp_path):
    ball = icosphere(2, 10)
    doubled = join(ball, Surface(ball.vertices, ball.triangles[:5]))
    turned = Surface(doubled.vertices, np.concatenate([doubled.triangles[:1, ::-1], doubled.triangles[1:]]))
    normals = flat(ball)[np.r_[:320, :5]]
    report = pipeline.bake(obj(turned, normals, tmp_path / "a.obj"), tmp_path / "a.qgraph", pipeline.BakeOptions("mm"))
    shown, found_normals, metadata = displayed(tmp_path / "a.qgraph")
    assert report.repairs
    assert metadata["normals"] == {"rule": "file", "share": 1.0}
    assert np.abs(found_normals - flat(shown)).max() < TOL


def test_bodies_turn_their_normals_and_choose_their_rule(tmp_path):
    box = cube(10)
    mesh = obj(box, radial(box), tmp_path / "a.obj")
    turned = BodyPlacement((20.0, 0.0, 0.0), (0.0, 0.0, 30.0), 0.5)
    both = [BodyMesh("one", mesh, turned, "mm"), BodyMesh("two", mesh, unit="mm", normals="angle")]
    bake_bodies(both, tmp_path / "a.qgraph", pipeline.BakeOptions())
    shown, normals, metadata = displayed(tmp_path / "a.qgraph")
    assert [body["normals"]["rule"] for body in metadata["bodies"]] == ["file", "angle"]
    assert np.abs(normals[:12] - radial(moved(shown, -20, 0, 0))[:12]).max() < TOL
    assert np.abs(normals[12:] - flat(shown)[12:]).max() < TOL


@pytest.mark.parametrize("rule", ["file", "angle"])
def test_a_surface_alone_keeps_them_too(rule, tmp_path):
    ball = icosphere(1, 10)
    opened = Surface(ball.vertices, ball.triangles[:-3])
    bare.write(obj(opened, flat(opened), tmp_path / "a.obj"), tmp_path / "a.qgraph", "mm", normals=rule)
    shown, normals, metadata = displayed(tmp_path / "a.qgraph")
    assert metadata["normals"]["rule"] == rule
    assert (np.abs(normals - flat(shown)).max() < TOL) == (rule == "file")


def test_normals_of_a_wrap_are_computed(tmp_path):
    box = cube(10)
    options = pipeline.BakeOptions("mm", wrap=2.0)
    report = pipeline.bake(obj(box, radial(box), tmp_path / "a.obj"), tmp_path / "a.qgraph", options)
    assert report.normals == {"rule": "angle", "share": 0.0}
    assert any("wrapped surface are computed" in note for note in report.notes)
