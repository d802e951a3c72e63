"""Several bodies in one file: each has its own material, and they give light to each other."""

from __future__ import annotations

import json
import subprocess

import numpy as np
import pytest

from engine_program import ENGINE
from quadgraph import Engine, Material, Scene, Stage, cli
from quadgraph.baking.bodies import BodyMesh, bake_bodies
from quadgraph.baking.pipeline import BakeOptions, bake
from quadgraph.baking.placing import BodyPlacement
from quadgraph.base.errors import InputError
from shapes import icosphere, write_obj

_core = pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")

WHITE = "sigma_s_prime=2,sigma_a=0.001"
RED = "sigma_s_prime=2,sigma_a=0.002/0.5/0.5"
BLACK = "sigma_s_prime=0.5,sigma_a=5"
EXACTLY = {"correction": False, "tolerance": 1e-5, "model": "sp3"}  # auto goes by the darkest body
AMBIENT = ["ambient:1"]


@pytest.fixture(scope="module")
def mesh(tmp_path_factory):
    return write_obj(icosphere(3, 5.0), tmp_path_factory.mktemp("mesh") / "ball.obj")


@pytest.fixture(scope="module")
def baked(mesh, tmp_path_factory):
    """Two balls whose surfaces are 0.5 mm from each other, in both orders, and one that is alone or far away."""
    folder = tmp_path_factory.mktemp("balls")
    options = BakeOptions(visibility_rays=256)
    near = [BodyMesh("left", mesh, unit="mm"), BodyMesh("right", mesh, BodyPlacement((10.5, 0, 0)), "mm")]
    far = [near[0], BodyMesh("far", mesh, BodyPlacement((2000.0, 0, 0)), "mm")]
    files = {name: folder / f"{name}.qgraph" for name in ("near", "turned", "far", "alone")}
    bake_bodies(near, files["near"], options)
    bake_bodies(near[::-1], files["turned"], options)
    bake_bodies(far, files["far"], options)
    bake(mesh, files["alone"], BakeOptions(unit="mm", visibility_rays=256))
    return files


def exitance(path, materials: dict, material: str | None = None, lights=AMBIENT, **options):
    """Place (n, 3), mm, and exitance (n, 3) of each sample of the surface, by the names of bodies."""
    with Engine(path) as engine:
        if material is not None:
            engine.material = material
        if materials:
            engine.materials = materials
        engine.lights = lights
        engine.solve(**(EXACTLY | options))
        field = engine.surface()
        level = engine._engine.graph.levels[0]
        of = level.tet_bodies[level.face_tets] if engine.bodies else np.zeros(len(level.faces), int)
        names = engine.bodies or ("alone",)
        place = level.nodes[len(level.tets) :]
        found = {}
        for body, name in enumerate(names):
            mine = np.flatnonzero(of == body)
            order = mine[np.lexsort(np.round(place[mine], 3).T)]
            found[name] = place[order], np.asarray(field.exitance)[order]
        return found


def test_a_material_goes_by_its_name_and_not_by_its_place(baked):
    materials = {"right": RED, "left": WHITE}
    one, other = exitance(baked["near"], materials), exitance(baked["turned"], materials)
    for name in materials:
        assert np.allclose(one[name][0], other[name][0], atol=1e-4)
        off = np.linalg.norm(one[name][1] - other[name][1]) / np.linalg.norm(one[name][1])
        assert off < 5e-3  # the 256 rays from a face turn with its number
    assert one["left"][1][:, 1].mean() > 2 * one["right"][1][:, 1].mean()


def test_a_body_that_is_far_from_the_other_is_as_alone(baked):
    alone = exitance(baked["alone"], {}, WHITE)["alone"]
    beside = exitance(baked["far"], {"left": WHITE, "far": BLACK})["left"]
    assert np.allclose(alone[0], beside[0], atol=1e-4)
    off = np.linalg.norm(alone[1] - beside[1]) / np.linalg.norm(alone[1])
    assert off < 1e-3  # both are solved to 1e-5; the other takes 6e-6 of the sky


def test_a_dark_body_darkens_the_white_one_beside_it_and_a_red_one_colours_it(baked):
    def of_left(right: str) -> np.ndarray:
        """Exitance (3,) of the left one where it faces the right one."""
        place, left = exitance(baked["near"], {"left": WHITE, "right": right})["left"]
        return left[place[:, 0] > 4].mean(axis=0)

    white, black, red = of_left(WHITE), of_left(BLACK), of_left(RED)
    assert (black < 0.8 * white).all()
    assert red[0] > 0.97 * white[0]
    assert red[1] < 0.92 * white[1]


def test_equal_materials_are_one_material(baked):
    one = exitance(baked["near"], {}, RED)
    two = exitance(baked["near"], {"left": RED, "right": RED})
    for name in one:
        assert np.linalg.norm(one[name][1] - two[name][1]) < 1e-4 * np.linalg.norm(one[name][1])


def test_edits_go_over_all_bodies_and_patterns_stay_in_theirs(baked):
    layered = f"{WHITE},pattern=layers,second_sigma_s_prime=2,second_sigma_a=1,period=1,sharpness=4"
    with Engine(baked["near"]) as engine:
        engine.materials = {"left": layered, "right": WHITE}
        engine.lights = AMBIENT
        level = engine._engine.graph.levels[0]
        engine.solve(**EXACTLY)
        plain = engine.surface().exitance
        engine.set_edits([{"operation": "multiply", "sigma_a": 30}])
        engine.solve(**EXACTLY)
        edited = engine.surface().exitance
    right = level.tet_bodies[level.face_tets] == 1
    assert plain[~right].mean() < 0.9 * plain[right].mean()
    assert (edited[right].mean(axis=0) < 0.95 * plain[right].mean(axis=0)).all()
    assert (edited[~right].mean(axis=0) < plain[~right].mean(axis=0)).all()


def test_a_volume_lies_about_the_middle_of_its_body(baked, tmp_path):
    cells = np.full((1, 1, 2, 3), 0.001, np.float32)
    cells[:, :, 1] = 2.0  # dark towards +x
    np.savez(tmp_path / "half.npz", sigma_s_prime=cells * 0 + 2, sigma_a=cells, spacing=4.0)
    place, found = exitance(baked["near"], {"left": WHITE, "right": str(tmp_path / "half.npz")})["right"]
    assert found[place[:, 0] > 13].mean() < 0.5 * found[place[:, 0] < 8].mean()


def specular(path, **members) -> np.ndarray:
    """What both surfaces mirror of a sky and a lamp, (64, 96): `left` first."""
    picture = {"width": 96, "height": 64, "ground": False} | members.pop("picture", {})
    lights = ["environment:studio:0:1", "directional:-0.2,-0.3,-1:1"]
    camera = {"azimuth": 0, "elevation": 0}
    with Stage() as stage:
        stage.show(Scene(path, lights=lights, camera=camera, picture=picture, solver={"correction": False}, **members))
        stage.solve()
        return np.asarray(stage.render().specular).sum(axis=2)


def test_each_body_is_as_rough_as_its_material_says(baked):
    smooth, rough = f"{WHITE},roughness=0.05", f"{WHITE},roughness=0.6"
    both = specular(baked["near"], materials={"left": smooth, "right": rough})
    evenly = {name: specular(baked["near"], material=text) for name, text in (("smooth", smooth), ("rough", rough))}
    left, right = np.s_[:, :46], np.s_[:, 50:]
    for side, name, other in ((left, "smooth", "rough"), (right, "rough", "smooth")):
        assert np.abs(both[side] - evenly[name][side]).max() < 1e-3 * evenly[name][side].max()
        assert np.abs(both[side] - evenly[other][side]).max() > 0.1 * evenly[other][side].max()
    said = specular(baked["near"], materials={"left": smooth, "right": rough}, picture={"roughness": 0.6})
    assert np.abs(said - evenly["rough"]).max() < 1e-3 * said.max()
    swapped = specular(baked["turned"], materials={"left": smooth, "right": rough})
    assert np.abs(swapped - both).max() < 0.02 * both.max()


REFUSED = {
    "a name": ({"left": WHITE, "rigth": RED}, "rigth"),
    "a number": ({"left": WHITE, "right": "sigma_s_prime=-1,sigma_a=1"}, "material of 'right': .*sigma_s_prime"),
    "a map": ({"left": WHITE, "right": "a.npz,map=shell"}, "material of 'right': a map found"),
}


@pytest.mark.parametrize(("materials", "message"), REFUSED.values(), ids=REFUSED)
def test_materials_that_cannot_be_are_refused_and_change_nothing(baked, materials, message):
    with Engine(baked["near"]) as engine:
        engine.material = WHITE
        with pytest.raises(InputError, match=message):
            engine.materials = materials
        assert engine.materials == {}
        assert engine.material == WHITE


def test_bodies_without_a_material_and_files_without_bodies_are_named(baked):
    with Engine(baked["near"]) as engine:
        assert engine.bodies == ("left", "right")
        with pytest.raises(InputError, match="none for right"):
            engine.materials = {"left": Material(1.0, 0.1)}
        engine.material = WHITE
        engine.materials = {"left": Material(1.0, 0.1)}
        assert engine.materials == {"left": Material(1.0, 0.1)}
        assert "materials of left" in repr(engine)
        engine.material = RED
        assert engine.materials == {}
    with Engine(baked["alone"]) as engine:
        assert engine.bodies == ()
        with pytest.raises(InputError, match="one body without a name"):
            engine.materials = {"left": WHITE}


def test_shortest_paths_go_through_the_material_of_each_body(baked):
    places = [[-3.0, 0, -4.0], [13.5, 0, -4.0]]  # mm, behind the left ball and the right one, as far from the other

    def shown(engine) -> np.ndarray:
        engine.solve(method="shortest-path")
        return engine._engine.exitance_at(places)

    with Engine(baked["near"], device="cpu") as engine:
        engine.lights = ["directional:0,0,-1:1"]
        engine.material = WHITE
        white = shown(engine)
        engine.materials = {"left": WHITE, "right": WHITE}
        assert shown(engine) == pytest.approx(white, rel=1e-4)
        engine.materials = {"left": WHITE, "right": RED}
        left, right = shown(engine)
        assert left == pytest.approx(white[0], rel=1e-3)
        engine.material = RED
        assert right == pytest.approx(shown(engine)[1], rel=1e-3)
        assert (right[1:] < 0.1 * white[1, 1:]).all()
        engine.materials = {"left": WHITE, "right": RED}
        engine.set_cuts([{"type": "plane", "normal": [0, 0, 1], "offset": 2.0}])
        engine.solve(method="shortest-path")
        assert engine.render("0,20", width=64, height=48).alpha.any()
        engine.materials = {"left": WHITE, "right": Material(1.0, 0.1, eta=1.6)}
        with pytest.raises(InputError, match=r"shortest-path: eta=1.3 found of 'left' and eta=1.6 of 'right'"):
            engine.solve(method="shortest-path")


def test_scenes_name_materials_by_body(baked, tmp_path):
    scene = Scene(baked["near"], material=WHITE, materials={"right": RED}, lights=AMBIENT)
    assert Scene.from_dict(scene.to_dict()).materials == {"right": RED}
    with Stage() as stage:
        stage.show(scene)
        stage.solve()
        assert "left: " in dict(stage.engine._engine.metadata)["material"]
    document = {"body": str(baked["near"]), "materials": {"left": {"name": "marble"}, "right": 7}}
    (tmp_path / "scene.json").write_text(json.dumps(document))
    with pytest.raises(InputError, match=r"scene.json: /materials/right: found 7"):
        _core.SceneFile(tmp_path / "scene.json")


def run(*arguments) -> subprocess.CompletedProcess:
    return subprocess.run([ENGINE, *map(str, arguments)], capture_output=True, text=True, check=False)


def test_the_program_of_the_engine_takes_materials_by_body_and_says_that_it_bakes_nothing(baked, tmp_path):
    picture = tmp_path / "two.png"
    options = ["--headless", "--size", "32x32", "-o", picture, "--no-correction", "--device", "cpu"]
    done = run(baked["near"], "--material-of", f"left={RED}", "--material-of", f"right={WHITE}", *options)
    assert done.returncode == 0, done.stderr
    done = run(baked["near"], "--material-of", "left", *options)
    assert done.returncode != 0
    assert "expected BODY=M" in done.stderr
    (tmp_path / "scene.json").write_text(json.dumps({"bodies": [{"mesh": "ball.obj"}]}))
    done = run(tmp_path / "scene.json", *options)
    assert done.returncode != 0
    assert "quadgraph bake SCENE.json" in done.stderr


def test_a_scene_of_meshes_is_baked_and_rendered(mesh, tmp_path, capsys, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    body = {"mesh": str(mesh), "longest": "10mm"}
    bodies = [body | {"name": "left", "material": RED}, body | {"name": "right", "position": [11, 0, 0]}]
    document = {"bodies": bodies, "material": WHITE, "picture": {"width": 48, "height": 32}}
    document |= {"solver": {"correction": False}}
    scene, picture = tmp_path / "scene.json", tmp_path / "two.png"
    scene.write_text(json.dumps(document))
    assert cli.main(["render", str(scene), "-o", str(picture)]) == 0
    first = picture.read_bytes()
    assert "baked scene.json" in capsys.readouterr().err
    assert cli.main(["render", str(scene), "-o", str(picture), "--material-of", f"left={WHITE}"]) == 0
    assert picture.read_bytes() != first
    assert "baked" not in capsys.readouterr().err
    assert cli.main(["bake", str(scene), "-o", str(tmp_path / "two.qgraph")]) == 0
    capsys.readouterr()
    assert cli.main(["info", str(tmp_path / "two.qgraph")]) == 0
    printed = capsys.readouterr().out
    assert "left" in printed
    assert "right" in printed
    assert cli.main(["render", str(tmp_path / "two.qgraph"), "--material", WHITE, "--material-of", f"left={RED}",
                     "--size", "48x32", "--no-correction", "-o", str(picture)]) == 0  # fmt: skip
    document["bodies"][1]["position"] = [1, 0, 0]
    scene.write_text(json.dumps(document))
    assert cli.main(["render", str(scene), "-o", str(picture)]) != 0
    assert f"{scene}: bodies: left and right cut or touch" in capsys.readouterr().err
