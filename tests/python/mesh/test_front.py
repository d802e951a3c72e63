"""From which side a body is shown when nobody says so."""

from __future__ import annotations

import json

import numpy as np
import pytest

from quadgraph.baking import bare
from quadgraph.base.errors import FormatError, InputError
from quadgraph.file import qgraph_file
from quadgraph.mesh import front
from quadgraph.mesh.mesh_io import read_surface
from quadgraph.mesh.surface import Surface
from shapes import icosphere, write_obj

_core = pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")


def dented(azimuth: float) -> Surface:
    """A ball of radius 10 mm with furrows on the side from where `azimuth`, degrees, looks at it."""
    ball = icosphere(5, 10)
    turn = np.radians(azimuth)
    towards = ball.vertices @ (np.sin(turn), 0, np.cos(turn)) / 10
    depth = 0.03 * np.clip(4 * (towards - 0.6), 0, 1) * (1 + np.sin(4 * ball.vertices[:, 1]))
    return Surface(ball.vertices * (1 - depth)[:, None], ball.triangles)


@pytest.mark.parametrize("azimuth", [0, 45, 135, 180, 270])
def test_most_relief_is_in_front(azimuth):
    assert front.azimuth(dented(azimuth)) == azimuth


def test_without_plainly_more_it_is_z():
    assert front.azimuth(icosphere(3, 10)) == 0
    seen = front.reliefs(icosphere(5, 10))
    assert np.ptp(seen) < 0.02 * seen[0]


@pytest.mark.parametrize(
    ("mesh", "azimuths"),
    [("armadillo", (180,)), ("bunny", (0,)), ("fandisk", (135,)), ("igea", (0,)), ("spot", (135, 225))],
)
def test_real_bodies_show_their_faces(mesh, azimuths, shared):
    """The armadillo and the cow lie in their files with their backs to +z, the CAD part with its plain side."""
    surface = read_surface(shared / "meshes" / f"{mesh}.ply", height_mm=60).surface.compacted()
    assert front.azimuth(surface) in azimuths


def ridged(head: float) -> Surface:
    """A ball with furrows towards 90 degrees, a little less towards 270, and a head towards `head`."""
    body = icosphere(5, 10)
    side = body.vertices[:, 0] / 10
    furrows = np.clip(4 * (abs(side) - 0.6), 0, 1) * (1 + np.sin(4 * body.vertices[:, 1]))
    depth = np.where(side > 0, 0.03, 0.028) * furrows
    turn = np.radians(head)
    above = icosphere(4, 4).vertices + np.array([9 * np.sin(turn), 11, 9 * np.cos(turn)])
    vertices = np.concatenate([body.vertices * (1 - depth)[:, None], above])
    triangles = np.concatenate([body.triangles, icosphere(4, 4).triangles + len(body.vertices)])
    return Surface(vertices, triangles)


def test_of_two_sides_that_show_about_as_much_the_one_with_the_head():
    assert front.azimuth(ridged(90)) == 90
    assert front.azimuth(ridged(270)) == 270


def test_size_and_place_change_nothing():
    body = dented(135)
    moved = Surface(70 * body.vertices + (1e3, -2e3, 5), body.triangles)
    np.testing.assert_allclose(front.reliefs(moved), front.reliefs(body), rtol=0.02)


def test_a_surface_without_area_is_seen_from_z():
    assert front.azimuth(Surface(np.zeros((3, 3)), np.array([[0, 1, 2]]))) == 0


def test_an_azimuth_out_of_range_is_refused(tmp_path):
    with pytest.raises(InputError, match="front: 400 found, allowed are -180 to 360"):
        bare.write(tmp_path / "none.obj", tmp_path / "x.qgraph", "mm", front_degrees=400)


@pytest.mark.parametrize("front_degrees", ["left", True, 400, None])
def test_a_file_of_another_value_is_refused(tmp_path, front_degrees):
    path = tmp_path / "sphere.qgraph"
    bare.write(write_obj(icosphere(1, 10), tmp_path / "sphere.obj"), path, "mm")
    file = qgraph_file.read(path)
    sections = {name: array for name, array in file.sections.items() if name != "metadata"}
    qgraph_file.write_sections(path, file.metadata | {"front": front_degrees}, sections)
    with pytest.raises(FormatError, match=r"metadata: 'front' is .*, allowed are -180 to 360 degrees"):
        qgraph_file.read(path)


@pytest.fixture(scope="module")
def path(tmp_path_factory):
    path = tmp_path_factory.mktemp("front") / "dented.qgraph"
    bare.write(write_obj(dented(135), path.with_suffix(".obj")), path, "mm")
    return path


class TestWhatIsShown:
    """A picture, the usual lights, a scene and the engine's program look at the front of the file."""

    def test_the_file_keeps_it(self, path):
        assert qgraph_file.read(path).metadata["front"] == 135
        assert _core.load(path).front == 135

    def test_a_picture_without_view(self, path):
        engine = _core.Engine(path)
        engine.set_material("marble")
        engine.set_lights(_core.default_lights(front=engine.graph.front))
        assert _core.default_lights(front=135) == _core.default_lights("135,10")
        engine.solve(method="shortest-path")
        small = {"width": 48, "height": 48}
        ours = np.asarray(engine.render(**small).scattered)
        np.testing.assert_array_equal(ours, engine.render(view="135,10", **small).scattered)
        assert not np.array_equal(ours, engine.render(view="0,10", **small).scattered)
        np.testing.assert_array_equal(
            engine.render(up="z", **small).scattered, engine.render(view="0,10", up="z", **small).scattered
        )

    @pytest.mark.parametrize(
        ("camera", "azimuth"), [({}, 135), ({"elevation": 30}, 135), ({"azimuth": 20}, 20), ({"up": "z"}, 0)]
    )
    def test_a_scene(self, path, camera, azimuth):
        (path.parent / "scene.json").write_text(json.dumps({"body": path.name, "camera": camera}))
        scene = json.loads(_core.SceneFile(path.parent / "scene.json").at(0).json())
        assert scene["camera"]["azimuth"] == azimuth

    def test_a_scene_whose_body_is_missing(self, path):
        (path.parent / "lost.json").write_text(json.dumps({"body": "lost.qgraph"}))
        scene = json.loads(_core.SceneFile(path.parent / "lost.json").at(0).json())
        assert scene["camera"]["azimuth"] == 0
