"""A stone in jelly, of tets that meet the surface that both share: exact answers, and what is refused."""

from __future__ import annotations

import numpy as np
import pytest

from quadgraph import Engine, Material, Scene, Stage
from quadgraph.baking.bodies import BodyMesh, bake_bodies
from quadgraph.baking.pipeline import BakeOptions, bake
from quadgraph.base.errors import InputError
from quadgraph.browser.shown_scene import ShownScene
from quadgraph_validation.truth.fresnel import transmittance_from_outside
from shapes import icosphere, moved, write_obj

pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")

JELLY, STONE = Material(1.0, 0.01, eta=1.4), Material(5.0, (0.1, 0.5, 0.02), eta=1.4)
SUN = ["directional:-1,-.4,.3:1"]
EXACTLY = {"correction": False, "tolerance": 1e-6, "model": "sp3"}


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    """A ball with a stone that has a core, and a pebble; the ball alone."""
    folder = tmp_path_factory.mktemp("stone")
    shapes = {
        "jelly": icosphere(4, 8.0),
        "stone": moved(icosphere(3, 3.0), 3.2, 1.0, 0.4),
        "core": moved(icosphere(2, 1.0), 3.2, 1.0, 0.4),
        "pebble": moved(icosphere(2, 1.0), -3.0, 2.0, 3.0),
    }
    meshes = [BodyMesh(name, write_obj(shape, folder / f"{name}.obj"), unit="mm") for name, shape in shapes.items()]
    bake_bodies(meshes, folder / "nest.qgraph", BakeOptions())
    bake(meshes[0].mesh, folder / "alone.qgraph", BakeOptions(unit="mm"))
    return folder / "nest.qgraph", folder / "alone.qgraph"


@pytest.fixture
def nest(files):
    with Engine(files[0], device="cpu") as engine:
        engine.materials = {"jelly": JELLY, "stone": STONE, "core": JELLY, "pebble": STONE}
        engine.lights = SUN
        yield engine


def exitance_of(engine, **options) -> np.ndarray:
    engine.solve(**(EXACTLY | options))
    return engine.surface().exitance


def off(found: np.ndarray, wanted: np.ndarray) -> float:
    return float(np.linalg.norm(found - wanted) / np.linalg.norm(wanted))


def test_one_material_for_all_is_that_of_the_body_without_stones(nest, files):
    nest.material = JELLY
    one = exitance_of(nest)
    nest.materials = dict.fromkeys(nest.bodies, JELLY)
    assert off(exitance_of(nest), one) < 1e-6  # a number for all tets, and one for each
    field = nest.surface()
    with Engine(files[1], device="cpu") as engine:
        engine.material, engine.lights = JELLY, SUN
        exitance_of(engine)
        alone = engine.surface()
        stated = engine.solve(**EXACTLY).error.whole
    # The same faces in another order: only tets inside differ.
    order, other = (np.lexsort(np.round(each.position, 4).T) for each in (field, alone))
    assert np.allclose(field.position[order], alone.position[other], atol=1e-4)
    assert off(field.exitance[order], alone.exitance[other]) < stated
    power = (field.exitance * field.area[:, None]).sum(axis=0) / (alone.exitance * alone.area[:, None]).sum(axis=0)
    assert power == pytest.approx(1, abs=2e-3)


@pytest.mark.parametrize("method", ["fem", "quadgraph-fv"])
@pytest.mark.parametrize("model", ["diffusion", "sp3"])
def test_a_furnace_is_even_whatever_scatters_within(nest, method, model):
    """Nothing absorbs, and the same enters everywhere: as much leaves each place."""
    scattering = dict(zip(nest.bodies, (1, 9, 0.3, 4), strict=True))
    nest.materials = {name: Material(value, 0.0, eta=1.4) for name, value in scattering.items()}
    nest.lights = ["ambient:1"]
    nest.solve(method=method, model=model, source="diffuse", correction=False, tolerance=1e-7)
    field = nest.surface()
    assert field.exitance == pytest.approx(field.q, rel=2e-4)


@pytest.mark.parametrize("options", [{}, {"method": "quadgraph-fv", "correction": False}, {"correction": False}])
def test_light_is_conserved_and_a_dark_stone_darkens(nest, options):
    solution = nest.solve(**options)
    assert np.abs(solution.energy.balance).max() < 5e-3
    with_stone = (nest.surface().exitance * nest.surface().area[:, None]).sum(axis=0)
    nest.materials = dict.fromkeys(nest.bodies, JELLY)
    nest.solve(**options)
    without = (nest.surface().exitance * nest.surface().area[:, None]).sum(axis=0)
    assert (with_stone < 0.995 * without).all()
    assert with_stone[1] < with_stone[0] < with_stone[2]  # as its channels absorb


def test_finite_volumes_agree_with_elements(nest):
    elements = exitance_of(nest)
    assert off(exitance_of(nest, method="quadgraph-fv"), elements) < 0.05


BENT = Material(5.0, (0.1, 0.5, 0.02), eta=1.7)


def test_an_index_of_its_own_counts_and_methods_without_it_say_so(nest):
    usual = exitance_of(nest)
    nest.materials = {"jelly": JELLY, "stone": BENT, "core": JELLY, "pebble": STONE}
    assert off(exitance_of(nest), usual) > 2e-3
    assert nest.solution.index_warning == ""
    nest.solve(method="quadgraph-fdm", **EXACTLY)
    assert nest.solution.index_warning == (
        "stone has the index of refraction 1.4 of jelly, which it lies within, and not its own of 1.7: what the "
        "surface between them mirrors and bends is left out by this method; --method fem and quadgraph-fv know it"
    )
    nest.material = JELLY
    nest.solve(**EXACTLY)
    assert nest.solution.index_warning == ""
    nest.materials = {"jelly": JELLY, "stone": STONE, "core": JELLY, "pebble": STONE}
    assert np.array_equal(exitance_of(nest), usual)


@pytest.mark.parametrize("method", ["fem", "quadgraph-fv"])
def test_light_within_a_furnace_is_as_the_square_of_the_index(nest, method):
    """In even light all radiance over the square of the index is the same, at the surface and within."""
    nest.materials = {name: Material(2.0, 0.0, eta=1.7 if name == "stone" else 1.4) for name in nest.bodies}
    nest.lights = ["ambient:1"]
    nest.solve(method=method, source="diffuse", correction=False, tolerance=1e-7)
    field = nest.surface()
    assert field.exitance == pytest.approx(field.q, rel=2e-4)
    jelly, stone, core = nest.fluence_at([[-6.0, 0, 0], [3.2, 3.2, 0.4], [3.2, 1.0, 0.4]])
    assert stone / jelly == pytest.approx(np.full(3, (1.7 / 1.4) ** 2), rel=1e-3)
    assert core / jelly == pytest.approx(np.ones(3), rel=1e-3)


@pytest.mark.parametrize("options", [{}, {"method": "quadgraph-fv", "correction": False}, {"correction": False}])
def test_light_is_conserved_where_it_is_bent_within(nest, options):
    nest.materials = {"jelly": JELLY, "stone": BENT, "core": Material(0.2, 0.001, eta=1.0), "pebble": STONE}
    assert np.abs(nest.solve(**options).energy.balance).max() < 5e-3


def test_derivatives_name_bodies_that_bend_light_within(nest):
    nest.materials = {"jelly": JELLY, "stone": BENT, "core": JELLY, "pebble": STONE}
    nest.solve(**EXACTLY)
    with pytest.raises(InputError, match="derivatives: found bodies within others with an index of refraction of"):
        nest.forward_model()


def through_balls(away, radii, indices, sigma_a):
    """Share of the light behind two clear balls about one middle that comes through, of rays so far from the middle;
    the outer one absorbs. What the inner one mirrors does not count, as its light comes from the side.
    """
    passes_out = transmittance_from_outside(np.sqrt(1 - (away / radii[0]) ** 2), indices[0])
    near = away / indices[0]  # of the ray from the middle, within the outer ball
    least, ratio = min(indices), max(indices) / min(indices)
    passes_in = transmittance_from_outside(np.sqrt(1 - (away / (least * radii[1])) ** 2), ratio)
    way = 2 * (np.sqrt(radii[0] ** 2 - near**2) - np.sqrt(radii[1] ** 2 - near**2))
    kept = passes_in**2 * np.exp(-sigma_a * way)
    return passes_out**2 * kept / (1 - (1 - passes_out) * kept)


def test_a_clear_stone_is_seen_as_its_index_has_it(tmp_path):
    """What comes through two clear balls about one middle by rays that both bend: Snell's and Beer's laws."""
    outer, inner, sigma_a = 5.0, 3.0, 0.05
    shapes = {"outer": icosphere(4, outer), "inner": icosphere(4, inner)}
    meshes = [BodyMesh(name, write_obj(shape, tmp_path / f"{name}.obj"), unit="mm") for name, shape in shapes.items()]
    bake_bodies(meshes, tmp_path / "balls.qgraph", BakeOptions())
    tinted = f"sigma_s_prime=0,sigma_a={sigma_a},eta=1.4"
    with Engine(tmp_path / "balls.qgraph", device="cpu") as engine:
        engine.lights = [f"ambient:{np.pi}"]
        for index in (1.0, 1.7):
            engine.materials = {"outer": tinted, "inner": f"sigma_s_prime=0,sigma_a=0,eta={index}"}
            engine.solve(correction=False)
            picture = engine._engine.render(
                view="0,0,600", vertical_fov=1.1, width=128, height=128, transmission_roughness=0
            )
            y, x = (np.mgrid[:128, :128] + 0.5 - 64) * 2 * 600 * np.tan(np.radians(0.55)) / 128
            away = np.hypot(x, y)
            passes = away < 0.9 * min(index, 1.4) * inner  # where the ray meets the stone and is not all mirrored there
            wanted = through_balls(away[passes], (outer, inner), (1.4, index), sigma_a)
            found = picture.transmittance[passes, 0]
            off_by = np.abs(found / wanted - 1)
            print(f"{index}: {100 * off_by.mean():.2f}% off, at most {100 * off_by.max():.2f}%")
            assert off_by.mean() < 0.003
            assert off_by.max() < 0.01  # flat faces


def test_roughness_is_that_of_the_outer_surface(nest):
    view = {"width": 64, "height": 48, "samples": 1}
    texts = {"jelly": "sigma_s_prime=1,sigma_a=.01,eta=1.4,roughness=.3"}
    pictures = []
    for of_stone in (".05", ".6"):
        texts["stone"] = f"sigma_s_prime=5,sigma_a=.1,eta=1.4,roughness={of_stone}"
        nest.materials = texts | {"core": texts["jelly"], "pebble": texts["stone"]}
        nest.solve(**EXACTLY)
        pictures.append(nest.render("10,20", **view).specular)
    assert np.array_equal(*pictures)


def test_hosts_are_told_and_a_pixel_shows_the_outermost(nest):
    assert nest.hosts == {"stone": "jelly", "core": "stone", "pebble": "jelly"}
    assert nest.body_at(32, 24, "10,20", width=64, height=48) == "jelly"


def test_the_outermost_body_takes_all_along_and_others_do_not_move_by_themselves(nest):
    at_rest = exitance_of(nest)
    for name in ("stone", "core"):
        with pytest.raises(InputError, match=rf"{name} found, .* within jelly .* place jelly, which takes {name}"):
            nest.place_body(name, position=(1, 0, 0))
    assert np.array_equal(exitance_of(nest), at_rest)
    nest.place_body("stone")  # where it lies
    nest.lights = ["ambient:1"]
    under_sky = exitance_of(nest)
    nest.place_body("jelly", position=(3, 1, 2), rotation=(10, 20, 30))
    assert off(exitance_of(nest), under_sky) < 1e-4
    assert nest.solution.deformed == ""


def test_deformations_and_derivatives_go_over_all(nest):
    nest.set_deformation([{"type": "stretch", "factor": 1.2}])
    assert np.isfinite(exitance_of(nest)).all()
    assert nest.solution.deformed == ""
    nest.set_deformation([])
    nest.solve(**EXACTLY)
    model, level = nest.forward_model(), nest._engine.graph.levels[0]
    gradient = model.vjp(exitance=np.ones_like(model.outgoing.exitance)).sigma_a
    by_body = np.stack([np.bincount(level.tet_bodies, gradient[:, c]) for c in range(3)])
    assert (by_body < 0).all()  # what absorbs more lets less out, wherever it is


def test_shortest_paths_go_through_what_lies_within(nest):
    nest.materials = dict.fromkeys(nest.bodies, JELLY)
    nest.solve(method="shortest-path")
    place = [[-7.5, 0.0, 0.0]]  # mm, away from the sun
    clear = nest._engine.exitance_at(place)
    nest.materials = {"jelly": JELLY, "stone": Material(50.0, 5.0, eta=1.4), "core": JELLY, "pebble": STONE}
    nest.solve(method="shortest-path")
    assert (nest._engine.exitance_at(place) <= clear).all()
    assert nest.solution.index_warning == ""


def test_a_scene_places_the_outermost_alone(files):
    scene = {"body": str(files[0]), "material": "milk", "materials": {"stone": "sigma_s_prime=1,sigma_a=3,eta=1.5"}}
    with Stage(device="cpu") as stage:
        with pytest.raises(InputError, match="stone found, which lies within jelly"):
            stage.show(Scene.from_dict(scene | {"placements": {"stone": {"position": [1, 0, 0]}}}))
        stage.show(Scene.from_dict(scene | {"placements": {"jelly": {"position": [1, 0, 0]}}}))
        assert stage.engine.hosts["core"] == "stone"


def test_a_page_places_the_outermost_alone(files):
    scene = Scene.from_dict({"body": str(files[0]), "material": "milk"})
    shown = ShownScene(scene, ("jelly", "stone", "core", "pebble"), {"stone": "jelly", "core": "stone"})
    shown.set("/placements/jelly/position", [1, 0, 0])
    with pytest.raises(InputError, match='found "core", which moves with stone'):
        shown.set("/placements/core/position", [1, 0, 0])
    with pytest.raises(InputError, match='found "stone", which moves with jelly'):
        shown.set("/placements", {"stone": {"position": [1, 0, 0]}})
    assert list(shown.scene.placements) == ["jelly"]


def test_samples_are_drawn_in_stones_too(nest, short):
    """Stones in clear jelly: by the mean free paths of their own above them too few are, and fluence is 23% off."""
    clear, stone = Material(0.1, 0.002, eta=1.4), Material(2.0, 0.02, eta=1.4)
    nest.materials = dict.fromkeys(nest.bodies, stone) | {"jelly": clear}
    level = nest._engine.graph.levels[0]
    places = level.vertices[np.unique(level.tets[level.tet_bodies != nest.bodies.index("jelly")])]
    few, many = (fluence_of(nest, places, points) for points in ((5_000, 20_000) if short else (10_000, 40_000)))
    assert off(few, many) < 0.08


def fluence_of(engine, places: np.ndarray, points: int) -> np.ndarray:
    engine.solve(sweeps=1, sweep_points=points)
    return engine.fluence_at(places)
