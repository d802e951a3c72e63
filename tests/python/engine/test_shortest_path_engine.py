"""The shortest-path method in the engine: closed forms, symmetry, materials that move, meshes without a bake."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
import trimesh

from baked import write_levels
from quadgraph.baking import bare
from quadgraph.base.errors import FormatError, InputError
from quadgraph.cli import main
from quadgraph.file import qgraph_file
from quadgraph.mesh.surface import Surface
from shapes import cube, icosphere, write_obj

_core = pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")

SIGMA_A, SIGMA_S = 0.02, 1.5
MATERIAL = f"sigma_s_prime={SIGMA_S},sigma_a={SIGMA_A},eta=1"
COSTS = {"transport": np.sqrt(3 * SIGMA_A * (SIGMA_A + SIGMA_S)), "extinction": SIGMA_A + SIGMA_S}


@pytest.fixture
def bare_engine(tmp_path_factory):
    """Makes engines of surfaces without levels, and looks at what the validation layer said of each at the end."""
    engines = []

    def make(surface, material: str = MATERIAL, lights: tuple[str, ...] = ("directional:0,0,1:1",)):
        folder = tmp_path_factory.mktemp("bare")
        bare.write(write_obj(surface, folder / "mesh.obj"), folder / "mesh.qgraph", unit="mm")
        engine = _core.Engine(folder / "mesh.qgraph", validation=True)
        engine.set_material(material)
        engine.set_lights(list(lights))
        engines.append(engine)
        return engine

    yield make
    assert [message for engine in engines for message in engine.validation_messages] == []


def solve(engine, **options) -> dict:
    """The report of the method with cells enough for these bodies."""
    return engine.solve(method="shortest-path", **({"path_cells": 32} | options))


@pytest.mark.parametrize("solver", ["eikonal", "lattice"])
@pytest.mark.parametrize("cost", ["transport", "extinction"])
def test_light_through_a_plate_falls_as_the_cost_says(bare_engine, cost: str, solver: str):
    edge = 8.0
    engine = bare_engine(cube(edge))
    report = solve(engine, path_cost=cost, path_solver=solver)
    lit, far = engine.exitance_at([[0.3, -0.2, -edge / 2], [0.3, -0.2, edge / 2]]).astype(np.float64)[:, 0]
    assert lit == pytest.approx(1, rel=1e-5)  # all that arrives, as nothing is reflected at eta 1
    # Middles of the outermost cells, of which there is one more than fit into the body.
    assert -np.log(far) / COSTS[cost] == pytest.approx(edge, abs=report["path"]["cell"] * 1.01)
    assert report["path"]["size"] == (40, 40, 40)
    assert report["levels"] == []
    assert report["error"] is None


def test_finer_cells_come_closer(bare_engine):
    engine = bare_engine(cube(8.0))
    errors = []
    for cells in (10, 20, 40, 80):
        solve(engine, path_cells=cells)
        far = float(engine.exitance_at([[0.1, 0.2, 4.0]])[0, 0])
        errors.append(abs(-np.log(far) / COSTS["transport"] - 8.0))
    print(errors)
    assert max(errors[2:]) < 0.5 * max(errors[:2])


def test_symmetric_light_gives_a_symmetric_field(bare_engine):
    sphere = icosphere(4, 5.0)
    engine = bare_engine(sphere, lights=("directional:0,0,1:1", "directional:0,0,-1:1"))
    report = solve(engine)
    there = np.log(engine.exitance_at(sphere.vertices))
    for signs in ([1, 1, -1], [-1, -1, 1], [1, -1, 1]):
        difference = np.abs(np.log(engine.exitance_at(sphere.vertices * signs)) - there)
        # A line of cells that meets an edge of the mesh is in the triangle on one side of it: that is half a cell.
        assert np.median(difference) < 1e-5
        assert difference.max() < COSTS["transport"] * report["path"]["cell"]


def test_shadow_and_colour(bare_engine):
    engine = bare_engine(icosphere(4, 5.0), lights=("directional:0,0,1:1/0.5/0",))
    solve(engine)
    lit, far = engine.exitance_at([[0, 0, -5], [0, 0, 5]])
    assert lit[0] == pytest.approx(2 * lit[1], rel=1e-5)
    assert lit[2] == far[2] == 0
    # Straight through, but for the cells at both ends.
    straight = np.exp(-10 * COSTS["transport"])
    assert far[0] == pytest.approx(straight * lit[0], rel=0.2)


def test_ripples_let_no_light_in_behind(bare_engine):
    """A plate with ripples behind, in which a plane of middles of cells lies: what is lit there is lit from before."""
    flat = trimesh.creation.box((8, 8, 3.81))
    for _ in range(5):
        flat = flat.subdivide()
    points = np.array(flat.vertices)
    behind = points[:, 2] > 1.9
    points[behind, 2] += 0.06 * np.sin(5 * points[behind, 0]) * np.sin(4 * points[behind, 1])
    engine = bare_engine(Surface(points, np.array(flat.faces)))
    cell = solve(engine, path_cells=32)["path"]["cell"]
    inner = behind & (np.abs(points[:, :2]).max(axis=1) < 3)
    most = float(engine.exitance_at(points[inner])[:, 0].max())
    assert most < np.exp(-COSTS["transport"] * (3.75 - 1.5 * cell))


def test_material_moves_with_the_body(bare_engine):
    pattern = "sigma_s_prime=1,sigma_a=.01,eta=1,pattern=checker,period=2,second_sigma_s_prime=1,second_sigma_a=.5"
    body = cube(8.0)
    engine = bare_engine(body, pattern)
    solve(engine)
    points = np.random.default_rng(0).uniform(-3.5, 3.5, (200, 3))
    points[:, 2] = 4.0
    still = engine.exitance_at(points)
    engine.set_deformation([{"type": "transform", "axis": [0, 1, 0], "degrees": 90, "translate": [30, 0, 5]}])
    engine.set_lights(["directional:1,0,0:1"])  # z turns into x
    solve(engine)
    moved = engine.exitance_at(np.column_stack([points[:, 2], points[:, 1], -points[:, 0]]) + np.array([30, 0, 5]))
    assert np.sqrt(((moved - still) ** 2).mean()) < 0.02 * np.sqrt((still**2).mean())
    engine.set_deformation([])
    engine.set_lights(["directional:0,0,1:1"])
    solve(engine)
    assert np.array_equal(engine.exitance_at(points), still)


def test_what_is_kept_from_frame_to_frame_changes_nothing(bare_engine):
    """After any change the frame is what it is with all made anew, as after a change of the voxels' size."""
    spots = "sigma_s_prime=1,sigma_a=.01,eta=1,pattern=checker,period=3,second_sigma_s_prime=1,second_sigma_a=.5"
    slab = json.dumps([{"type": "slab", "normal": [0, 0, 1], "offset": 1, "thickness": 1}])
    turn = [{"type": "transform", "axis": [0, 1, 0], "degrees": 40, "scale": [1, 0.8, 1]}]
    changes = (
        lambda engine: engine.set_lights(["directional:1,1,0:2/1/1"]),
        lambda engine: engine.set_material(spots),
        lambda engine: engine.set_deformation(turn),
        lambda engine: engine.set_cuts(slab),
        lambda engine: engine.set_grid(*np.full((2, 2, 2, 2, 3), 0.4), (9, 9, 9), (-5, -5, -5), 1.0),
    )
    engine, points = bare_engine(icosphere(3, 5.0)), icosphere(2, 5.0).vertices
    solve(engine)
    for change in changes:
        before = engine.exitance_at(points)
        change(engine)
        solve(engine)
        after = engine.exitance_at(points)
        assert not np.array_equal(after, before)
        solve(engine, path_cells=24)
        solve(engine)
        assert np.array_equal(engine.exitance_at(points), after)


def test_layers_are_as_deep_as_they_say(bare_engine):
    # The first and the last 2 mm of the way through the plate cost something, those between nothing.
    layers = "sigma_s_prime=1,sigma_a=.3,eta=1,pattern=layers,period=2,sharpness=100,second_sigma_s_prime=1"
    engine = bare_engine(cube(8.0), f"{layers},second_sigma_a=0")
    solve(engine, path_cells=64)
    far = float(engine.exitance_at([[0, 0, 4.0]])[0, 0])
    assert -np.log(far) / np.sqrt(3 * 0.3 * 1.3) == pytest.approx(4.0, abs=0.3)


def test_grid_is_the_material_that_it_samples(bare_engine):
    engine = bare_engine(icosphere(3, 5.0))
    solve(engine)
    points = icosphere(2, 5.0).vertices
    by_material = engine.exitance_at(points)
    ones = np.ones((2, 3, 4, 3))
    engine.set_grid(SIGMA_S * ones, SIGMA_A * ones, (4, 4, 4), (-6, -4, -2), 1.0)
    solve(engine)
    assert np.allclose(engine.exitance_at(points), by_material, rtol=1e-5)
    engine.set_grid(SIGMA_S * ones, 4 * SIGMA_A * ones, (4, 4, 4), (-6, -4, -2), 1.0)
    solve(engine)
    assert engine.exitance_at([[0, 0, 5]])[0, 0] < 0.1 * by_material.max()


def test_an_open_surface_is_seen(bare_engine):
    sphere = icosphere(4, 5.0)
    kept = sphere.vertices[sphere.triangles].mean(axis=1)[:, 2] < 3
    bowl = type(sphere)(sphere.vertices, sphere.triangles[kept]).compacted()
    engine = bare_engine(bowl, lights=("directional:1,0,0:1",))
    solve(engine)
    picture = engine.render(view="-60,25", width=64, height=64)
    shown = np.asarray(picture.scattered)[..., 0][np.asarray(picture.alpha) > 0.99]
    assert len(shown) > 500
    assert (shown > 0).all()
    assert np.asarray(picture.unscattered).max() == 0
    assert ("method", "shortest-path") in engine.metadata


def test_methods_change_on_one_engine(tmp_path: Path):
    path = write_levels(tmp_path / "sphere.qgraph", [icosphere(3, 5.0)])
    engine = _core.Engine(path, validation=True)
    engine.set_material("sigma_s_prime=2,sigma_a=.05,eta=1.3")
    engine.set_lights(["directional:0,0,1:1"])
    engine.solve()
    before = engine.surface_field()["exitance"]
    report = solve(engine)
    by_path = engine.render(view="180,0", width=48, height=48).scattered
    with pytest.raises(InputError, match="exitance_at"):
        engine.surface_field()
    with pytest.raises(InputError, match="with shortest-path only 'picture'"):
        engine.render(show="phi", width=48, height=48)
    with pytest.raises(InputError, match="nothing is gathered"):
        engine.render(radiance="gathered", width=48, height=48)
    assert report["method"] == "shortest-path"
    engine.solve()
    assert np.array_equal(engine.surface_field()["exitance"], before)
    by_elements = engine.render(view="180,0", width=48, height=48).scattered
    assert 0.3 < by_path.sum() / by_elements.sum() < 3
    assert engine.validation_messages == []


def test_other_methods_say_why_they_cannot(bare_engine):
    engine = bare_engine(cube(4.0))
    for call in (engine.solve, engine.update_irradiance, lambda: engine.solve(method="quadgraph-fv")):
        with pytest.raises(InputError, match="a surface without levels, which only the method shortest-path can show"):
            call()
    with pytest.raises(InputError, match="path cells: found 7, allowed are 8 to 150"):
        solve(engine, path_cells=7)
    with pytest.raises(InputError, match="path cost 'x': allowed are transport, extinction"):
        solve(engine, path_cost="x")


def test_files_without_levels_are_checked(tmp_path: Path):
    path = tmp_path / "mesh.qgraph"
    bare.write(write_obj(cube(4.0), tmp_path / "mesh.obj"), path, unit="mm")
    file = qgraph_file.read(path)
    assert file.level_count == 0
    assert len(_core.load(path).levels) == 0
    tied = file.sections | {"display/face": np.zeros(len(file.sections["display/vertices"]), np.uint32)}
    del tied["metadata"]
    with pytest.raises(FormatError, match="display/face"):
        qgraph_file.write(path, file.metadata, tied)


def test_meshes_are_rendered_at_once(tmp_path: Path, capsys):
    mesh = write_obj(icosphere(3, 5.0), tmp_path / "mesh.obj")
    picture, report = tmp_path / "out.png", tmp_path / "out.json"
    arguments = ["render", str(mesh), "--method", "shortest-path", "--size", "64x64", "--path-cells", "24"]
    assert main([*arguments, "--json", str(report), "-o", str(picture)]) == 0
    assert picture.stat().st_size > 1000
    told = json.loads(report.read_text())
    assert told["path"]["cell"] == pytest.approx(100 / 24)  # 100 mm long where nobody says
    assert "paths: eikonal, cost transport" in capsys.readouterr().out
    baked = tmp_path / "mesh.qgraph"
    assert main(["bake", str(mesh), "--surface-only", "--height", "20mm", "-o", str(baked)]) == 0
    assert main(["render", str(baked), "-o", str(picture)]) == 1
    assert "a surface without levels" in capsys.readouterr().err
    assert main(["info", str(baked)]) == 0
    assert "levels: none" in capsys.readouterr().out
    assert main(["bake", str(mesh), "--surface-only", "--levels", "2", "--unit", "mm", "-o", str(baked)]) == 1
    assert "--levels: found with --surface-only" in capsys.readouterr().err
    scene = tmp_path / "scene.json"
    solver = {"method": "shortest-path", "path": {"cost": "extinction", "solver": "lattice", "cells": 16}}
    scene.write_text(json.dumps({"body": "mesh.qgraph", "solver": solver, "picture": {"width": 32, "height": 32}}))
    assert main(["render", str(scene), "-o", str(picture)]) == 0
    assert "paths: lattice, cost extinction" in capsys.readouterr().out
