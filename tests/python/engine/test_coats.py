"""Clear coats and films of water on the surface: what they reflect, let in and let out."""

from __future__ import annotations

import numpy as np
import pytest

from baked import write_levels
from quadgraph import Engine, InputError, Material, VolumeMaterial
from quadgraph.baking.bodies import BodyMesh, bake_bodies
from quadgraph.baking.pipeline import BakeOptions
from quadgraph.mesh.surface import Surface
from shapes import icosphere, torus, write_obj

RADIUS = 10.0
CAMERA = {"azimuth": 0.0, "elevation": 0.0, "distance": 400.0, "fov": 3.2}
LOOK = {"width": 48, "height": 48}
LAMP = "directional:0.5,-0.3,-1:1"
BODY = "sigma_s_prime=1,sigma_a=0.02"


@pytest.fixture(scope="module")
def ball(tmp_path_factory):
    path = tmp_path_factory.mktemp("coats") / "ball.qgraph"
    write_levels(path, [icosphere(3, RADIUS)])
    return path


@pytest.fixture(scope="module")
def engine(ball):
    with Engine(ball, device="cpu") as made:
        yield made


def solved(engine: Engine, material: str | Material | VolumeMaterial, lights: list[str], **options):
    engine.material, engine.lights = material, lights
    return engine.solve(correction=False, **options)


def reflected(engine: Engine, material: str, lights: list[str], **options) -> np.ndarray:
    solved(engine, material, lights)
    return np.asarray(engine.render(CAMERA, **LOOK, **options).specular)


@pytest.mark.parametrize("radiance", ["gathered", "lambertian"])
@pytest.mark.parametrize("coat", ["coat=water", "coat=0.5,coat_eta=1.8"])
def test_a_body_that_absorbs_nothing_vanishes_in_even_light(engine, coat, radiance):
    """What the coat reflects and what goes in and comes out through it add up to one."""
    # Lambertian radiance leaves a smooth surface, whatever mirrors.
    rough = "roughness=0.5,coat_roughness=0.2" if radiance == "gathered" else "roughness=0.02,coat_roughness=0.02"
    material = f"sigma_s_prime=1,sigma_a=0,eta=1.4,{coat},{rough}"
    solved(engine, material, [f"ambient:{np.pi}"], tolerance=1e-5)
    picture = engine.render(CAMERA, **LOOK, radiance=radiance, samples=16)
    inside = np.asarray(picture.alpha) > 0.999
    total = np.asarray(picture.scattered + picture.specular + picture.unscattered)[inside, 0]
    print(f"mean {total.mean():.4f}, off {np.quantile(np.abs(total - 1), 0.95):.4f} in 95% of all pixels")
    assert total.mean() == pytest.approx(1, abs=0.02)  # bare it is .985
    assert np.quantile(np.abs(total - 1), 0.95) < 0.05


@pytest.mark.parametrize("lights", [[LAMP], ["ambient:1"], ["environment:studio:0:1"]])
def test_a_coat_of_the_body_s_own_index_is_the_body_as_rough_as_the_coat(engine, lights):
    rough, fine = (reflected(engine, f"{BODY},eta=1.5,roughness={alpha}", lights) for alpha in (0.5, 0.1))
    coat = f"{BODY},eta=1.5,roughness=0.5,coat_eta=1.5,coat_roughness=0.1"
    whole, half = (reflected(engine, f"{coat},coat={share}", lights) for share in (1, 0.5))
    size = np.linalg.norm(fine)
    assert np.linalg.norm(rough - fine) > 0.1 * size
    # In light from all around what a body reflects is read from a table, by its roughness; of a coat it is exact.
    most = 1e-5 if lights == [LAMP] else 5e-3
    assert np.linalg.norm(whole - fine) < most * size
    assert np.linalg.norm(half - 0.5 * (rough + fine)) < most * size


def test_water_on_a_rough_body_makes_a_sharp_highlight_and_takes_its_dull_one(engine):
    dry = reflected(engine, f"{BODY},eta=1.36,roughness=0.6", [LAMP])
    wet = reflected(engine, f"{BODY},eta=1.36,roughness=0.6,coat=water", [LAMP])
    assert wet.max() > 20 * dry.max()
    away = dry[..., 0] < 0.5 * dry[..., 0].max()
    assert wet[away].sum() < 0.2 * dry[away].sum()


def test_what_leaves_below_a_coat_of_the_body_s_index_is_as_smooth_as_the_coat(engine):
    clear = "sigma_s_prime=0.03,sigma_a=0.02,eta=1.5,roughness=0.5"

    def scattered(material: str, **options) -> np.ndarray:
        solved(engine, material, [LAMP])
        return np.asarray(engine.render(CAMERA, **LOOK, samples=16, **options).scattered)

    smooth = scattered(clear, transmission_roughness=0.03)
    coated = scattered(f"{clear},coat=lacquer")
    assert np.linalg.norm(coated - smooth) < 0.01 * np.linalg.norm(smooth)
    assert np.linalg.norm(scattered(clear) - smooth) > 0.05 * np.linalg.norm(smooth)


def entered(engine: Engine, material: str, **options) -> float:
    return float(solved(engine, material, ["ambient:1"], **options).energy.entered[0])


def test_less_light_enters_through_a_coat_and_as_much_as_it_says(engine):
    bare, coated, half = (entered(engine, f"{BODY},eta=1,coat_eta=1.5,coat={share}") for share in (0, 1, 0.5))
    # A plate of index 1.5 lets 1 - 2 r / (1 + r) of even light through, r by polarisation: the mean of both here.
    cosine = (np.arange(2000) + 0.5) / 2000
    beyond = np.sqrt(1 - (1 - cosine**2) / 1.5**2)
    r = np.array([(cosine - 1.5 * beyond) / (cosine + 1.5 * beyond), (1.5 * cosine - beyond) / (1.5 * cosine + beyond)])
    plate = (2 * cosine * (1 - 2 * r**2 / (1 + r**2)).mean(axis=0)).mean()
    assert coated / bare == pytest.approx(plate, rel=1e-5)
    assert half / bare == pytest.approx(0.5 * (1 + plate), rel=1e-5)


def test_a_solve_from_the_last_solution_knows_that_a_coat_came(engine):
    cold = solved(engine, f"{BODY},eta=1,coat=lacquer", ["ambient:1"], tolerance=1e-6).energy
    solved(engine, f"{BODY},eta=1", ["ambient:1"], tolerance=1e-6)
    warm = solved(engine, f"{BODY},eta=1,coat=lacquer", ["ambient:1"], tolerance=1e-6, warm=True).energy
    assert warm.entered[0] == pytest.approx(cold.entered[0], rel=1e-6)
    assert warm.scattered_out[0] == pytest.approx(cold.scattered_out[0], rel=1e-4)


def test_another_material_takes_the_coat_away(engine):
    bare = entered(engine, f"{BODY},eta=1")
    for later in (
        Material(1.0, 0.02, eta=1.0),
        VolumeMaterial(np.full((2, 2, 2), 1.0), np.full((2, 2, 2), 0.02), 10.0, eta=1.0),
    ):
        assert entered(engine, f"{BODY},eta=1,coat=lacquer") < 0.95 * bare
        assert entered(engine, later) == pytest.approx(bare, rel=1e-6)


def test_a_volume_has_one_behind_its_name(engine, tmp_path):
    volume = VolumeMaterial(np.full((2, 2, 2), 1.0), np.full((2, 2, 2), 0.02), 10.0, eta=1.0)
    volume.save(tmp_path / "even.npz")
    bare = entered(engine, f"{tmp_path / 'even.npz'}")
    coated = entered(engine, f"{tmp_path / 'even.npz'},coat=lacquer")
    assert coated == pytest.approx(entered(engine, f"{BODY},eta=1,coat=lacquer"), rel=1e-5)
    assert coated < 0.95 * bare
    with pytest.raises(InputError, match="coat': found '2'"):
        engine.material = f"{tmp_path / 'even.npz'},coat=2"


def test_each_of_several_bodies_has_its_own(tmp_path):
    ring = torus(6.0, 1.0, 24, 12)
    far = Surface(ring.vertices + np.array([30.0, 0, 0]), ring.triangles)
    meshes = [BodyMesh("ball", write_obj(icosphere(2, 3.0), tmp_path / "a.obj"), unit="mm")]
    meshes.append(BodyMesh("ring", write_obj(far, tmp_path / "b.obj"), unit="mm"))
    bake_bodies(meshes, tmp_path / "two.qgraph", BakeOptions())
    with Engine(tmp_path / "two.qgraph", device="cpu") as made:
        made.lights = ["ambient:1"]
        found = {}
        for name, coats in (("none", ("", "")), ("ball", (",coat=lacquer", "")), ("both", (",coat=lacquer",) * 2)):
            made.materials = {"ball": f"{BODY},eta=1{coats[0]}", "ring": f"{BODY},eta=1{coats[1]}"}
            found[name] = float(made.solve(correction=False).energy.entered[0])
    assert found["none"] > 1.01 * found["ball"] > 1.02 * found["both"]


@pytest.mark.parametrize("coat", ["coat=water", "coat=0.6,coat_eta=1.7"])
def test_light_of_shortest_paths_enters_through_it(engine, coat):
    solved(engine, f"{BODY},eta=1,{coat}", ["ambient:1"], method="shortest-path")
    through = np.asarray(engine.render(CAMERA, **LOOK).scattered)
    solved(engine, f"{BODY},eta=1", ["ambient:1"], method="shortest-path")
    without = np.asarray(engine.render(CAMERA, **LOOK).scattered)
    assert 0.8 < through.sum() / without.sum() < 0.97


def test_derivatives_refuse_it(engine):
    solved(engine, f"{BODY},eta=1.3,coat=0.5", [LAMP])
    with pytest.raises(InputError, match=r"derivatives: coat=0\.5 found, allowed is a bare surface"):
        engine.forward_model()


def test_a_material_keeps_it_in_its_text():
    coated = Material.parse("jade,coat=water")
    assert (coated.coat, coated.coat_roughness) == (1, pytest.approx(0.02))
    assert Material.parse(coated.text) == coated
    assert Material.parse("jade").coat is None
    with pytest.raises(InputError, match=r"material field 'coat_eta': found '0\.5', allowed is 1 to 3"):
        Material(1.0, 0.1, coat=1.0, coat_eta=0.5)
