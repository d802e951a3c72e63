"""Several meshes into one file: where they lie, how they are named, and which of them are refused."""

from __future__ import annotations

import json

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from quadgraph.baking import kept, scene_bodies
from quadgraph.baking.bodies import BodyMesh, bake_bodies, meshes_as_they_lie, parts_as_bodies
from quadgraph.baking.pipeline import BakeOptions, bake
from quadgraph.baking.placing import BodyPlacement, hosts_of
from quadgraph.base.errors import InputError
from quadgraph.commands import scene_file
from quadgraph.file import qgraph_file
from quadgraph.mesh import named_parts
from quadgraph.mesh.surface import Surface
from shapes import cube, icosphere, join, moved, torus, write_obj

_core = pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")


@pytest.fixture(scope="module")
def meshes(tmp_path_factory) -> dict:
    folder = tmp_path_factory.mktemp("meshes")
    shapes = {"ball": icosphere(2, 5.0), "ring": torus(8.0, 2.0, 32, 16), "box": cube(4.0)}
    return {name: write_obj(shape, folder / f"{name}.obj") for name, shape in shapes.items()}


@pytest.fixture(scope="module")
def baked(meshes, tmp_path_factory):
    """A ball, and a ring that is turned, made smaller and moved; its report and its file."""
    path = tmp_path_factory.mktemp("baked") / "two.qgraph"
    placed = [
        BodyMesh("the ball", meshes["ball"], unit="mm"),
        BodyMesh("ring", meshes["ring"], BodyPlacement((1.0, 2.0, 14.0), (30.0, 20.0, 10.0), 0.9), "mm"),
    ]
    return bake_bodies(placed, path, BakeOptions(visibility_rays=16)), path


def test_bodies_lie_where_they_are_placed(meshes, baked):
    loaded = _core.load(baked[1])
    level, vertices = loaded.levels[0], loaded.display["vertices"]
    ring = level.tet_bodies[level.face_tets[loaded.display["face"]]] == 1
    turned = Rotation.from_euler("xyz", [30, 20, 10], degrees=True).as_matrix()
    expected = 0.9 * torus(8.0, 2.0, 32, 16).vertices @ turned.T + [1, 2, 14]
    assert np.allclose(np.sort(vertices[ring], axis=0), np.sort(expected, axis=0), atol=1e-5)
    assert np.allclose(np.linalg.norm(vertices[~ring], axis=1), 5, atol=1e-5)


def test_the_file_and_the_report_tell_of_each_body(baked):
    report, path = baked
    bodies = qgraph_file.read(path).metadata["bodies"]
    assert [body["name"] for body in bodies] == ["the ball", "ring"]
    assert bodies[1]["position"] == [1, 2, 14]
    assert bodies[0]["volume_mm3"] == pytest.approx(4 / 3 * np.pi * 125, rel=0.06)
    assert sum(body["tets"] for body in bodies) == report.levels[0]["tets"]
    assert sum(body["volume_mm3"] for body in bodies) == pytest.approx(report.levels[0]["volume_mm3"])
    assert any(note.startswith("ring: ") for note in report.notes)


def test_one_body_of_a_file_is_as_it_bakes_alone(meshes, tmp_path):
    options = BakeOptions(unit="mm", visibility_rays=0)
    bake(meshes["ball"], tmp_path / "alone.qgraph", options)
    bake_bodies([BodyMesh("ball", meshes["ball"], unit="mm")], tmp_path / "named.qgraph", options)
    alone, named = (qgraph_file.read(tmp_path / f"{name}.qgraph").sections for name in ("alone", "named"))
    for name, array in alone.items():
        if name != "metadata":
            assert np.array_equal(array, named[name]), name


def test_a_body_may_be_solved_on_fewer_vertices_than_another(meshes, tmp_path):
    beside = BodyPlacement((21, 0, 0))
    placed = [
        BodyMesh("ring", meshes["ring"], unit="mm", surface_vertices=120),
        BodyMesh("other", meshes["ring"], beside, "mm"),
    ]
    bake_bodies(placed, tmp_path / "two.qgraph", BakeOptions(visibility_rays=0))
    level = _core.load(tmp_path / "two.qgraph").levels[0]
    faces = np.bincount(level.tet_bodies[level.face_tets])
    assert faces[0] == pytest.approx(240, rel=0.1)
    assert faces[1] == 2 * 32 * 16


def test_the_same_bodies_give_the_same_bytes(meshes, tmp_path):
    for name in ("a", "b"):
        beside = BodyPlacement((12, 0, 0))
        placed = [BodyMesh("ball", meshes["ball"], unit="mm"), BodyMesh("box", meshes["box"], beside, "mm")]
        bake_bodies(placed, tmp_path / f"{name}.qgraph", BakeOptions(visibility_rays=8))
    assert (tmp_path / "a.qgraph").read_bytes() == (tmp_path / "b.qgraph").read_bytes()


REFUSED = {
    "cut each other": (cube(4.0), moved(cube(4.0), 3, 1, 1), "one and two cut or touch each other"),
    "touch in a face": (cube(4.0), moved(cube(4.0), 4, 0, 0), "one and two cut or touch each other"),
    "touch in a part of a face": (cube(4.0), moved(cube(2.0), 3, 0.1, 0.3), "one and two cut or touch each other"),
    "touch from inside": (cube(4.0), moved(cube(1.0), 1.5, 0, 0), "one and two cut or touch each other"),
    "in part": (cube(4.0), join(cube(1.0), moved(cube(1.0), 6, 0, 0)), "1 of the 2 pieces of two lie within one"),
    "around its cavity": (
        join(cube(6.0), Surface(cube(2.0).vertices, cube(2.0).triangles[:, ::-1])),
        cube(4.0),
        "lie within each other in part, as where one is around a cavity",
    ),
}


@pytest.mark.parametrize(("one", "two", "message"), REFUSED.values(), ids=REFUSED)
def test_bodies_that_are_not_apart_are_refused_by_name(one, two, message):
    with pytest.raises(InputError, match=message):
        hosts_of([one, two], ["one", "two"])


def test_a_body_may_lie_in_a_cavity_or_in_a_hole():
    hollow = cube(4.0)
    hole = cube(2.0)
    inner = type(hole)(hole.vertices, hole.triangles[:, ::-1])
    assert hosts_of([join(hollow, inner), cube(1.0)], ["hollow", "stone"]) == [None, None]
    assert hosts_of([torus(8.0, 2.0), icosphere(2, 3.0)], ["ring", "ball"]) == [None, None]
    assert hosts_of([cube(1.0), cube(4.0), moved(cube(1.0), 9, 0, 0), cube(2.0)], list("abcd")) == [3, None, None, 1]


def test_a_refused_bake_leaves_nothing(meshes, tmp_path):
    placed = [BodyMesh("a", meshes["ball"], unit="mm"), BodyMesh("b", meshes["box"], BodyPlacement((4, 0, 0)), "mm")]
    with pytest.raises(InputError, match="a and b cut or touch"):
        bake_bodies(placed, tmp_path / "two.qgraph", BakeOptions())
    with pytest.raises(InputError, match="'a' found twice"):
        bake_bodies([placed[0], placed[0]], tmp_path / "two.qgraph", BakeOptions())
    with pytest.raises(InputError, match="polygrid"):
        bake_bodies(placed, tmp_path / "two.qgraph", BakeOptions(mesher="polygrid"))
    assert not list(tmp_path.iterdir())


def test_files_in_common_coordinates_keep_their_proportions(tmp_path):
    shapes = {"a": icosphere(2, 5.0), "b": moved(cube(2.0), 14, 0, 0)}
    paths = [write_obj(shape, tmp_path / f"{name}.obj") for name, shape in shapes.items()]
    placed = meshes_as_they_lie(paths, BakeOptions(longest_mm=40.0))
    assert [each.name for each in placed] == ["a", "b"]
    bake_bodies(placed, tmp_path / "ab.qgraph", BakeOptions(longest_mm=40.0, visibility_rays=0))
    found = _core.load(tmp_path / "ab.qgraph").display["vertices"]
    assert np.ptp(found[:, 0]) == pytest.approx(40, rel=1e-6)
    assert np.ptp(found[:, 1]) == pytest.approx(20, rel=1e-6)


def scene(meshes, **members) -> dict:
    return {"bodies": [{"mesh": meshes["ball"].name, "unit": "mm"} | members]}


WRONG = {
    "no list": ({"bodies": {}}, r"^/bodies: found"),
    "none": ({"bodies": []}, r"^/bodies: found"),
    "both": ({"bodies": [{"mesh": "ball.obj"}], "body": "a.qgraph"}, r'^/body: .*either "body"'),
    "no mesh": ({"bodies": [{"name": "a"}]}, r"^/bodies/0: mesh is missing"),
    "a baked file": ({"bodies": [{"mesh": "a.qgraph"}]}, r"^/bodies/0/mesh: found 'a.qgraph'"),
    "a member": ({"bodies": [{"mesh": "ball.obj", "colour": 1}]}, r"^/bodies/0/colour: unknown, allowed are name"),
    "two sizes": ({"bodies": [{"mesh": "ball.obj", "unit": "mm", "longest": "3mm"}]}, r"^/bodies/0/longest: found"),
    "a size": ({"bodies": [{"mesh": "ball.obj", "longest": 80}]}, r'^/bodies/0/longest: found \'80\'.*"80mm"'),
    "a unit": ({"bodies": [{"mesh": "ball.obj", "unit": "inch"}]}, r"^/bodies/0/unit: found 'inch', allowed is mm"),
    "a place": ({"bodies": [{"mesh": "ball.obj", "position": [1, 2]}]}, r"^/bodies/0/position: found"),
    "no number": ({"bodies": [{"mesh": "ball.obj", "rotation": [0, True, 0]}]}, r"^/bodies/0/rotation: found"),
    "infinity": ({"bodies": [{"mesh": "ball.obj", "position": [0, 0, float("inf")]}]}, r"^/bodies/0/position: "),
    "no double": ({"bodies": [{"mesh": "ball.obj", "position": [0, 10**400, 0]}]}, r"^/bodies/0/position: .*inf"),
    "no double's size": ({"bodies": [{"mesh": "ball.obj", "scale": 10**400}]}, r"^/bodies/0/scale: inf found"),
    "half a character": ({"bodies": [{"mesh": "ball.obj", "name": "\ud800"}]}, r"^/bodies/0/name: found '.*ud800'"),
    "half a character's file": ({"bodies": [{"mesh": "\ud800.obj"}]}, r"^/bodies/0/mesh: found"),
    "half a vertex": (
        {"bodies": [{"mesh": "ball.obj", "surface_vertices": 9.5}]},
        r"^/bodies/0/surface_vertices: found '9.5'",
    ),
    "no vertices": ({"bodies": [{"mesh": "ball.obj", "surface_vertices": 0}]}, r"^/bodies/0/surface_vertices: 0 found"),
    "no size": ({"bodies": [{"mesh": "ball.obj", "scale": 0}]}, r"^/bodies/0/scale: 0.0 found"),
    "a name": ({"bodies": [{"mesh": "ball.obj", "name": "a/b"}]}, r"^/bodies/0/name: 'a/b' found"),
    "names": ({"bodies": [{"mesh": "ball.obj"}, {"mesh": "ball.obj"}]}, r"^/bodies/1/name: 'ball' found twice"),
    "a material twice": (
        {"bodies": [{"mesh": "ball.obj", "material": "jade"}], "materials": {"ball": "wax"}},
        r"^/materials/ball: found 'wax'",
    ),
    "a track": ({"bodies": [{"mesh": "ball.obj"}], "tracks": [{"path": "/bodies/0/position"}]}, r"^/tracks/0/path"),
}


@pytest.mark.parametrize(("document", "message"), WRONG.values(), ids=WRONG)
def test_what_a_scene_may_not_say_of_bodies(document, message, tmp_path):
    with pytest.raises(InputError, match=message):
        scene_bodies.read(document, tmp_path)


def test_a_scene_without_names_takes_those_of_files(meshes):
    found = scene_bodies.read(scene(meshes, material="jade") | {"camera": {"azimuth": 5}}, meshes["ball"].parent)
    assert [body.name for body in found.meshes] == ["ball"]
    assert found.document == {"camera": {"azimuth": 5}, "materials": {"ball": "jade"}}
    assert json.dumps(found.with_body(meshes["ball"]))


def test_a_wrong_material_is_named_where_the_scene_says_it(meshes, tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    path = meshes["ball"].parent / "wrong.json"
    path.write_text(json.dumps(scene(meshes, material={"name": "jade", "eta": 9})))
    with pytest.raises(InputError, match=r"wrong.json: /bodies/0/material: .*'eta'"), scene_file.opened(path):
        pass


def test_the_bodies_of_a_scene_are_baked_once(meshes, tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    told: list[str] = []

    def body(**members):
        found = scene_bodies.read(scene(meshes, **members), meshes["ball"].parent)
        with kept.bodies_of(tmp_path / "scene.json", found.meshes, told.append) as path:
            return path

    first = body()
    assert first.name == "scene.qgraph"
    assert any("baked scene.json" in text for text in told)
    told.clear()
    assert body(material="jade") == first
    assert not told
    assert body(position=[1, 0, 0]) != first


def write_parts(path):
    """An OBJ of two objects, or a GLB of two nodes: a lid and a pot."""
    import trimesh

    lid, pot = moved(cube(2.0), 0, 10, 0), icosphere(2, 4.0)
    if path.suffix == ".glb":
        scene = trimesh.Scene()
        for name, shape in (("lid", lid), ("pot", pot)):
            scene.add_geometry(trimesh.Trimesh(shape.vertices, shape.triangles), node_name=name)
        path.write_bytes(scene.export(file_type="glb"))
        return path
    both = join(lid, pot)
    text = [f"v {x:.9g} {y:.9g} {z:.9g}" for x, y, z in both.vertices]
    faces = [f"f {a} {b} {c}" for a, b, c in both.triangles + 1]
    path.write_text("\n".join([*text, "o lid", *faces[:12], "o pot", *faces[12:]]))
    return path


@pytest.mark.parametrize("ending", ["obj", "glb"])
def test_named_parts_of_a_file_are_bodies(ending, tmp_path):
    mesh = write_parts(tmp_path / f"pot.{ending}")
    options = BakeOptions(longest_mm=30.0, visibility_rays=0)  # of the whole, which is 15 units high
    placed = parts_as_bodies(mesh, options)
    assert [body.name for body in placed] == ["lid", "pot"]
    bake_bodies(placed, tmp_path / "pot.qgraph", options)
    boxes = {body["name"]: body["box_mm"] for body in qgraph_file.read(tmp_path / "pot.qgraph").metadata["bodies"]}
    assert np.allclose(boxes["lid"], [[-2, 18, -2], [2, 22, 2]], atol=1e-4)
    assert np.allclose(np.ptp(boxes["pot"], axis=0), 16, atol=0.6)
    found = scene_bodies.read({"bodies": [{"mesh": mesh.name, "part": "lid", "unit": "cm"}]}, tmp_path)
    assert (found.meshes[0].name, found.meshes[0].part) == ("lid", "lid")


def test_parts_that_are_not_there_are_named(tmp_path):
    mesh = write_parts(tmp_path / "pot.obj")
    with pytest.raises(InputError, match=r"part: 'top' found, the file has 'lid', 'pot'"):
        bake_bodies([BodyMesh("top", mesh, part="top")], tmp_path / "x.qgraph", BakeOptions())
    alone = write_obj(cube(2.0), tmp_path / "cube.obj")
    with pytest.raises(InputError, match="parts: one found"):
        parts_as_bodies(alone, BakeOptions())
    (tmp_path / "cube.stl").write_bytes(b"solid x\nendsolid x\n")
    with pytest.raises(InputError, match=r"stl' file names no parts"):
        named_parts.names(tmp_path / "cube.stl")
