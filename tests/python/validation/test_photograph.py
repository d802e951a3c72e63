"""`quadgraph photograph`: its walks keep the laws of light, and its captures are what `acquire` reads."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from baked import write_levels
from quadgraph import VolumeMaterial, core
from quadgraph.acquisition.capture import capture, photographs
from quadgraph.base.errors import InputError
from quadgraph.cli import main
from shapes import icosphere

pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")
camera_walks = pytest.importorskip("quadgraph_validation.truth.camera_walks", reason="needs the extra walks")
known_material = pytest.importorskip("quadgraph_validation.truth.known_material")
walk_kernel = pytest.importorskip("quadgraph_validation.truth.walk_kernel")

RADIUS = 10.0
EYE = camera_walks.Eye(np.array([0.0, 0.0, 60.0]), np.zeros(3), 24.0, "y", 16, 16)
AMBIENT = {"type": "ambient", "irradiance": [0.5, 1.0, 2.0]}
KEY = {"type": "rectangle", "centre": [0, 40, 60], "u": [60, 0, 0], "v": [0, -40, 30], "power": [3.0, 3.0, 3.0]}


def see(lights: list[dict], channel: int, sigma_a: float, sigma_s: float, eta: float, seed: int = 3):
    """A ball seen from EYE."""
    walker = camera_walks.CameraWalker(icosphere(3, RADIUS), lights)
    material = known_material.KnownMaterial.even(np.full(3, sigma_s), np.full(3, sigma_a), eta)
    return walker.see(EYE, channel, material.in_channel(channel), eta, 100, seed, lambda _share: None)


@pytest.mark.parametrize("eta", [1.0, 1.4])
def test_a_body_that_absorbs_nothing_looks_like_what_is_around_it(eta):
    """In a uniform field radiance is the same everywhere; of it the surface reflects a share, which is left out."""
    seen = see([AMBIENT], 1, 0.0, 3.0, eta)
    middle = seen.radiance[0, 6:10, 6:10]
    through = 1 - ((eta - 1) / (eta + 1)) ** 2  # it is looked at straight on
    assert abs(middle.mean() / (through / np.pi) - 1) < 0.02
    assert (seen.radiance[0, 0] == 0).all()  # beside the body


def test_powers_and_channels_scale_what_is_seen():
    one, other = (see([AMBIENT, KEY], channel, 0.05, 1.0, 1.3) for channel in (0, 2))
    np.testing.assert_allclose(4 * one.radiance[0].mean(), other.radiance[0].mean(), rtol=0.05)
    assert one.radiance[1].max() > 0
    again = see([AMBIENT, KEY], 0, 0.05, 1.0, 1.3)
    np.testing.assert_array_equal(again.radiance, one.radiance)


@pytest.mark.parametrize("sigma_a", [0.0, 0.3])
def test_nothing_is_seen_where_nothing_scatters(sigma_a):
    assert not see([AMBIENT], 1, sigma_a, 0.0, 1.3).radiance.any()


def test_lights_that_walks_cannot_meet_are_refused():
    with pytest.raises(InputError, match=r"lights\[0\]: point found, allowed with walks are rectangle and ambient"):
        camera_walks.CameraWalker(icosphere(2, RADIUS), [{"type": "point", "position": [0, 0, 40], "power": 1}])


@pytest.fixture
def scene(tmp_path) -> Path:
    """A scene of a ball under two lights."""
    write_levels(tmp_path / "ball.qgraph", [icosphere(2, RADIUS)])
    document = {
        "body": "ball.qgraph",
        "material": {"sigma_s_prime": [1.0, 0.8, 0.6], "sigma_a": [0.02, 0.05, 0.1], "eta": 1.3},
        "lights": [KEY, AMBIENT],
        "camera": {"azimuth": 10},
        "picture": {"width": 16, "height": 12},
    }
    path = tmp_path / "scene.json"
    path.write_text(json.dumps(document))
    return path


def test_workers_take_the_same_photographs(scene, tmp_path):
    one, spread = (tmp_path / name / "photos.json" for name in ("one", "spread"))
    for path in (one, spread):
        path.parent.mkdir()
        more = ["--scheduler", "processes:2"] if path == spread else []
        asked = ["photograph", str(scene), "--capture", str(path), "--walks", "9", "--seed", "5"]
        assert main([*asked, *more]) == 0
    names = sorted(path.name for path in one.parent.iterdir())
    assert len(names) == 6
    for name in names:
        assert (spread.parent / name).read_bytes() == (one.parent / name).read_bytes()


def test_what_the_engine_photographs_is_not_spread(scene, tmp_path, capsys):
    asked = ["photograph", str(scene), "--capture", str(tmp_path / "photos.json"), "--by", "engine"]
    assert main([*asked, "--scheduler", "processes:2"]) == 1
    assert "--scheduler: found with --by engine, allowed with --by walks" in capsys.readouterr().err


@pytest.mark.parametrize("by", [["--walks", "16"], ["--by", "engine", "--device", "cpu", "--gains", "20%"]])
def test_a_capture_is_one_that_can_be_read(scene, tmp_path, by, capsys):
    path = tmp_path / "photos.json"
    assert main(["photograph", str(scene), "--capture", str(path), "--azimuths", "0,120,240", *by]) == 0
    assert ("inverse crime" in capsys.readouterr().err) == ("engine" in by)
    found = capture.read(path)
    assert len(found.photographs) == 6
    measured = photographs.read_all(found)
    assert all(0.5 < each.values.max() <= 1 for each in measured)
    gains = [each.gain for each in found.photographs]
    assert gains == ([f"photographs[{k}]" for k in range(6)] if "--gains" in by else [1.0] * 6)
    truth = json.loads((tmp_path / "photos-truth.json").read_text())
    np.testing.assert_allclose(truth["sigma_a"], [0.02, 0.05, 0.1], rtol=1e-6)
    assert "sigma_a" not in path.read_text()


@pytest.mark.parametrize("by", [["--walks", "16"], ["--by", "engine", "--device", "cpu"]])
def test_a_volume_is_photographed_and_named_in_the_truth(scene, tmp_path, by):
    (tmp_path / "materials").mkdir()
    absorption = np.array([0.02, 0.05, 0.1]) * np.linspace(1, 3, 4)[:, None, None, None]
    VolumeMaterial(np.full((4, 1, 1, 3), 0.8), absorption, 5.0, (0, 0, -7.5), 1.25).save(
        tmp_path / "materials" / "deep.npz"
    )
    scene.write_text(json.dumps(json.loads(scene.read_text()) | {"material": "materials/deep.npz"}))
    path = tmp_path / "captures" / "photos.json"
    path.parent.mkdir()
    assert main(["photograph", str(scene), "--capture", str(path), *by]) == 0
    found = capture.read(path)
    assert found.eta == pytest.approx(1.25)
    measured = photographs.read_all(found)
    assert all(each.values.max() > 0.5 for each in measured)
    truth = json.loads((path.parent / "photos-truth.json").read_text())
    assert (path.parent / truth["material"]).samefile(tmp_path / "materials" / "deep.npz")
    assert truth["eta"] == pytest.approx(1.25)
    assert "sigma_a" not in truth
    assert "deep.npz" not in path.read_text()


@pytest.mark.parametrize("origin", [None, (-4.0, 1.0, -9.0)])
def test_a_volume_lies_where_the_engine_lays_it(scene, tmp_path, origin):
    """Axes of one cell, grey beside coloured coefficients, and places beside the grid among them."""
    generator = np.random.default_rng(4)
    grey, coloured = generator.random((3, 1, 5)), generator.random((3, 1, 5, 3))
    VolumeMaterial(grey, coloured, (2.0, 3.0, 4.0), origin, 1.5).save(tmp_path / "field.npz")
    scene.write_text(json.dumps(json.loads(scene.read_text()) | {"material": "field.npz"}))
    found = known_material.of_scene(scene, core.SceneFile(scene).at(0))
    vertices = core.load(tmp_path / "ball.qgraph").levels[0].vertices
    points = generator.uniform(-12, 12, (200, 3))
    centre = (vertices.min(axis=0) + vertices.max(axis=0)) / 2
    wanted = core.Volume(tmp_path / "field.npz").at(points, centre)
    for channel in range(3):
        volume = found.in_channel(channel)
        for values, those in zip((volume.scattering, volume.absorption), wanted, strict=True):
            here = [walk_kernel._at(values, volume, *point) for point in points]
            np.testing.assert_allclose(here, those[:, channel], atol=1e-5)


@pytest.mark.parametrize("material", ["clouds", "checker"])
def test_a_pattern_is_what_the_engine_takes_it_for(scene, material):
    text = f"sigma_s_prime=1/2/3,sigma_a=0.1,second_sigma_s_prime=4,second_sigma_a=0.5,pattern={material},period=8"
    scene.write_text(json.dumps(json.loads(scene.read_text()) | {"material": text + ",sharpness=1"}))
    found = known_material.of_scene(scene, core.SceneFile(scene).at(0))
    points = np.random.default_rng(5).uniform(-7, 7, (400, 3)).astype(np.float32)
    wanted = core.material_at(core.Material(text + ",sharpness=1"), points, np.zeros(400))
    for channel in range(3):
        volume = found.in_channel(channel)
        for values, those in zip((volume.scattering, volume.absorption), wanted, strict=True):
            here = np.array([walk_kernel._at(values, volume, *point) for point in points.astype(np.float64)])
            off = np.abs(here - those[:, channel]) / np.ptp(those[:, channel])
            assert np.quantile(off, 0.85) < 0.02  # beside a step one in ten lies between two points of the grid
    assert found.stated(scene.parent)["material"].startswith("sigma_s_prime=1/2/3")


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"material": "layered-skin"}, "pattern 'layers'"),
        ({"material": "jade,period=0.1"}, "a period of 0.1 mm found, at least about"),
        ({"material": "nowhere.npz"}, "nowhere.npz: cannot be read"),
        ({"edits": [{"operation": "multiply", "sigma_a": 2}]}, "/edits: found"),
        ({"lights": []}, "/lights: found none"),
        ({"camera": {"orthographic": 30}}, "/camera/orthographic: found"),
        ({"lights": [{"type": "point", "position": [0, 0, 40], "power": 1}]}, "or take --by engine"),
    ],
)
def test_what_cannot_be_photographed_is_refused(scene, tmp_path, change, said, capsys):
    scene.write_text(json.dumps(json.loads(scene.read_text()) | change))
    path = tmp_path / "photos.json"
    assert main(["photograph", str(scene), "--capture", str(path), "--walks", "4"]) == 1
    assert said in capsys.readouterr().err
    assert not path.exists()
    assert not list(tmp_path.glob("*.exr"))
