"""Bodies of one file, each at its own index of refraction."""

from __future__ import annotations

import functools
import subprocess

import numpy as np
import pytest
from scipy.spatial import cKDTree

from engine_program import ENGINE
from quadgraph import Engine
from quadgraph.baking.bodies import BodyMesh, bake_bodies
from quadgraph.baking.pipeline import BakeOptions, bake
from quadgraph.baking.placing import BodyPlacement
from quadgraph.base.errors import InputError
from shapes import icosphere, write_obj

pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")

LOW = "sigma_s_prime=1.5,sigma_a=0.002/0.01/0.05,eta=1.05"
HIGH = "sigma_s_prime=1,sigma_a=0.02/0.004/0.03,eta=1.7"
LIGHTS = ["directional:-0.3,-0.4,-1:1", "environment:studio:0:1"]
BALL = icosphere(3, 5.0)
FAR = 400.0  # mm, from the middle of one to that of the other


@pytest.fixture(scope="module")
def mesh(tmp_path_factory):
    return write_obj(BALL, tmp_path_factory.mktemp("mesh") / "ball.obj")


@pytest.fixture(scope="module")
def baked(mesh, tmp_path_factory):
    """Two balls near each other, in both orders, two that are far from each other, and one that is alone."""
    folder = tmp_path_factory.mktemp("balls")
    options = BakeOptions(visibility_rays=256)
    files = {name: folder / f"{name}.qgraph" for name in ("near", "turned", "far", "alone")}
    near = [BodyMesh("left", mesh, unit="mm"), BodyMesh("right", mesh, BodyPlacement((10.5, 0, 0)), "mm")]
    bake_bodies(near, files["near"], options)
    bake_bodies(near[::-1], files["turned"], options)
    bake_bodies([near[0], BodyMesh("right", mesh, BodyPlacement((FAR, 0, 0)), "mm")], files["far"], options)
    bake(mesh, files["alone"], BakeOptions(unit="mm", visibility_rays=256))
    return files


def of_bodies(engine: Engine, values: np.ndarray) -> dict[str, np.ndarray]:
    """Values of the faces of level 0 by the names of bodies, in the order of the faces of their one mesh."""
    level = engine._engine.graph.levels[0]
    of = level.tet_bodies[level.face_tets] if engine.bodies else np.zeros(len(level.faces), int)
    place, found = level.nodes[len(level.tets) :], {}
    for body, name in enumerate(engine.bodies or ("alone",)):
        mine = np.flatnonzero(of == body)
        middle = np.array([np.round(2 * place[mine, 0].mean()) / 2, 0, 0])
        gaps, order = cKDTree(place[mine] - middle).query(BALL.corners.mean(axis=1))
        assert gaps.max() < 1e-3
        found[name] = values[mine[order]]
    return found


def shown(path, materials: dict, lights=LIGHTS, **options):
    """Exitance by body, and the energy, of a solve."""
    with Engine(path) as engine:
        if engine.bodies:
            engine.materials = materials
        else:
            engine.material = materials["alone"]
        engine.lights = lights
        solution = engine.solve(**options)
        return of_bodies(engine, np.asarray(engine.surface().exitance)), solution


def off(found: np.ndarray, wanted: np.ndarray) -> float:
    return float(np.linalg.norm(found - wanted) / np.linalg.norm(wanted))


WAYS = {
    "diffusion": {"correction": False, "tolerance": 1e-6, "model": "diffusion"},
    "sp3": {"correction": False, "tolerance": 1e-6, "model": "sp3"},
    "finite volumes": {"correction": False, "tolerance": 1e-6, "model": "sp3", "method": "quadgraph-fv"},
    "as published": {"correction": False, "tolerance": 1e-6, "method": "quadgraph-fdm", "source": "diffuse"},
    "diffuse source": {"correction": False, "tolerance": 1e-6, "model": "sp3", "source": "diffuse"},
    "corrected": {"model": "sp3", "sweeps": 2, "sweep_points": 200_000},  # else more are drawn for one than for another
}


def at_index(material: str, eta: float) -> str:
    return f"{material.rsplit(',', 1)[0]},eta={eta:g}"


# Sweeps keep the energy of all bodies together: another material of the other one, at the same index, changes this one
# by up to 0.25%.
CLOSE = {"corrected": 3e-3}


@pytest.mark.parametrize("way", WAYS)
def test_a_body_far_from_one_of_another_index_is_as_beside_one_of_its_own(baked, way):
    both, _ = shown(baked["far"], {"left": LOW, "right": HIGH}, **WAYS[way])
    low, _ = shown(baked["far"], {"left": LOW, "right": at_index(HIGH, 1.05)}, **WAYS[way])
    high, _ = shown(baked["far"], {"left": at_index(LOW, 1.7), "right": HIGH}, **WAYS[way])
    assert off(both["left"], low["left"]) < CLOSE.get(way, 1e-4)
    assert off(both["right"], high["right"]) < CLOSE.get(way, 1e-4)
    assert off(low["right"], high["right"]) > 0.03
    assert off(low["left"], high["left"]) > 0.03


def eighths(values: np.ndarray) -> list[np.ndarray]:
    """Values of faces by the eighth of the ball that they are in."""
    side = (BALL.corners.mean(axis=1) > 0) @ (1, 2, 4)
    return [values[side == number] for number in range(8)]


@pytest.fixture(scope="module")
def alone(baked):
    """What `shown` gives of the ball that is alone, of a material and a way, which two tests ask for."""
    return functools.cache(lambda material, way: shown(baked["alone"], {"alone": material}, ["ambient:1"], **WAYS[way]))


@pytest.mark.parametrize("way", ["sp3", "corrected"])
@pytest.mark.parametrize(("left", "right"), [(LOW, HIGH), (HIGH, LOW)], ids=["low", "high"])
def test_a_body_far_from_one_of_another_index_is_as_alone(baked, alone, way, left, right):
    """Of the left one, whose tets are those of the one that is alone; power of both."""
    both, solution = shown(baked["far"], {"left": left, "right": right}, ["ambient:1"], **WAYS[way])
    mine, own = alone(left, way)
    _, other = alone(right, way)
    close = 5e-3 if way == "corrected" else 1e-3  # noise; and each takes some of the other's sky
    means = (np.array([np.mean(each, axis=0) for each in eighths(found)]) for found in (both["left"], mine["alone"]))
    assert off(*means) < close
    for part in ("entered", "absorbed", "scattered_out"):
        found, wanted = getattr(solution.energy, part), getattr(own.energy, part) + getattr(other.energy, part)
        assert np.allclose(found, wanted, rtol=close), part


@pytest.mark.parametrize("radiance", ["gathered", "lambertian", "single"])
def test_a_picture_shows_each_body_at_its_index(baked, radiance):
    """Of two that are far from each other, looked at one by one."""
    materials = {"left": LOW, "right": HIGH}
    of_one = {"left": materials | {"right": at_index(HIGH, 1.05)}, "right": materials | {"left": at_index(LOW, 1.7)}}
    eyes = {name: {"eye": (x - 30, 5, 30), "look_at": (x, 0, 0)} for name, x in (("left", 0.0), ("right", FAR))}

    def pictures(engine, chosen):
        engine.materials = chosen
        engine.solve(**WAYS["sp3"])
        return {name: engine.render(eye, width=64, height=64, radiance=radiance) for name, eye in eyes.items()}

    with Engine(baked["far"]) as engine:
        engine.lights = LIGHTS
        both = pictures(engine, materials)
        for name, chosen in of_one.items():
            others = pictures(engine, chosen)
            for layer in ("scattered", "specular", "unscattered"):
                wanted, changed = np.asarray(getattr(others[name], layer)), np.asarray(getattr(both[name], layer))
                assert np.abs(changed - wanted).max() <= 1e-3 * wanted.max()
            other = "left" if name == "right" else "right"
            assert off(np.asarray(others[other].specular), np.asarray(both[other].specular)) > 0.1
            assert off(np.asarray(others[other].scattered), np.asarray(both[other].scattered)) > 0.02


def test_the_order_of_bodies_matters_no_more_than_at_one_index(baked):
    """The 256 rays from a face turn with its number, and the tets with the order."""

    def change(materials):
        one, _ = shown(baked["near"], materials, ["ambient:1"], **WAYS["sp3"])
        turned, _ = shown(baked["turned"], materials, ["ambient:1"], **WAYS["sp3"])
        return max(off(one[name], turned[name]) for name in materials)

    same, different = change({"left": LOW, "right": at_index(HIGH, 1.05)}), change({"left": LOW, "right": HIGH})
    assert different < 1.2 * same


def test_light_of_one_body_enters_another_at_the_index_of_that(baked):
    """Where both let out and in what an index of 1.05 does, where the right one does at 1.7, and where both do."""
    indices = [(low, high) for low in (1.05, 1.7) for high in (1.05, 1.7)]
    ways = {}
    for low, high in indices:
        materials = {"left": at_index(LOW, low), "right": at_index(HIGH, high)}
        ways[low, high] = shown(baked["near"], materials, ["ambient:1"], **WAYS["sp3"])
    again = {way: solution.energy.re_entered.sum() for way, (_, solution) in ways.items()}
    assert again[1.05, 1.7] < 0.99 * again[1.05, 1.05]
    assert again[1.7, 1.7] < 0.99 * again[1.05, 1.7]
    for _, solution in ways.values():
        assert np.abs(solution.energy.balance).max() < 1e-4


def test_a_change_of_one_index_takes_effect_at_the_next_solve(baked):
    with Engine(baked["near"]) as engine:
        engine.lights = LIGHTS
        engine.materials = {"left": LOW, "right": HIGH}
        engine.solve(**WAYS["sp3"])
        engine.materials = {"left": at_index(LOW, 1.4), "right": HIGH}
        engine.solve(**WAYS["sp3"])
        changed = np.asarray(engine.surface().exitance)
        engine.solve(motion=True, **WAYS["sp3"])
        engine.material = LOW
        engine.solve(**WAYS["sp3"])
        all_low = np.asarray(engine.surface().exitance)
    with Engine(baked["near"]) as engine:
        engine.lights = LIGHTS
        engine.materials = {"left": at_index(LOW, 1.4), "right": HIGH}
        engine.solve(**WAYS["sp3"])
        assert np.array_equal(changed, engine.surface().exitance)
        engine.material = LOW
        engine.solve(**WAYS["sp3"])
        assert np.array_equal(all_low, engine.surface().exitance)


def test_equal_indices_of_bodies_are_one_index(baked):
    with Engine(baked["near"]) as engine:
        engine.lights = LIGHTS
        engine.material = HIGH
        engine.solve(**WAYS["sp3"])
        one = np.asarray(engine.surface().exitance)
        engine.materials = {"left": HIGH, "right": HIGH}
        engine.solve(**WAYS["sp3"])
        assert off(engine.surface().exitance, one) < 1e-5


def test_walks_that_certify_a_solve_know_the_index_of_each_body(baked):
    with Engine(baked["near"]) as engine:
        engine.lights = LIGHTS
        found = {}
        for low, high in ((1.0, 1.6), (1.6, 1.0)):
            engine.materials = {"left": at_index(LOW, low), "right": at_index(HIGH, high)}
            found[low] = engine.solve(certify=2.0).certificate
    for certificate in found.values():
        assert certificate is not None
        assert certificate.whole.error < 0.03 + 2 * certificate.whole.error_noise
        assert certificate.unlit.error < 0.06 + 2 * certificate.unlit.error_noise


@pytest.mark.long
def test_devices_agree(baked):
    found = {}
    for device in ("cpu", "llvmpipe"):
        with Engine(baked["near"], device=device) as engine:
            engine.materials = {"left": LOW, "right": HIGH}
            engine.lights = LIGHTS[:1]
            engine.solve(model="sp3", sweeps=1, sweep_points=300)
            picture = engine.render(width=48, height=32)
            found[device] = np.asarray(engine.surface().exitance), picture.scattered, picture.specular
    for of_cpu, other in zip(*found.values(), strict=True):
        assert off(np.asarray(other), np.asarray(of_cpu)) < 5e-3  # edges of the picture


INDICES = {"below": 0.99, "above": 3.01, "huge": 1e30, "not a number": float("nan"), "infinite": float("inf")}


@pytest.mark.parametrize("eta", INDICES.values(), ids=INDICES)
def test_an_index_that_cannot_be_is_refused_by_the_name_of_its_body(baked, eta):
    with Engine(baked["near"]) as engine:
        engine.material = LOW
        with pytest.raises(InputError, match=r"material of 'right'.*'eta'.*(1 to 3|a finite number)"):
            engine.materials = {"left": LOW, "right": f"marble,eta={eta}"}
        assert engine.materials == {}
        with pytest.raises(InputError, match="eta"):
            engine.materials = {"left": LOW, "right": "marble,eta=glass"}
        assert engine.material == LOW


def test_derivatives_want_one_index_and_name_the_bodies_that_differ(baked):
    with Engine(baked["near"]) as engine:
        engine.lights = LIGHTS
        engine.materials = {"left": LOW, "right": HIGH}
        engine.solve(**WAYS["diffusion"])
        with pytest.raises(InputError, match=r"derivatives: eta=1.05 found of 'left' and eta=1.7 of 'right'.*same eta"):
            engine.forward_model()
        engine.materials = {"left": LOW, "right": at_index(HIGH, 1.05)}
        engine.solve(**WAYS["diffusion"])
        assert engine.forward_model() is not None


def test_a_volume_brings_the_index_of_its_body(baked, tmp_path):
    cell = np.ones((1, 1, 1, 3), np.float32)
    np.savez(tmp_path / "even.npz", sigma_s_prime=1.5 * cell, sigma_a=0.02 * cell, spacing=100.0, eta=1.6)
    text = "sigma_s_prime=1.5,sigma_a=0.02,eta=1.6"
    one, _ = shown(baked["near"], {"left": LOW, "right": text}, **WAYS["sp3"])
    other, _ = shown(baked["near"], {"left": LOW, "right": str(tmp_path / "even.npz")}, **WAYS["sp3"])
    for name in one:
        assert off(other[name], one[name]) < 1e-5


def test_the_program_of_the_engine_names_the_body_of_a_wrong_index(baked, tmp_path):
    picture = tmp_path / "two.png"
    command = [ENGINE, baked["near"], "--headless", "--material-of", "right=marble,eta=3.5", "-o", picture]
    done = subprocess.run([*map(str, command)], capture_output=True, text=True, check=False)
    assert done.returncode != 0
    assert "material of 'right': material field 'eta': found '3.5" in done.stderr
    assert not picture.exists()
