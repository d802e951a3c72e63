"""Skinned animations of glTF files against closed forms."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from baked import write_levels
from gltf_files import Builder
from quadgraph import cli
from quadgraph.base.errors import InputError
from quadgraph.file.shapes_file import from_gltf
from quadgraph.mesh.gltf_animation import animation_of
from quadgraph.mesh.gltf_file import read
from quadgraph.mesh.gltf_skin import read_frames
from quadgraph.mesh.surface import Surface

LENGTH, SEGMENTS = 20.0, 10


def bar() -> Surface:
    """A square bar of 2 mm along x from 0 to LENGTH, with a ring of vertices at the end of every segment."""
    x = np.linspace(0, LENGTH, SEGMENTS + 1)
    ring = np.array([[1, 1], [-1, 1], [-1, -1], [1, -1]], float)
    vertices = np.concatenate([np.column_stack([np.full(4, at), ring]) for at in x])
    side = np.array([[i, (i + 1) % 4, 4 + (i + 1) % 4, 4 + i] for i in range(4)])
    quads = np.concatenate([4 * k + side for k in range(SEGMENTS)]).tolist()
    quads += [[3, 2, 1, 0], [4 * SEGMENTS + i for i in range(4)]]
    triangles = np.array([t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))])
    return Surface(vertices, triangles)


def turned(axis: int, angle: float) -> list[float]:
    """Return a rotation about x, y or z as (x, y, z, w)."""
    quaternion = [0.0, 0.0, 0.0, float(np.cos(angle / 2))]
    quaternion[axis] = float(np.sin(angle / 2))
    return quaternion


def chain(path: Path, axis: int, angle: float, interpolation: str = "LINEAR", **spoiled) -> Path:
    """A bar whose every ring has a joint, a child of the one before; within 1 s all but the first turn by `angle`.

    The whole is turned about z and moved, by a node above.
    """
    surface, step = bar(), LENGTH / SEGMENTS
    file = Builder()
    ring = np.repeat(np.arange(SEGMENTS + 1), 4)
    weights = np.zeros((len(ring), 4), np.uint8)
    weights[:, 0] = 255
    joints = np.zeros((len(ring), 4), np.uint8)
    joints[:, 0] = ring
    bind = np.tile(np.eye(4), (SEGMENTS + 1, 1, 1))
    bind[:, 0, 3] = -step * np.arange(SEGMENTS + 1)
    mesh = file.mesh(surface, JOINTS_0=file.add(joints), WEIGHTS_0=file.add(weights, normalized=True))
    nodes = [{"children": [1, 2], "rotation": turned(2, 0.5), "translation": [3, -1, 2]}, {"mesh": mesh, "skin": 0}]
    nodes += [
        {"translation": [step if k else 0, 0, 0], "children": [3 + k] if k < SEGMENTS else []}
        for k in range(SEGMENTS + 1)
    ]
    times = file.add(np.array([[0.5], [1.5]], np.float32))
    keys = file.add(np.array([turned(axis, 0), turned(axis, angle)], np.float32))
    file.document |= {
        "nodes": nodes,
        "skins": [
            {
                "joints": list(range(2, 3 + SEGMENTS)),
                "inverseBindMatrices": file.add(bind.transpose(0, 2, 1).reshape(-1, 16)),
            }
        ],
        "animations": [
            {
                "name": "turn",
                "samplers": [{"input": times, "output": keys, "interpolation": interpolation}],
                "channels": [{"sampler": 0, "target": {"node": 3 + k, "path": "rotation"}} for k in range(SEGMENTS)],
            }
        ],
        **spoiled,
    }
    return file.write(path)


def world(points: np.ndarray) -> np.ndarray:
    """Return what the node above makes of points."""
    c, s = np.cos(0.5), np.sin(0.5)
    return points @ np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]]) + [3, -1, 2]


def twisted(points: np.ndarray, angle: float) -> np.ndarray:
    """Return points whose sections across x turn evenly, by `angle` at the end of the bar."""
    turn = angle * points[:, 0] / LENGTH
    y = np.cos(turn) * points[:, 1] - np.sin(turn) * points[:, 2]
    z = np.sin(turn) * points[:, 1] + np.cos(turn) * points[:, 2]
    return np.column_stack([points[:, 0], y, z])


def test_a_chain_of_joints_twists_a_bar_as_the_closed_form_does(tmp_path):
    path = chain(tmp_path / "twist.glb", 0, np.pi / SEGMENTS)
    found = read(path, lambda file: read_frames(file, 8))
    rest = bar().vertices
    assert np.allclose(found.times, 0.5 + np.arange(9) / 8)
    assert np.allclose(found.vertices, world(rest), atol=1e-6)
    for k, frame in enumerate(found.frames):
        assert np.allclose(frame, world(twisted(rest, np.pi * k / 8)), atol=1e-5)


def test_a_chain_of_joints_bends_a_bar_into_a_polygon_on_the_arc(tmp_path):
    angle = np.pi / 2 / SEGMENTS
    found = read(chain(tmp_path / "bend.glb", 2, angle), lambda file: read_frames(file, 1))
    turn = angle * np.arange(SEGMENTS + 1)
    step = LENGTH / SEGMENTS * np.column_stack([np.cos(turn), np.sin(turn)])
    axis = np.concatenate([[[0, 0]], np.cumsum(step, axis=0)])[:-1]
    rest = bar().vertices
    ring = np.repeat(np.arange(SEGMENTS + 1), 4)
    normal = np.column_stack([-np.sin(turn), np.cos(turn)])
    expected = np.column_stack([axis[ring] + rest[:, 1:2] * normal[ring], rest[:, 2]])
    assert np.allclose(found.frames[-1], world(expected), atol=1e-5)
    radius = LENGTH / SEGMENTS / (2 * np.sin(angle / 2))
    centre = axis[:3] - axis[0]  # three points of the polygon have the centre that all of them have
    middle = np.linalg.solve(2 * centre[1:], (centre[1:] ** 2).sum(axis=1)) + axis[0]
    assert np.allclose(np.linalg.norm(axis - middle, axis=1), radius, rtol=1e-6)
    assert radius == pytest.approx(LENGTH / (np.pi / 2), rel=2e-3)  # that of the arc


def test_a_vertex_between_two_joints_goes_straight_between_where_they_take_it(tmp_path):
    angle = 2.0
    file = Builder()
    surface = bar()
    share = surface.vertices[:, 0] / LENGTH
    weights = np.column_stack([1 - share, share, 0 * share, 0 * share]).astype(np.float32)
    joints = np.tile(np.array([0, 1, 9, 9], np.uint16), (len(share), 1))  # of weight 0: any number
    mesh = file.mesh(surface, JOINTS_0=file.add(joints), WEIGHTS_0=file.add(weights))
    file.document |= {
        "nodes": [{"mesh": mesh, "skin": 0}, {}, {}],
        "skins": [{"joints": [1, 2]}],
        "animations": [
            {
                "samplers": [
                    {
                        "input": file.add(np.array([[0], [1]], np.float32)),
                        "output": file.add(np.array([turned(0, 0), turned(0, angle)], np.float32)),
                    }
                ],
                "channels": [{"sampler": 0, "target": {"node": 2, "path": "rotation"}}],
            }
        ],
    }
    found = read(file.write(tmp_path / "wrapper.gltf"), lambda gltf: read_frames(gltf, 1))
    middle = np.isclose(share, 0.5)
    shrunk = np.linalg.norm(found.frames[-1][middle, 1:], axis=1) / np.sqrt(2)
    assert np.allclose(shrunk, np.cos(angle / 2), atol=1e-6)


@pytest.mark.parametrize("interpolation", ["LINEAR", "STEP", "CUBICSPLINE"])
def test_keys_are_joined_as_the_interpolation_says(tmp_path, interpolation):
    file = Builder()
    times = np.array([1, 2, 4], np.float64)

    def curve(t):
        return np.stack([t**3, 2 - t, t**2], axis=-1)

    def slope(t):
        return np.stack([3 * t**2, -np.ones_like(t), 2 * t], axis=-1)

    keys = curve(times)
    if interpolation == "CUBICSPLINE":  # which is exact for cubic curves
        keys = np.stack([slope(times), curve(times), slope(times)], axis=1).reshape(-1, 3)
    file.document |= {
        "nodes": [{}],
        "animations": [
            {
                "samplers": [
                    {
                        "input": file.add(times[:, None].astype(np.float32)),
                        "output": file.add(keys.astype(np.float32)),
                        "interpolation": interpolation,
                    }
                ],
                "channels": [{"sampler": 0, "target": {"node": 0, "path": "translation"}}],
            }
        ],
    }
    animation = read(file.write(tmp_path / "keys.gltf"), animation_of)
    assert (animation.begin, animation.end) == (1, 4)
    for t in (0.0, 1.0, 1.25, 1.999, 2.0, 3.5, 4.0, 9.0):
        inside = np.clip(t, 1, 4)
        expected = {
            "LINEAR": [np.interp(inside, times, component) for component in curve(times).T],
            "STEP": curve(times[np.searchsorted(times, inside, side="right") - 1]),
            "CUBICSPLINE": curve(inside),
        }[interpolation]
        assert np.allclose(animation.at(t)[0]["translation"], expected, atol=1e-5)


def test_a_skinned_animation_drives_the_tets_of_a_body(tmp_path, capsys):
    _core = pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")
    body = tmp_path / "bar.qgraph"
    path = chain(tmp_path / "twist.glb", 0, np.pi / 4 / SEGMENTS)
    surface = Surface(world(bar().vertices), bar().triangles)
    write_levels(body, [surface])
    output = tmp_path / "twist.qshapes"
    assert cli.main(["shapes", str(body), str(path), "--frames-per-second", "2", "-o", str(output)]) == 0
    assert "3 shapes of 1 levels" in capsys.readouterr().out
    engine = _core.Engine(body, validation=True)
    engine.set_material("marble")
    engine.set_lights(["directional:0,-1,-1:1"])
    rest = np.asarray(engine.graph.display["vertices"], np.float64)
    shapes = from_gltf(body, path, 2)
    local = (rest - [3, -1, 2]) @ np.array([[np.cos(0.5), np.sin(0.5), 0], [-np.sin(0.5), np.cos(0.5), 0], [0, 0, 1]]).T
    step = LENGTH / SEGMENTS
    on_ring = np.isclose(local[:, 0], step * np.round(local[:, 0] / step), atol=1e-4)
    moved = world(twisted(local, np.pi / 4))
    assert on_ring.sum() >= 4 * SEGMENTS
    assert np.allclose((rest + shapes.display[-1])[on_ring], moved[on_ring], atol=1e-4)
    engine.set_deformation([{"type": "displaced", "shapes": str(output), "frame": 2}])
    report = engine.solve()
    assert report["deformed"] == "" or "inside out" not in report["deformed"]
    assert np.all(np.isfinite(engine.surface_field()["exitance"]))
    assert engine.validation_messages == []


@pytest.mark.parametrize(
    ("spoiled", "said"),
    [
        ({"animations": []}, "no animation found"),
        ({"animations": [{"name": "a"}, {"name": "b"}]}, "2 animations found, choose one of them: a, b"),
        ({"animations": [{"channels": [], "samplers": []}]}, "moves nothing"),
        ({"skins": [{"joints": [2, 3]}]}, "joint 10 found, the skin has 2"),
        ({"skins": [{"joints": [2, 99]}]}, "all its joints in the scene"),
        ({"extensionsRequired": ["KHR_draco_mesh_compression"]}, "KHR_draco_mesh_compression"),
        ({"nodes": [{"children": [0], "mesh": 0, "skin": 0}]}, "node 0 is reached twice"),
    ],
)
def test_what_is_missing_or_not_supported_is_said(tmp_path, spoiled, said):
    path = chain(tmp_path / "bad.glb", 0, 0.1, **spoiled)
    with pytest.raises(InputError, match=r"bad\.glb.*" + said):
        read(path, lambda file: read_frames(file, 1))


def test_an_animation_is_asked_for_by_its_name(tmp_path):
    path = chain(tmp_path / "turn.glb", 0, 0.1)
    assert read(path, lambda file: read_frames(file, 1, "turn")).frames.shape[0] == 2
    with pytest.raises(InputError, match="'walk' not found, there are turn"):
        read(path, lambda file: read_frames(file, 1, "walk"))
    with pytest.raises(InputError, match="allowed are LINEAR"):
        read(chain(tmp_path / "odd.glb", 0, 0.1, "BEZIER"), lambda file: read_frames(file, 1))


def test_a_gltf_file_has_its_own_rest(tmp_path, capsys):
    path = chain(tmp_path / "turn.glb", 0, 0.1)
    body = tmp_path / "bar.qgraph"
    write_levels(body, [bar()])
    asked = ["shapes", str(body), str(path), "-o", str(tmp_path / "a.qshapes")]
    assert cli.main([*asked, "--rest", str(path)]) == 1
    assert "--rest: a glTF file has its own" in capsys.readouterr().err
    assert cli.main(asked) == 1  # the body lies elsewhere
    assert "mm from the body" in capsys.readouterr().err
    path.write_text(json.dumps({"scenes": [{"nodes": [0]}], "nodes": []}))
    assert cli.main(asked) == 1
    assert "cannot be read as glTF" in capsys.readouterr().err
