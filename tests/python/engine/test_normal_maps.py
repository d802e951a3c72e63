"""Normal maps: a plate that leans as its image says reflects, and lets light out, as one that is turned."""

from __future__ import annotations

import json
import subprocess
from pathlib import Path

import jsonschema
import numpy as np
import pytest
from PIL import Image

import quadgraph
from baked import write_levels
from engine_program import ENGINE, assert_refused
from light_truth import write_hdr
from quadgraph import cli
from quadgraph.base.errors import InputError
from quadgraph.mesh.subdivide import subdivide
from shapes import cube

core = pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")

SCHEMA = Path(__file__).resolve().parents[3] / "docs" / "scene.schema.json"
ETA, ALPHA, SIDE = 1.4, 0.3, 20.0
LIGHT = np.array([0.5, 0.2, 1.0]) / np.linalg.norm([0.5, 0.2, 1.0])  # towards it
EVEN = [{"type": "ambient", "irradiance": 1.0}]  # enters by the mesh
BOX = {"centre": [0, 0, 0], "size": [1.001 * SIDE] * 3}
TOL = 2e-3


def texel(slopes: tuple[float, float]) -> np.ndarray:
    """A colour of a normal map, uint8."""
    normal = np.array([*slopes, 1.0]) / np.sqrt(1 + slopes[0] ** 2 + slopes[1] ** 2)
    return np.round((normal + 1) / 2 * 255).astype(np.uint8)


def slopes_of(colour: np.ndarray) -> np.ndarray:
    """What the engine reads of it."""
    normal = colour / 255 * 2 - 1
    return normal[:2] / normal[2]


LEANING, STEEP, FLAT = texel((0.35, -0.1)), texel((1.8, 0.0)), np.array([128, 128, 255], np.uint8)


@pytest.fixture(scope="module")
def folder(tmp_path_factory) -> Path:
    path = tmp_path_factory.mktemp("normal-maps")
    plate = subdivide(cube(SIDE), 3)
    write_levels(path / "plate.qgraph", [plate, subdivide(cube(SIDE), 2)], rays=64)
    for name, colour in (("leaning", LEANING), ("steep", STEEP), ("flat", FLAT)):
        Image.fromarray(np.tile(colour, (8, 8, 1))).save(path / f"{name}.png")
    four = [[texel((0.25, 0)), texel((0, 0.25))], [texel((0, -0.25)), texel((-0.25, 0))]]
    Image.fromarray(np.tile(np.array(four), (512, 512, 1))).save(path / "pyramids.png")
    noise = np.random.default_rng(3).integers(0, 256, (64, 64, 3), np.uint8)
    noise[:, :, 2] = np.maximum(noise[:, :, 2], 140)
    Image.fromarray(noise).save(path / "noise.png")
    quarters = np.zeros((64, 128, 3))
    quarters[:, :, 0], quarters[:, :, 1] = np.arange(128) / 128, 1 - np.arange(128) / 128
    write_hdr(path / "sky.hdr", quarters)
    return path


def shown(folder: Path, map_: dict | None, shows: float = 12, lights: list | None = None, **changed):
    """The plate from +z, so many mm of it from the bottom to the top of the picture."""
    light = {"type": "directional", "direction": (-LIGHT).tolist(), "irradiance": 2.0}
    scene = {
        "body": "plate.qgraph",
        "material": f"sigma_s_prime=1.2,sigma_a=0.02,eta={ETA},roughness={ALPHA}",
        "lights": lights or [light],
        "solver": changed.pop("solver", {"correction": False}),
        "camera": {"azimuth": 0, "elevation": 0, "orthographic": shows, **changed.pop("camera", {})},
        "deformation": changed.pop("deformation", []),
        "picture": {"width": 24, "height": 24, "samples": 4, "radiance": "lambertian", **changed},
    }
    if map_ is not None:
        scene["picture"]["normal_map"] = map_
    (folder / "scene.json").write_text(json.dumps(scene))
    file = core.SceneFile(folder / "scene.json")
    jsonschema.validate(json.loads(file.at(0).json()), json.loads(SCHEMA.read_text()))
    stage = core.Stage(validation=True)
    stage.show(file.at(0))
    stage.solve()
    picture = stage.render()
    assert stage.engine.validation_messages == []
    return picture


def mean(layer) -> np.ndarray:
    """(3,) of a layer that is the same in all pixels."""
    found = np.asarray(layer)
    assert np.isfinite(found).all()
    assert np.abs(found - found.mean(axis=(0, 1))).max() <= TOL * np.abs(found).max()
    return found.mean(axis=(0, 1))


def reflectance(cosine: float) -> float:
    cos_t = np.sqrt(1 - (1 - cosine**2) / ETA**2)
    s, p = (cosine - ETA * cos_t) / (cosine + ETA * cos_t), (ETA * cosine - cos_t) / (ETA * cosine + cos_t)
    return (s**2 + p**2) / 2


def reflected(n: np.ndarray, v: np.ndarray, light: np.ndarray, alpha: float) -> float:
    """GGX with height-correlated Smith masking, times the cosine of incidence, 1/sr."""
    h = (v + light) / np.linalg.norm(v + light)
    nl, nv, nh, a2 = n @ light, n @ v, n @ h, alpha**2
    d = a2 / (np.pi * (nh**2 * (a2 - 1) + 1) ** 2)
    smith = [np.sqrt(1 + a2 * (1 / c**2 - 1)) for c in (nl, nv)]
    g = min(light[2] / (nl * n[2]), 1)  # of the plate that leans (Chiang et al. 2019)
    return d * reflectance(v @ h) * 2 / sum(smith) / (4 * nl * nv) * nl * (g + g**2 - g**3)


def leaned(slopes: np.ndarray, v: np.ndarray) -> np.ndarray:
    """The normal of the plate, so that what is mirrored towards v stays .01 above it."""
    n = np.array([*slopes, 1.0]) / np.sqrt(1 + slopes @ slopes)
    mirrored = 2 * (n @ v) * n - v
    if mirrored[2] < 0.01:
        mirrored[2] = 0.01
        n = v + mirrored / np.linalg.norm(mirrored)
    return n / np.linalg.norm(n)


EYE = np.array([0.0, 0.0, 1.0])


@pytest.mark.parametrize(("name", "colour"), [("leaning", LEANING), ("steep", STEEP)])
def test_light_is_reflected_and_let_out_as_by_a_plate_that_leans(folder, name, colour):
    """A steep one mirrors towards the eye what is just above the plate, never what is behind it."""
    picture, plain = shown(folder, {"image": f"{name}.png"}), shown(folder, None)
    n = leaned(slopes_of(colour), EYE)
    assert mean(picture.specular) == pytest.approx(2 * reflected(n, EYE, LIGHT, ALPHA), rel=TOL)
    assert mean(plain.specular) == pytest.approx(2 * reflected(EYE, EYE, LIGHT, ALPHA), rel=TOL)
    through = (1 - reflectance(n @ EYE)) / (1 - reflectance(1.0))
    shares = np.divide(*(shown(folder, map_, lights=EVEN).scattered for map_ in ({"image": f"{name}.png"}, None)))
    assert shares == pytest.approx(np.full(shares.shape, through), rel=TOL)


def test_surfaces_of_shortest_paths_lean_too(folder):
    picture = shown(folder, {"image": "leaning.png"}, solver={"method": "shortest-path"})
    n = leaned(slopes_of(LEANING), EYE)
    assert mean(picture.specular) == pytest.approx(2 * reflected(n, EYE, LIGHT, ALPHA), rel=TOL)


def test_strength_multiplies_slopes_and_none_is_as_without(folder):
    half = shown(folder, {"image": "leaning.png", "strength": 0.5, "placement": BOX})
    n = leaned(slopes_of(LEANING) / 2, EYE)
    assert mean(half.specular) == pytest.approx(2 * reflected(n, EYE, LIGHT, ALPHA), rel=TOL)
    none = shown(folder, {"image": "noise.png", "strength": 0})
    assert np.allclose(none.specular, shown(folder, None).specular, rtol=1e-4)
    beside = shown(folder, {"image": "leaning.png", "placement": {"centre": [40, 0, 0], "size": [20, 20, 20]}})
    assert np.allclose(beside.specular, shown(folder, None).specular, rtol=1e-4)


def test_the_map_turns_and_leans_with_the_body(folder):
    """Turned about z by 90 degrees; stretched along x to twice the width, where a height has half the slope."""
    slopes = slopes_of(LEANING)
    turned = shown(
        folder, {"image": "leaning.png"}, deformation=[{"type": "transform", "axis": [0, 0, 1], "degrees": 90}]
    )
    n = leaned(np.array([-slopes[1], slopes[0]]), EYE)
    assert mean(turned.specular) == pytest.approx(2 * reflected(n, EYE, LIGHT, ALPHA), rel=TOL)
    wide = shown(folder, {"image": "leaning.png"}, deformation=[{"type": "transform", "scale": [2, 1, 1]}])
    n = leaned(slopes / [2, 1], EYE)
    assert mean(wide.specular) == pytest.approx(2 * reflected(n, EYE, LIGHT, ALPHA), rel=TOL)


def test_what_is_finer_than_a_pixel_makes_the_surface_rougher(folder):
    """From afar what leans to four sides is a roughness; the light is nearly that of the four seen from near."""
    far = shown(folder, {"image": "pyramids.png"})
    slope = slopes_of(texel((0.25, 0)))[0]
    rough = np.sqrt(ALPHA**2 + slope**2)
    assert mean(far.specular) == pytest.approx(2 * reflected(EYE, EYE, LIGHT, rough), rel=0.02)
    near = np.asarray(shown(folder, {"image": "pyramids.png"}, shows=0.2).specular).mean(axis=(0, 1))
    assert near == pytest.approx(mean(far.specular), rel=0.05)
    assert near != pytest.approx(mean(shown(folder, None).specular), rel=0.1)


def test_slopes_get_no_light_through_the_body(folder):
    """A lamp behind the plate, towards which a slope leans."""
    behind = [{"type": "directional", "direction": [-1, 0, 0.2], "irradiance": 2.0}]
    picture = shown(folder, {"image": "steep.png"}, lights=behind)
    assert np.abs(picture.specular).max() == 0
    before = [{"type": "directional", "direction": [-1, 0, -0.2], "irradiance": 2.0}]
    assert np.min(shown(folder, {"image": "steep.png"}, lights=before).specular) > 1e-3


def test_nothing_leaps_where_a_pixel_shows_more_texels(folder):
    """From one mip level to the next in small steps; the nearest one would change at 1.41 texels a sample."""

    def seen(texels: float) -> float:
        shows = texels * 48 * BOX["size"][0] / 1024  # mm of 24 pixels with 2 samples each
        return float(np.asarray(shown(folder, {"image": "pyramids.png", "strength": 3}, shows=shows).specular).mean())

    fine, before, after, coarse = map(seen, (1.1, 1.38, 1.45, 2.2))
    assert abs(fine - coarse) > 0.04 * coarse
    assert abs(before - after) < abs(fine - coarse) / 3


def test_what_is_mirrored_of_a_sky_goes_by_the_map(folder):
    """Leaning by half the angle shows what is the angle aside: as a sky that is turned."""

    def sky(turn: float) -> list:
        return [{"type": "environment", "file": "sky.hdr", "radiance": 1, "turn": turn}]

    n = leaned(slopes_of(LEANING) * [1, 0], EYE)
    Image.fromarray(np.tile(texel(tuple(slopes_of(LEANING) * [1, 0])), (4, 4, 1))).save(folder / "aside.png")
    aside = 2 * np.degrees(np.arctan2(n[0], n[2]))
    leaning = mean(shown(folder, {"image": "aside.png"}, lights=sky(0), roughness=0.05).specular)
    straight, turned = (mean(shown(folder, None, lights=sky(t), roughness=0.05).specular) for t in (0, -aside))
    assert leaning[:2] / leaning[:2].sum() == pytest.approx(turned[:2] / turned[:2].sum(), abs=0.01)
    assert abs(leaning[0] / leaning[:2].sum() - straight[0] / straight[:2].sum()) > 0.05


@pytest.mark.parametrize("radiance", ["gathered", "single", "lambertian"])
def test_any_map_gives_light_that_is_finite_and_positive(folder, radiance):
    aside = {"shows": 40, "camera": {"azimuth": 70, "elevation": 15}, "radiance": radiance}
    noisy = {"image": "noise.png", "strength": 10}
    rough = {"image": "flat.png", "placement": BOX, "roughness": 0.05}
    lit, even = (shown(folder, noisy, lights=lights, roughness_map=rough, **aside) for lights in (None, EVEN))
    for picture in (lit, even):
        for layer in ("scattered", "specular", "unscattered", "alpha"):
            assert np.isfinite(getattr(picture, layer)).all()
            assert np.min(getattr(picture, layer)) >= 0
    plain = shown(folder, None, lights=EVEN, **aside)
    ratio = np.asarray(even.scattered).sum() / np.asarray(plain.scattered).sum()
    assert 0.6 < ratio < 1.1


def test_view_rays_enter_by_the_map(folder):
    """What is gathered along a view ray goes another way, and less comes out by Fresnel."""
    leaning, plain = (
        np.asarray(shown(folder, map_, radiance="gathered", lights=EVEN).scattered).mean(axis=(0, 1))
        for map_ in ({"image": "steep.png"}, None)
    )
    through = (1 - reflectance(leaned(slopes_of(STEEP), EYE) @ EYE)) / (1 - reflectance(1.0))
    assert (leaning / plain < 1.05 * through).all()
    assert (leaning / plain > 0.7 * through).all()
    assert (np.abs(leaning / plain / through - 1) > 0.002).all()


def test_the_command_line_lays_it_over_the_body(folder, tmp_path):
    body = ["render", str(folder / "plate.qgraph"), "--light", "directional:-.5,-.2,-1:2", "--no-correction"]
    body += ["--size", "32x32", "--samples", "4", "--view", "0,0"]
    for name in ("none", "leaning"):
        given = [] if name == "none" else ["--normal-map", str(folder / "leaning.png")]
        assert cli.main([*body, *given, "-o", str(tmp_path / f"{name}.png")]) == 0
        inside = ["--show", "q", "--size", "240x240"]
        assert cli.main([*body, *given, *inside, "-o", str(tmp_path / f"{name}-q.png")]) == 0
    pictures = [np.asarray(Image.open(tmp_path / f"{name}.png"), int) for name in ("none", "leaning")]
    assert np.abs(pictures[0] - pictures[1])[8:24, 8:24].mean() > 0.5
    entered = [np.asarray(Image.open(tmp_path / f"{name}-q.png")) for name in ("none", "leaning")]
    assert not np.array_equal(*entered)  # the numbers of the legend
    scene = {"body": str(folder / "plate.qgraph"), "picture": {"normal_map": {"image": str(folder / "leaning.png")}}}
    (tmp_path / "scene.json").write_text(json.dumps(scene))
    for text in (core.SceneFile(tmp_path / "scene.json").at(0).json(), json.dumps(scene)):
        assert json.loads(text)["picture"]["normal_map"]["image"] == str(folder / "leaning.png")


def dark(path: Path) -> None:
    Image.fromarray(np.full((4, 4, 3), 90, np.uint8)).save(path)


def cut_off(path: Path) -> None:
    Image.fromarray(np.full((64, 64, 3), 200, np.uint8)).save(path)
    path.write_bytes(path.read_bytes()[:60])


def huge(path: Path) -> None:
    Image.new("RGB", (20000, 3), (128, 128, 255)).save(path)


@pytest.mark.parametrize(
    ("changed", "write", "said"),
    [
        ({"image": "none.png"}, None, "/picture/normal_map/image: .*none.png: cannot be read"),
        ({"image": "dark.png"}, dark, "dark.png: blue of 100% of the texels found at or below the middle"),
        ({"image": "cut.png"}, cut_off, "cut.png: "),
        ({"image": "huge.png"}, huge, "huge.png: found 20000x3 texels, expected 1 to 16384 a side"),
        ({"image": "sky.hdr"}, None, "sky.hdr: expected an image whose name ends in .png"),
        ({"strength": 11}, None, "normal_map, strength: found 11, expected 0 to 10"),
        ({"strength": -1}, None, "normal_map, strength: found -1"),
        ({"placement": {"centre": [0, 0, 0], "size": [1, 1, 0]}}, None, "/picture/normal_map/placement: size: found 0"),
        ({"turn": 1}, None, "/picture/normal_map/turn"),
    ],
)
def test_what_is_no_normal_map_is_said(folder, changed, write, said):
    if write is not None:
        write(folder / changed["image"])
    scene = {"body": "plate.qgraph", "picture": {"normal_map": {"image": "leaning.png", **changed}}}
    (folder / "bad.json").write_text(json.dumps(scene))
    with pytest.raises(InputError, match="bad.json: .*" + said):
        core.SceneFile(folder / "bad.json")


def test_python_and_the_standalone_program_take_it(folder, tmp_path):
    body, image = folder / "plate.qgraph", str(folder / "leaning.png")
    with quadgraph.Engine(body, device="cpu") as engine:
        engine.material = "marble"
        engine.solve(correction=False)
        found = [
            np.asarray(engine.render("0,0", width=32, height=32, samples=4, **picture).specular).sum()
            for picture in ({}, {"normal_map": {"image": image}}, {"normal_map": {"image": image, "strength": 0}})
        ]
    assert abs(found[1] / found[0] - 1) > 0.02
    assert found[2] == pytest.approx(found[0], rel=1e-3)
    assert ENGINE is not None
    program = [ENGINE, str(body), "--headless", "--size", "16x16", "--normal-map"]
    done = subprocess.run([*program, image, "-o", str(tmp_path / "a.png")], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    refused = [*program, str(tmp_path / "none.png"), "-o", str(tmp_path / "b.png")]
    done = subprocess.run(refused, capture_output=True, text=True, check=False)
    assert_refused(done, "normal-map: ", "none.png: cannot be read")
    assert not (tmp_path / "b.png").exists()
