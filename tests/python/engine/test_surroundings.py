"""What environment lights show behind a body, and surfaces whose roughness an image says."""

from __future__ import annotations

import json
from pathlib import Path

import jsonschema
import numpy as np
import pytest
from PIL import Image

from baked import write_levels
from light_truth import write_hdr
from quadgraph import cli
from quadgraph.base.errors import InputError
from shapes import icosphere

core = pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")

SCHEMA = Path(__file__).resolve().parents[3] / "docs" / "scene.schema.json"
ETA = 1.3
EVEN = 0.25  # radiance


@pytest.fixture(scope="module")
def folder(tmp_path_factory) -> Path:
    """A sphere of radius 10 mm, an even environment, and one with a red middle and blue edges, left green of it."""
    path = tmp_path_factory.mktemp("around")
    write_levels(path / "ball.qgraph", [icosphere(4, 10), icosphere(3, 10)], rays=64)
    write_hdr(path / "even.hdr", np.full((32, 64, 3), EVEN))
    quarters = np.zeros((32, 64, 3))
    quarters[:, 8:24, 1] = quarters[:, 24:40, 0] = 1
    quarters[:, :8, 2] = quarters[:, 56:, 2] = 1
    write_hdr(path / "quarters.hdr", quarters)
    half = np.zeros((64, 64), np.uint8)
    half[:, 32:] = 255
    Image.fromarray(half).save(path / "half.png")
    return path


@pytest.fixture(scope="module")
def engine(folder):
    engine = core.Engine(folder / "ball.qgraph", validation=True)
    engine.set_material(f"sigma_s_prime=2,sigma_a=.1,eta={ETA}")
    yield engine
    assert engine.validation_messages == []


def fresnel(cos_i: np.ndarray) -> np.ndarray:
    """Reflectance of unpolarised light that comes from outside."""
    cos_t = np.sqrt(1 - (1 - cos_i**2) / ETA**2)
    s, p = (cos_i - ETA * cos_t) / (cos_i + ETA * cos_t), (ETA * cos_i - cos_t) / (ETA * cos_i + cos_t)
    return (s**2 + p**2) / 2


def masked(cosine: np.ndarray, alpha: float) -> np.ndarray:
    """Smith's Lambda of ways at that cosine to the surface."""
    return (np.sqrt(1 + alpha**2 * (1 - cosine**2) / cosine**2) - 1) / 2


def rough_reflectance(cos_i: float, alpha: float, steps: int = 300) -> float:
    """Of even light: the integral of the reflection of Walter et al. 2007 over all facets of GGX slopes."""
    square, turn = np.meshgrid((np.arange(steps) + 0.5) / steps, 2 * np.pi * (np.arange(steps) + 0.5) / steps)
    tilt = np.arctan(alpha * np.sqrt(square / (1 - square)))
    facet = np.stack([np.sin(tilt) * np.cos(turn), np.sin(tilt) * np.sin(turn), np.cos(tilt)])
    way = np.array([np.sqrt(1 - cos_i**2), 0.0, cos_i])
    seen = np.tensordot(way, facet, 1)
    leaves = 2 * seen * facet[2] - cos_i
    counted = (seen > 0) & (leaves > 0)
    shadowed = 1 / (1 + masked(np.full(1, cos_i), alpha) + masked(np.clip(leaves, 1e-6, 1), alpha))
    weight = fresnel(np.clip(seen, 0, 1)) * shadowed * seen / (cos_i * facet[2])
    return float(np.where(counted, weight, 0).mean())


@pytest.mark.parametrize("radiance", ["gathered", "lambertian"])
def test_an_even_environment_is_behind_the_body_and_on_its_surface(engine, folder, radiance):
    engine.set_lights([f"environment:{folder / 'even.hdr'}:0:2"])
    engine.solve()
    size, distance = 65, 40
    for roughness in (0.3, 0.05):
        picture = engine.render(
            view=f"0,0,{distance}", width=size, height=size, surroundings=True, radiance=radiance, roughness=roughness
        )
        assert np.allclose(picture.surroundings, 2 * EVEN, rtol=0.01)
        specular = np.asarray(picture.specular)[size // 2, size // 2 + np.arange(0, 17, 4)]
        angle = np.arctan(np.tan(np.radians(15)) * np.arange(0, 17, 4) / (size / 2))
        cos_i = np.cos(np.arcsin(np.minimum(distance * np.sin(angle) / 10, 1)))
        wanted = [2 * EVEN * rough_reflectance(float(cosine), roughness) for cosine in cos_i]
        assert np.allclose(specular, np.array(wanted)[:, None], rtol=0.04)
    assert engine.render(width=16, height=16).surroundings is None


def test_it_is_seen_in_its_direction(engine, folder):
    for turn, azimuth, seen in ((0, 0, 0), (0, 90, 1), (0, 180, 2), (90, 90, 0), (-180, 0, 2), (-90, 0, 1)):
        engine.set_lights([f"environment:{folder / 'quarters.hdr'}:{turn}:1"])
        engine.solve(tolerance=0.1)
        picture = engine.render(view=f"{azimuth},0", width=32, height=16, surroundings=True)
        corner = np.asarray(picture.surroundings)[8, 16]
        assert np.argmax(corner) == seen, (turn, azimuth)
        assert corner[seen] == pytest.approx(1, abs=0.02)
        assert np.delete(corner, seen).max() < 0.02


def test_the_body_is_exposed_as_without_and_the_file_has_both(engine, folder, tmp_path):
    import OpenEXR

    engine.set_lights([f"environment:{folder / 'even.hdr'}:0:1"])
    engine.solve()
    without, picture = (engine.render(width=64, height=64, surroundings=seen) for seen in (False, True))
    hidden = np.asarray(picture.transmittance).reshape(64, 64, 3).max(axis=2) < 1e-4  # of what is behind
    whole = np.asarray(picture.alpha).reshape(64, 64) == 1
    assert (whole & hidden).sum() > 0.9 * whole.sum()
    assert np.array_equal(without.srgb()[whole & hidden], picture.srgb()[whole & hidden])
    assert (picture.srgb()[~whole].astype(int) - without.srgb()[~whole]).mean() > 60
    body = ["render", str(folder / "ball.qgraph"), "--light", f"environment:{folder / 'even.hdr'}:0:1"]
    assert cli.main([*body, "--surroundings", "--size", "32x32", "-o", str(tmp_path / "a.exr")]) == 0
    channels = OpenEXR.File(str(tmp_path / "a.exr"), separate_channels=True).channels()
    assert np.allclose(channels["surroundings.G"].pixels, EVEN, rtol=0.01)


ROUGH = {"image": "half.png", "placement": {"centre": [0, 0, 0], "size": [30, 30, 30]}, "roughness": 0.05}


def pictures_of(folder: Path, **picture) -> np.ndarray:
    """Return the reflected light of a scene with a light from the eye and an environment."""
    deformation = picture.pop("deformation", [])
    scene = {
        "body": "ball.qgraph",
        "material": "marble",
        "lights": [
            {"type": "directional", "direction": [0.2, 0, -1], "irradiance": 1},
            {"type": "directional", "direction": [-0.2, 0, -1], "irradiance": 1},
            {"type": "environment", "file": "quarters.hdr", "radiance": 0.1},
        ],
        "deformation": deformation,
        "solver": {"correction": False},
        "camera": {"elevation": 0, "distance": 39.4096},
        "picture": {"width": 96, "height": 96, **picture},
    }
    (folder / "rough.json").write_text(json.dumps(scene))
    file = core.SceneFile(folder / "rough.json")
    jsonschema.validate(json.loads(file.at(0).json()), json.loads(SCHEMA.read_text()))
    stage = core.Stage(validation=True)
    stage.show(file.at(0))
    stage.solve()
    found = np.array(stage.render().specular)
    assert stage.engine.validation_messages == []
    return found


@pytest.mark.parametrize("radiance", ["gathered", "lambertian"])
def test_the_surface_is_as_rough_as_the_image_says(folder, radiance):
    """Left as without an image, right as with its roughness everywhere, also after the body has turned."""
    rough, smooth = (pictures_of(folder, roughness=r, radiance=radiance) for r in (0.4, 0.05))
    assert smooth[:, :40].max() > 3 * rough[:, :40].max()
    mixed = pictures_of(folder, roughness=0.4, radiance=radiance, roughness_map=ROUGH)
    assert np.allclose(mixed[:, :45], rough[:, :45], rtol=1e-3, atol=1e-6)
    assert np.allclose(mixed[:, 51:], smooth[:, 51:], rtol=1e-3, atol=1e-6)
    turned = pictures_of(
        folder,
        roughness=0.4,
        radiance=radiance,
        roughness_map=ROUGH,
        deformation=[{"type": "transform", "axis": [0, 0, 1], "degrees": 180}],
    )
    assert turned[:, :40].max() > 2 * turned[:, 56:].max()


@pytest.mark.parametrize(
    ("changed", "said"),
    [
        ({"roughness": 0}, "/picture: roughness: found 0, expected 0.02 to 1"),
        ({"image": "none.png"}, "/picture/roughness_map/image: .*none.png"),
        ({"placement": {"centre": [0, 0, 0], "size": [1, 1, -1]}}, "/picture/roughness_map/placement: size: found -1"),
        ({"turn": 1}, "/picture/roughness_map/turn"),
    ],
)
def test_what_is_no_map_is_said(folder, changed, said):
    scene = {"body": "ball.qgraph", "picture": {"roughness_map": {**ROUGH, **changed}}}
    (folder / "bad.json").write_text(json.dumps(scene))
    with pytest.raises(InputError, match="bad.json: " + said):
        core.SceneFile(folder / "bad.json")
