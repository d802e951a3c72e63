"""Deformations from Python and in scene files."""

from __future__ import annotations

import json
import os
import struct
from pathlib import Path

import numpy as np
import pytest

from quadgraph import _core, cli
from quadgraph.base.errors import FormatError, InputError
from quadgraph.file import qgraph_file
from quadgraph.file.shapes_file import StoredShapes, from_gltf, of_moves
from quadgraph.mesh.surface import Surface

TINY = Path(__file__).resolve().parents[2] / "data" / "tiny.qgraph"

TETRAHEDRON = {
    "cage": [[-9, -9, -9], [30, -9, -9], [-9, 30, -9], [-9, -9, 30]],
    "triangles": [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]],
}
EVERY_KIND = [
    {"type": "twist", "axis": [0, 1, 0.5], "degrees": 90, "range": [0.2, 0.8]},
    {"type": "bend", "towards": [0, 0, 1], "degrees": 30, "centre": [0, 1, 0]},
    {"type": "taper", "factor": 0.5, "range_mm": [0, 1.5]},
    {"type": "stretch", "axis": [1, 0, 0], "factor": 2},
    {"type": "transform", "degrees": 20, "scale": 1.5, "translate": [1, 2, 3]},
    {"type": "lattice", "size": [1, 2, 1], "displacements": [[0, 0, 0], [1, 0, 0]], "basis": "linear"},
    {"type": "cage", **TETRAHEDRON, "moved": [[-9, -9, -9], [30, -9, -9], [-9, 33, -9], [-9, -9, 30]]},
]


@pytest.fixture(scope="module")
def engine():
    engine = _core.Engine(TINY, validation=True)
    engine.set_material("marble")
    engine.set_lights(["directional:0,-1,-1:1"])
    yield engine
    assert engine.validation_messages == []


def test_the_thickness_of_a_body_is_known_in_every_shape(engine):
    """In mean free paths, which is what a warning of the model goes by: it grows and shrinks with the body."""
    engine.set_material("sigma_s_prime=0.4,sigma_a=0.2")
    said = []
    for factor in (1, 1000):
        engine.set_deformation([{"type": "transform", "scale": factor}])
        said.append(engine.solve(correction=False)["model_warning"])
    engine.set_deformation([])
    said.append(engine.solve(correction=False)["model_warning"])
    engine.set_material("marble")
    assert said[:2] == [said[2], ""]
    assert "mean free paths" in said[2]


def test_every_kind_is_written_out_and_read_back_as_it_is():
    written = _core.check_deformation(EVERY_KIND)
    assert _core.check_deformation(written) == written
    assert json.loads(written)[0] == {**EVERY_KIND[0], "axis": [0, 1, 0.5]}


@pytest.mark.parametrize(
    ("deformer", "said"),
    [
        ({"type": "melt"}, "/1/type.*twist, bend"),
        ({"type": "twist", "degrees": "a lot"}, "/1/degrees.*a number"),
        ({"type": "twist", "factor": 2}, "/1/factor.*degrees"),
        ({"type": "stretch", "factor": 0}, "/1: stretch, factor.*0.001"),
        ({"type": "taper", "factor": 2, "range": [1, 0]}, "/1: taper, range"),
        ({"type": "cage", **TETRAHEDRON}, "/1/moved"),
        ({"type": "displaced", "shapes": "nowhere.qshapes", "frame": 0}, "/1/shapes.*cannot be read"),
    ],
)
def test_what_makes_no_sense_is_refused_with_its_place(engine, deformer, said):
    with pytest.raises(InputError, match=said):
        engine.set_deformation([{"type": "twist", "degrees": 1}, deformer])


def test_a_body_that_is_scaled_takes_in_so_much_more_light_and_comes_back(engine):
    rest = engine.solve()["energy"]["entered"]
    exitance = engine.surface_field()["exitance"]
    engine.set_deformation([{"type": "transform", "scale": 3}])
    report = engine.solve()
    assert report["deformed"] == ""
    assert np.allclose(report["energy"]["entered"], 9 * np.array(rest), rtol=1e-3)
    area = engine.surface_field()["area"].sum()
    engine.set_deformation([])
    engine.solve()
    field = engine.surface_field()
    assert area == pytest.approx(9 * field["area"].sum(), rel=1e-5)
    assert np.array_equal(field["exitance"], exitance)


def test_a_scene_file_deforms_and_moves_the_deformation(tmp_path):
    scene = {
        "body": str(TINY),
        "deformation": [{"type": "stretch", "factor": 1}],
        "tracks": [{"path": "/deformation/0/factor", "keys": [[0, 1], [4, 3]]}],
    }
    path = tmp_path / "scene.json"
    path.write_text(json.dumps(scene))
    file = _core.SceneFile(path)
    stage = _core.Stage(validation=True)
    heights = []
    for frame in (0, 2, 4):
        stage.show(file.at(frame))
        stage.solve()
        heights.append(np.ptp(stage.engine.surface_field()["position"][:, 1]))
    assert np.allclose(np.array(heights) / heights[0], [1, 2, 3], rtol=1e-5)
    assert json.loads(file.at(2).json())["deformation"][0]["factor"] == 2
    assert stage.engine.validation_messages == []


def squeezed(points: np.ndarray) -> np.ndarray:
    """Return where an affine map takes points, which harmonic displacements follow exactly."""
    return points @ np.array([[1.2, 0.1, 0], [0, 0.8, 0.2], [0, 0, 1]]) + np.array([0.3, 0, 0])


def test_frames_of_a_mesh_move_display_and_tets_alike(engine, tmp_path, capsys):
    display = engine.graph.display
    faces = "".join(f"f {a} {b} {c}\n" for a, b, c in np.asarray(display["triangles"]) + 1)
    for name, points in (("rest", display["vertices"]), ("end", squeezed(display["vertices"]))):
        (tmp_path / f"{name}.obj").write_text("".join(f"v {x:.9g} {y:.9g} {z:.9g}\n" for x, y, z in points) + faces)
    frames = [str(tmp_path / f"{name}.obj") for name in ("rest", "end")]
    shapes = tmp_path / "squeeze.qshapes"
    assert cli.main(["shapes", str(TINY), *frames, "-o", str(shapes)]) == 0
    assert "2 shapes of 2 levels" in capsys.readouterr().out
    engine.solve()
    rest = engine.surface_field()["position"]
    engine.set_deformation([{"type": "displaced", "shapes": str(shapes), "frame": 0.5}])
    engine.solve()
    expected = (rest + squeezed(rest)) / 2
    assert np.allclose(engine.surface_field()["position"], expected, atol=1e-5)
    engine.set_deformation([])
    scene = {"body": str(TINY), "deformation": [{"type": "displaced", "shapes": shapes.name, "frame": 0.5}]}
    (tmp_path / "scene.json").write_text(json.dumps(scene))
    written = json.loads(_core.SceneFile(tmp_path / "scene.json").at(0).json())
    assert written["deformation"] == [{"type": "displaced", "shapes": str(shapes), "weights": [0.5, 0.5]}]

    file = qgraph_file.read(TINY)
    start = Surface(np.asarray(display["vertices"], np.float64), np.asarray(display["triangles"], np.int64))
    moves = (squeezed(start.vertices) - start.vertices)[None]
    found = of_moves(file, start, moves)
    for number, level in enumerate(found.levels):
        vertices = file.sections[f"level{number}/vertices"]
        assert np.allclose(vertices + level[0], squeezed(vertices), atol=1e-5)
    engine.set_deformation([{"type": "displaced", "shapes": found.in_memory(), "weights": [1]}])
    engine.solve()
    assert np.allclose(engine.surface_field()["position"], squeezed(rest), atol=1e-5)
    engine.set_deformation([])


def glb_of(vertices: np.ndarray, triangles: np.ndarray, target: np.ndarray) -> bytes:
    """Return a file of one mesh with one morph target, turned by 90 degrees about z and moved."""
    which = np.flatnonzero(np.abs(target).max(axis=1) > 0)
    arrays = [vertices, triangles.reshape(-1, 1), which[:, None], target[which]]
    arrays = [np.ascontiguousarray(a, np.float32 if a.shape[1] == 3 else np.uint32) for a in arrays]
    ends = np.cumsum([0] + [a.nbytes for a in arrays])
    document = {
        "asset": {"version": "2.0"},
        "scenes": [{"nodes": [0]}],
        "nodes": [{"children": [1], "translation": [1, 2, 3]}, {"mesh": 0, "rotation": [0, 0, 0.5**0.5, 0.5**0.5]}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1, "targets": [{"POSITION": 2}]}]}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "type": "VEC3", "count": len(vertices)},
            {"bufferView": 1, "componentType": 5125, "type": "SCALAR", "count": triangles.size},
            {
                "componentType": 5126,
                "type": "VEC3",
                "count": len(vertices),
                "sparse": {
                    "count": len(which),
                    "indices": {"bufferView": 2, "componentType": 5125},
                    "values": {"bufferView": 3},
                },
            },
        ],
        "bufferViews": [
            {"buffer": 0, "byteOffset": int(at), "byteLength": a.nbytes} for at, a in zip(ends, arrays, strict=False)
        ],
        "buffers": [{"byteLength": int(ends[-1])}],
    }
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    binary = b"".join(a.tobytes() for a in arrays)
    chunks = struct.pack("<II", len(text), 0x4E4F534A) + text + struct.pack("<II", len(binary), 0x004E4942) + binary
    return struct.pack("<III", 0x46546C67, 2, 12 + len(chunks)) + chunks


def test_morph_targets_of_a_gltf_file_are_shapes(engine, tmp_path, capsys):
    display = {name: np.asarray(values) for name, values in engine.graph.display.items()}
    world = display["vertices"] - [1, 2, 3]
    vertices = np.stack([world[:, 1], -world[:, 0], world[:, 2]], axis=1)  # before they are turned and moved
    top = display["vertices"][:, 1] > display["vertices"][:, 1].max() - 1e-3
    path = tmp_path / "a.glb"
    path.write_bytes(glb_of(vertices, display["triangles"], np.where(top[:, None], [0.5, 0, 0], 0)))
    found = from_gltf(TINY, path)
    assert found.display.shape == (1, len(vertices), 3)
    assert np.allclose(found.display[0], np.where(top[:, None], [0, 0.5, 0], 0), atol=1e-5)
    path.write_bytes(path.read_bytes().replace(b'"targets"', b'"tarrots"'))
    assert cli.main(["shapes", str(TINY), str(path), "-o", str(tmp_path / "a.qshapes")]) == 1
    assert "0 meshes with morph targets" in capsys.readouterr().err


def test_frames_of_something_else_are_refused(tmp_path, capsys):
    (tmp_path / "far.obj").write_text("v 9 9 9\nv 10 9 9\nv 9 10 9\nf 1 2 3\n")
    (tmp_path / "more.obj").write_text("v 9 9 9\nv 10 9 9\nv 9 10 9\nv 0 0 0\nf 1 2 3\n")
    output = tmp_path / "a.qshapes"
    for frames, said in (
        (["far.obj"], "mm from the body"),
        (["far.obj", "more.obj"], "4 vertices"),
        (["a.stl"], ".obj"),
    ):
        assert cli.main(["shapes", str(TINY), *[str(tmp_path / f) for f in frames], "-o", str(output)]) == 1
        assert said in capsys.readouterr().err
    assert not output.exists()


@pytest.mark.parametrize("spoil", [lambda data: data[:-64], lambda data: data[:200] + b"x" + data[201:], lambda _: b""])
def test_damaged_shapes_are_refused(engine, tmp_path, spoil):
    path = tmp_path / "a.qshapes"
    levels = [np.zeros((1, len(level.vertices), 3), np.float32) for level in engine.graph.levels]
    StoredShapes(np.zeros((1, len(engine.graph.display["vertices"]), 3), np.float32), levels).write(path)
    moved = [{"type": "displaced", "shapes": str(path), "weights": [2]}]
    engine.set_deformation(moved)
    path.write_bytes(spoil(path.read_bytes()))
    os.utime(path, (1, 1))
    with pytest.raises((FormatError, InputError), match=r"a\.qshapes"):
        engine.set_deformation(moved)
    engine.set_deformation([])
