"""Normal textures of glTF files go with a bake: the surface leans by the coordinates of the mesh."""

from __future__ import annotations

import io
import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from gltf_files import Builder
from quadgraph.baking import bare, pipeline
from quadgraph.baking.bodies import BodyMesh, bake_bodies
from quadgraph.baking.placing import BodyPlacement
from quadgraph.base.errors import FormatError
from quadgraph.file import qgraph_file
from quadgraph.mesh.looks import normal_texture
from quadgraph.mesh.subdivide import subdivide
from quadgraph.mesh.surface import FileFrame, Surface
from shapes import cube

core = pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")

SIDE = 20.0
COLOUR = np.array([160, 110, 240], np.uint8)
SLOPES = (COLOUR / 255 * 2 - 1)[:2] / (COLOUR / 255 * 2 - 1)[2]
# Coordinates, v downwards, by places on the side that is seen; and along which axes red and green lean then.
WAYS: dict[str, tuple[Callable, np.ndarray, np.ndarray]] = {
    "straight": (lambda p: [p[:, 0], -p[:, 1]], np.array([1, 0]), np.array([0, 1])),
    "turned": (lambda p: [p[:, 1], p[:, 0]], np.array([0, 1]), np.array([-1, 0])),
    "mirrored": (lambda p: [-p[:, 0], -p[:, 1]], np.array([-1, 0]), np.array([0, 1])),
    "sheared": (
        lambda p: [3 * p[:, 0], -p[:, 1] - 0.5 * p[:, 0]],
        np.array([2, -1]) / np.sqrt(5),
        np.array([1, 2]) / np.sqrt(5),
    ),
}


def png(pixels: np.ndarray) -> bytes:
    stream = io.BytesIO()
    Image.fromarray(pixels).save(stream, "PNG")
    return stream.getvalue()


def textured(path: Path, uv: np.ndarray | None, picture: bytes, **info: object) -> Path:
    """A cube, mm, each corner of whose triangles has a vertex with coordinates of its own."""
    builder, surface = Builder(), subdivide(cube(SIDE), 2)
    own = Surface(surface.corners.reshape(-1, 3), np.arange(surface.triangles.size).reshape(-1, 3))
    attributes = {} if uv is None else {"TEXCOORD_0": builder.add(uv)}
    mesh = builder.mesh(own, **attributes)
    builder.meshes[mesh]["primitives"][0]["material"] = 0
    builder.document |= {
        "nodes": [{"mesh": mesh}],
        "images": [{"bufferView": builder.add_bytes(picture), "mimeType": "image/png"}],
        "textures": [{"source": 0, "sampler": 0}],
        "samplers": [{"wrapS": info.pop("wrap", 10497)}],
        "materials": [{"normalTexture": {"index": 0} | info}],
    }
    return builder.write(path)


def coordinates(way: str = "straight") -> np.ndarray:
    places = subdivide(cube(SIDE), 2).corners.reshape(-1, 3)
    return np.column_stack(WAYS[way][0](places / SIDE)) + 0.5


def leaning(path: Path, **info: object) -> Path:
    return textured(path, coordinates(), png(np.tile(COLOUR, (8, 8, 1))), **info)


def front(body: Path, folder: Path, device: str = "", **picture: object) -> np.ndarray:
    """(3,) what the middle of the side towards +z reflects of a light beside the eye."""
    found = np.asarray(pictured(body, folder, device, **picture).specular)
    assert np.abs(found - found.mean(axis=(0, 1))).max() < 2e-3 * found.max()
    return found.mean(axis=(0, 1))


def pictured(body: Path, folder: Path, device: str, **picture: object):
    scene = {
        "body": str(body),
        "material": "sigma_s_prime=1.2,sigma_a=0.02,eta=1.4,roughness=0.4",
        "lights": [{"type": "directional", "direction": [-0.2, -0.6, -1], "irradiance": 2}],
        "solver": {"correction": False},
        "camera": {"azimuth": 0, "elevation": 0, "orthographic": 8, **picture.pop("camera", {})},
        "deformation": picture.pop("deformation", []),
        "picture": {"width": 16, "height": 16, "samples": 4, "radiance": "lambertian", **picture},
    }
    (folder / "scene.json").write_text(json.dumps(scene))
    stage = core.Stage(device=device, validation=True)
    stage.show(core.SceneFile(folder / "scene.json").at(0))
    stage.solve()
    found = stage.render()
    assert stage.engine.validation_messages == []
    return found


def baked(mesh: Path, folder: Path, **options: object) -> tuple[Path, pipeline.BakeReport]:
    path = folder / f"{mesh.stem}.qgraph"
    return path, pipeline.bake(mesh, path, pipeline.BakeOptions(unit="mm", front=0, **options))


@pytest.fixture(scope="module")
def plate(tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("textures")
    return baked(leaning(folder / "a.glb"), folder)[0]


def projected(slopes: np.ndarray, folder: Path) -> dict[str, object]:
    """The same by a picture that is projected, which test_normal_maps.py holds against closed forms."""
    normal = np.array([*slopes, 1.0]) / np.sqrt(1 + slopes @ slopes)
    Image.fromarray(np.tile(np.round((normal + 1) / 2 * 255).astype(np.uint8), (4, 4, 1))).save(folder / "p.png")
    return {"image": str(folder / "p.png")}


@pytest.mark.parametrize("way", WAYS)
def test_it_leans_along_the_coordinates_of_the_mesh(way, plate, tmp_path):
    mesh = textured(tmp_path / f"{way}.glb", coordinates(way), png(np.tile(COLOUR, (8, 8, 1))))
    found = front(baked(mesh, tmp_path)[0], tmp_path)
    expected = front(plate, tmp_path, normal_map=projected(SLOPES @ np.stack(WAYS[way][1:]), tmp_path))
    assert found == pytest.approx(expected, rel=0.02)  # of eight bits
    plain = front(plate, tmp_path, normal_map=projected(np.zeros(2), tmp_path))
    assert np.abs(found / plain - 1).max() > 0.1


def test_the_processor_shows_it_as_a_gpu(tmp_path):
    noise = np.random.default_rng(5).integers(90, 166, (64, 64, 3), np.uint8)
    noise[..., 2] = 240
    body, _ = baked(textured(tmp_path / "noise.glb", coordinates("sheared"), png(noise)), tmp_path)
    found = [
        pictured(body, tmp_path, device, camera={"azimuth": 40, "elevation": 20}) for device in ("cpu", "llvmpipe")
    ]
    for layer in ("scattered", "specular"):
        a, b = (np.asarray(getattr(picture, layer)) for picture in found)
        assert np.abs(a - b).max() < 0.02 * b.max()
        assert np.abs(a - b).mean() < 1e-4 * b.mean()


def test_scale_wraps_and_deformations(plate, tmp_path):
    twice, _ = baked(leaning(tmp_path / "twice.glb", scale=2), tmp_path)
    expected = front(plate, tmp_path, normal_map=projected(2 * SLOPES, tmp_path))
    assert front(twice, tmp_path) == pytest.approx(expected, rel=0.02)
    turned = front(plate, tmp_path, deformation=[{"type": "transform", "axis": [0, 0, 1], "degrees": 90}])
    expected = front(plate, tmp_path, normal_map=projected(np.array([-SLOPES[1], SLOPES[0]]), tmp_path))
    assert turned == pytest.approx(expected, rel=0.02)
    halves = np.tile(COLOUR, (4, 4, 1))
    halves[:, 2:] = [128, 128, 255]
    places = coordinates() * [0.1, 1] + [1.6, 0]  # .6 in the picture; mirrored .35
    for wrap, leans in ((10497, False), (33648, True), (33071, False)):
        mesh = textured(tmp_path / f"wrap{wrap}.glb", places, png(halves), wrap=wrap)
        slopes = SLOPES if leans else np.zeros(2)
        expected = front(plate, tmp_path, normal_map=projected(slopes, tmp_path))
        assert front(baked(mesh, tmp_path)[0], tmp_path) == pytest.approx(expected, rel=0.03)


def test_surfaces_alone_keep_it_and_several_bodies_say_that_they_do_not(tmp_path):
    mesh = leaning(tmp_path / "a.glb")
    bare.write(mesh, tmp_path / "alone.qgraph", "mm")
    assert qgraph_file.read(tmp_path / "alone.qgraph").sections["display/normal_texture"].shape == (8, 24)
    bodies = [BodyMesh("a", mesh, unit="mm"), BodyMesh("b", mesh, BodyPlacement((40.0, 0.0, 0.0)), "mm")]
    report = bake_bodies(bodies, tmp_path / "two.qgraph", pipeline.BakeOptions())
    assert "display/normal_texture" not in qgraph_file.read(tmp_path / "two.qgraph").sections
    assert sum("keeps no normal texture" in note for note in report.notes) == 2
    path, _ = baked(mesh, tmp_path, normals="angle")
    assert "display/normal_texture" not in qgraph_file.read(path).sections


def test_what_cannot_be_read_is_left_out_and_said(tmp_path):
    picture, uv = png(np.tile(COLOUR, (8, 8, 1))), coordinates()
    bad = uv.copy()
    bad[7] = np.nan
    for mesh, said in (
        (textured(tmp_path / "a.glb", None, picture), "by TEXCOORD_0 found, which a primitive of it lacks"),
        (textured(tmp_path / "b.glb", uv[:5], picture), r"TEXCOORD_0: \(5, 2\) numbers found, \(576, 2\) are wanted"),
        (textured(tmp_path / "c.glb", bad, picture), "allowed are finite numbers up to 1"),
        (textured(tmp_path / "d.glb", uv, picture[:40]), "cannot be read as a picture"),
        (textured(tmp_path / "e.glb", uv, picture, scale=-1), "scale: -1 found, allowed is a number from 0 to 10"),
        (textured(tmp_path / "f.glb", uv, picture, index=3), "textures: index 3 found, there are 1"),
    ):
        found, note = normal_texture.find(mesh, cube(SIDE), FileFrame().placed)
        assert found is None
        with pytest.raises(AssertionError, match=said):
            raise AssertionError(note)
        assert mesh.name in note
    _, report = baked(mesh, tmp_path)
    assert any("its normal texture is left out" in note for note in report.notes)


def test_large_pictures_are_made_smaller(tmp_path):
    mesh = textured(tmp_path / "a.glb", coordinates(), png(np.tile(COLOUR, (8, 5000, 1))))
    found, note = normal_texture.find(mesh, subdivide(cube(SIDE), 2), FileFrame().placed)
    assert found is not None
    assert not note
    assert found.pixels.shape == (8, normal_texture.MOST_SIDE, 3)
    assert np.abs(found.pixels.astype(int) - COLOUR).max() <= 1


@pytest.mark.parametrize(
    ("section", "change", "said"),
    [
        ("texture_places", lambda a: a[:-1], "texture_places"),
        ("texture_places", lambda a: a * np.float32(np.nan), "not finite"),
        ("texture_places", lambda a: a * np.float32(0.5), "the third number is neither 0 nor 1"),
        ("texture_places", lambda a: a * np.array([1e8, 1, 1], "f4"), "beyond 1e6"),
        ("normal_texture", lambda a: a[:, :-1], "rows of RGB expected"),
        ("normal_texture", lambda a: np.zeros((4097, 3), "u1"), "found 1x4097 texels, allowed are 1 to 4096"),
    ],
)
def test_damaged_sections_are_refused(plate, tmp_path, section, change, said):
    file = qgraph_file.read(plate)
    sections = {name: array for name, array in file.sections.items() if name != "metadata"}
    sections[f"display/{section}"] = np.ascontiguousarray(change(sections[f"display/{section}"]))
    with pytest.raises(FormatError, match=said):
        qgraph_file.write(tmp_path / "bad.qgraph", file.metadata, sections)
    assert not (tmp_path / "bad.qgraph").exists()
