"""q of every kind of light against sums over points of it with every ray cast (light_truth.py)."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

import light_truth
import tiny
from baked import write_levels
from quadgraph.base.errors import InputError
from shapes import icosphere, torus

_core = pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")

ETA = 1.3
SURFACES = {"sphere": icosphere(3, 10.0), "torus": torus(10.0, 3.0, 48, 24)}


@pytest.fixture(scope="module")
def files(tmp_path_factory) -> dict:
    folder = tmp_path_factory.mktemp("lights")
    return {name: write_levels(folder / f"{name}.qgraph", [surface], rays=256) for name, surface in SURFACES.items()}


@pytest.fixture(scope="module")
def engines(files) -> dict:
    """Under the validation layer."""
    engines = {name: _core.Engine(path, validation=True) for name, path in files.items()}
    for engine in engines.values():
        engine.set_material(f"sigma_s_prime=1,sigma_a=0.01,eta={ETA}")
    return engines


@pytest.fixture(params=list(SURFACES))
def lit(request, engines):
    """An engine and the body it shows; every validation message fails the test."""
    yield engines[request.param], request.param
    assert engines[request.param].validation_messages == []


def compare(lit, text: str, emitter: light_truth.Emitter, count: int = 256, least: float = 0.1) -> None:
    """The engine's q under the light `text`, in all and face by face, against the emitter's.

    least: share of the mean that a face gets at least to be judged by itself.
    """
    engine, name = lit
    engine.set_lights([text])
    engine.solve(tolerance=0.1, inter_reflection=False)
    level, found = engine.graph.levels[0], engine.surface_field()
    body = light_truth.Body(light_truth.Surface(level.vertices.astype(float), level.faces))
    faces = np.random.default_rng(3).choice(len(level.faces), 400, replace=False)
    q, area = found["q"][faces].astype(float), found["area"][faces][:, None]
    truth = body.q(faces, emitter, ETA, count)
    mean = (truth * area).sum(axis=0) / area.sum()
    bright = truth > least * mean
    power = (q * area).sum(axis=0) / (truth * area).sum(axis=0) - 1
    median = np.median(np.abs(q - truth)[bright] / truth[bright])
    rms = np.sqrt(((q - truth) ** 2 * area).sum() / (truth**2 * area).sum())
    print(f"{name}, {text}: power {power}, median error {median:.2%}, RMS {rms:.2%}, lit {bright.mean():.0%}")
    assert bright.any()
    assert np.abs(power).max() < 0.015
    assert median < 0.02
    assert rms < 0.05


def test_spot(lit):
    position, direction, power = (4.0, 9.0, 26.0), (-1.0, -3.0, -9.0), (300.0, 200.0, 100.0)
    text = "spot:4,9,26:-1,-3,-9:17,0.4:300/200/100"
    compare(lit, text, light_truth.spot(position, direction, 17.0, 0.4, power))


def test_a_spot_inside_the_ring(engines):
    lit = (engines["torus"], "torus")
    compare(lit, "spot:1,0,0:1,0.3,0.2:70,0.5:100", light_truth.spot((1, 0, 0), (1, 0.3, 0.2), 70.0, 0.5, [100.0] * 3))


@pytest.mark.parametrize(
    ("centre", "u", "v"),
    [
        (
            (4.0, 9.0, 26.0),
            (12.0, 0.0, 0.0),
            (0.0, -12.0, 4.0),
        ),  # about as far as it is large, turned away from the body
        ((0.0, 17.0, 3.0), (6.0, 0.0, 0.0), (0.0, 0.0, 6.0)),  # near
    ],
)
def test_rectangle(lit, centre, u, v):
    """In a penumbra its patches are sixteen steps: faces there count in all, but not by themselves."""
    texts = (",".join(str(value) for value in vector) for vector in (centre, u, v))
    power = [400.0, 200.0, 100.0]
    compare(lit, "rectangle:" + ":".join(texts) + ":400/200/100", light_truth.rectangle(centre, u, v, power), 1024, 0.5)


def test_projector(lit, tmp_path):
    """An image of three colours and some texels, wider than high, whose edges lie on the body."""
    pixels = np.random.default_rng(5).integers(0, 256, (3, 4, 3), dtype=np.uint8)
    name = tmp_path / "image.png"
    Image.fromarray(pixels).save(name)
    srgb = pixels / 255.0
    linear = np.where(srgb <= 0.04045, srgb / 12.92, ((srgb + 0.055) / 1.055) ** 2.4)
    position, direction, up = (4.0, 20.0, 26.0), (-0.1, -0.6, -0.8), (1.0, 1.0, 0.0)
    emitter = light_truth.projector(position, direction, up, 25.0, linear, [500.0, 300.0, 100.0])
    compare(lit, f"projector:4,20,26:-0.1,-0.6,-0.8:25,1,1,0:{name}:500/300/100", emitter)


def surroundings(sun: float) -> np.ndarray:
    """A sky that is brighter near the horizon, ground, a window of 20 by 30 degrees, and a sun of 3 degrees."""
    height = np.cos(np.pi * (np.arange(128) + 0.5) / 128)[:, None]
    sky = np.where(height > 0, 1 - 0.7 * height, 0.15)[..., None] * np.array([0.6, 0.8, 1.0])
    picture = np.repeat(sky, 256, axis=1)
    picture[50:71, 30:45] = (9, 8, 6)
    picture[30:32, 160:162] = sun
    return picture


@pytest.mark.parametrize("sun", [1, 2000])
def test_environment(lit, tmp_path, sun):
    name = tmp_path / "surroundings.hdr"
    picture = light_truth.write_hdr(name, surroundings(sun))
    emitter = light_truth.environment(picture, 35.0, np.array([0.1, 0.2, 0.3]))
    compare(lit, f"environment:{name}:35:0.1/0.2/0.3", emitter, 1024)


def test_lights_add_up(lit):
    """q and the exitance of several lights are the sums of those of each."""
    engine, _ = lit
    texts = [
        "spot:4,9,26:-1,-3,-9:17:300",
        "point:30,0,5:400/200/0",
        "rectangle:0,0,20:5,0,0:0,-5,0:200",
        "ambient:0.01",
    ]
    fields = []
    for lights in (texts, *([text] for text in texts)):
        engine.set_lights(lights)
        engine.solve(tolerance=1e-6)
        fields.append(engine.surface_field())
    for name in ("q", "exitance"):
        together, apart = fields[0][name], sum(field[name] for field in fields[1:])
        assert np.abs(together - apart).max() < 2e-4 * together.max()


def test_pictures_in_runs_and_in_exr_are_the_same(engines, tmp_path):
    import OpenEXR

    plain, runs, exr = (tmp_path / name for name in ("plain.hdr", "runs.hdr", "float.exr"))
    picture = light_truth.write_hdr(plain, surroundings(2000))
    header, texels = plain.read_bytes().split(b"+X 256\n")
    rows = np.frombuffer(texels, np.uint8).reshape(128, 256, 4)
    coded = b"".join(
        bytes([2, 2, 1, 0]) + b"".join(bytes([128]) + row[k : k + 128, c].tobytes() for c in range(4) for k in (0, 128))
        for row in rows
    )
    runs.write_bytes(header + b"+X 256\n" + coded)
    channels = {name: picture[..., c].astype(np.float32) for c, name in enumerate("RGB")}
    OpenEXR.File({"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage}, channels).write(str(exr))
    found = []
    for name in (plain, runs, exr):
        engines["sphere"].set_lights([f"environment:{name}:0:1"])
        engines["sphere"].solve(tolerance=0.1)
        found.append(engines["sphere"].surface_field()["q"])
    assert (found[1] == found[0]).all()
    assert np.allclose(found[2], found[0], rtol=1e-5)


@pytest.mark.parametrize(
    ("name", "content", "said"),
    [
        ("none.hdr", None, "No such file"),
        ("short.hdr", b"#?RADIANCE\n\n-Y 2 +X 2\n1234", "in its texels"),
        ("large.hdr", b"#?RADIANCE\n\n-Y 2 +X 20000\n", "1 to 16384"),
        ("text.png", b"text", "text.png"),
        ("text.exr", b"text", "text.exr"),
        ("text.jpg", b"text", "ends in .exr, .hdr or .png"),
    ],
)
def test_a_picture_that_is_none_is_refused(engines, tmp_path, name, content, said):
    if content is not None:
        (tmp_path / name).write_bytes(content)
    for light in (f"environment:{tmp_path / name}:0:1", f"projector:0,0,30:0,0,-1:20:{tmp_path / name}:1"):
        with pytest.raises(InputError, match=said) as refusal:
            engines["sphere"].set_lights([light])
        assert name in str(refusal.value)


def test_more_lights_than_a_scene_may_have_are_refused(tmp_path):
    path = tmp_path / "scene.json"
    light = {"type": "directional", "direction": [0, 0, -1], "irradiance": 1}
    schema = json.loads((Path(__file__).parents[3] / "docs" / "scene.schema.json").read_text())
    assert schema["properties"]["lights"]["maxItems"] == 1024
    path.write_text(json.dumps({"quadgraph_scene": 1, "body": str(tiny.PATH), "lights": [light] * 1025}))
    with pytest.raises(InputError, match=r"scene\.json: /lights: lights: found 1025, allowed are at most 1024"):
        _core.SceneFile(path)
    engine = _core.Engine(tiny.PATH, device="cpu")
    with pytest.raises(InputError, match="lights: found 1025, allowed are at most 1024"):
        engine.set_lights(["directional:0,0,-1:1"] * 1025)
    engine.set_lights(["directional:0,0,-1:1"] * 1024)


def test_the_light_that_enters_is_taken_again_where_the_index_of_refraction_is_another(files):
    """Of nothing else in a material it depends: with the same index no pass of it runs, its times are those before."""
    lights = ["point:0,30,20:100", "ambient:.02"]

    def times(engine) -> list[float]:
        return [entry["time_ms"] for entry in engine.passes if entry["name"] == "irradiance"]

    def fresh(material: str) -> np.ndarray:
        other = _core.Engine(files["sphere"], device="cpu")
        other.set_material(material)
        other.set_lights(lights)
        other.solve(tolerance=1e-5)
        return other.surface_field()["exitance"]

    engine = _core.Engine(files["sphere"], device="cpu")
    engine.set_material("sigma_s_prime=1,sigma_a=.01,eta=1.3")
    engine.set_lights(lights)
    engine.solve(tolerance=1e-5)
    first = times(engine)
    assert first
    for material, same in (("sigma_s_prime=3,sigma_a=.1,eta=1.3", True), ("sigma_s_prime=3,sigma_a=.1,eta=1.5", False)):
        engine.set_material(material)
        engine.solve(tolerance=1e-5)
        assert (times(engine) == first) == same
        np.testing.assert_allclose(engine.surface_field()["exitance"], fresh(material), rtol=1e-3)
