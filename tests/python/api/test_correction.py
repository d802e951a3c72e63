"""The transport correction as callers ask for it: by default, or not, or in motion, and what of it is refused."""

from __future__ import annotations

import json
import os
import signal
import threading
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial import cKDTree

import quadgraph
from baked import write_levels
from quadgraph import cli
from quadgraph.api.deformers import Stretch
from quadgraph.base.errors import InputError
from quadgraph.core import load_core
from quadgraph.mesh.patches import patches_of
from shapes import icosphere

MATERIAL, SUN = "ketchup", "directional:0,0,-1:1"


@pytest.fixture(scope="module")
def ball(tmp_path_factory) -> Path:
    return write_levels(tmp_path_factory.mktemp("ball") / "ball.qgraph", [icosphere(3, 10), icosphere(2, 10)])


@pytest.fixture
def engine(ball):
    with quadgraph.Engine(ball) as made:
        made.material, made.lights = MATERIAL, [SUN]
        yield made


def test_scenes_commands_and_engines_are_corrected_unless_they_say_no(ball, engine, tmp_path):
    asked = {"corrected": [], "plain": ["--no-correction"]}
    fields = {}
    for name, options in asked.items():
        path = tmp_path / f"{name}.npz"
        scene = ["solve", str(ball), "--material", MATERIAL, "--light", SUN, *options, "--field", str(path)]
        assert cli.main([*scene, "--json", str(tmp_path / f"{name}.json")]) == 0
        fields[name] = np.load(path)["exitance"]
        assert bool(json.loads((tmp_path / f"{name}.json").read_text())["correction"]) == (name == "corrected")
    engine.set_light_roughness(None)  # as scenes and commands have it
    assert engine.solve().correction is not None
    assert np.array_equal(engine.surface().exitance, fields["corrected"])
    assert engine.solve(correction=False).correction is None
    assert np.array_equal(engine.surface().exitance, fields["plain"])


def test_the_error_is_the_sum_of_its_parts_and_has_none_of_model_and_light_without_a_correction(engine):
    corrected = engine.solve()
    parts = (corrected.mesh_error, corrected.algebraic, corrected.model_error, corrected.light_error)
    for name in ("whole", "unlit", "dimmest"):
        whole = np.sqrt(sum(getattr(part, name) ** 2 for part in parts))
        assert getattr(corrected.error, name) == pytest.approx(whole, rel=1e-6)
    plain = engine.solve(correction=False)
    assert plain.model_error is None
    assert plain.light_error is None


def test_what_a_sweep_changes_is_told_of_the_third_that_sends_out_least(ball, engine):
    plain = engine.solve(correction=False)
    before = engine.surface()
    change = engine.solve(sweeps=1).correction.sweeps[0].change
    faces = load_core().load(ball).levels[0].faces
    around = np.bincount(faces.ravel(), np.repeat(before.area, 3))

    def at_vertices(exitance: np.ndarray) -> np.ndarray:
        parts = (np.bincount(faces.ravel(), np.repeat(before.area * channel, 3)) for channel in exitance.T)
        return np.stack(list(parts), axis=1) / around[:, None]

    old, new = at_vertices(before.exitance), at_vertices(engine.surface().exitance)
    order = np.argsort(old.sum(axis=1))
    third = order[np.cumsum(around[order]) < around.sum() / 3]
    weight = around[third, None]
    expected = np.sqrt((weight * (new - old)[third] ** 2).sum() / (weight * new[third] ** 2).sum())
    assert change.dimmest == pytest.approx(expected, rel=0.03)
    assert abs(change.dimmest / change.whole - 1) > 0.05  # so it is another number
    assert plain.mesh_error.dimmest > 0


def test_light_from_all_around_enters_by_rays_of_its_own_that_bring_all_of_it(engine):
    engine.lights = ["ambient:1"]
    plain = engine.solve(correction=False)
    corrected = engine.solve()
    # Nothing of a ball hides the sky from it: the rays bring what the faces are lit by.
    assert corrected.energy.entered == pytest.approx(plain.energy.entered, rel=1e-3)
    assert corrected.energy.balance == pytest.approx(np.zeros(3), abs=3e-3)
    moving = engine.solve(motion=True)
    assert moving.energy.entered == pytest.approx(plain.energy.entered, rel=5e-3)


def test_sweeps_without_a_correction_are_refused(engine):
    with pytest.raises(InputError, match="sweeps"):
        engine.solve(correction=False, sweeps=2)


def test_frames_in_motion_stay_beside_what_a_solve_at_rest_finds(engine):
    engine.solve()
    for turn in np.radians(np.arange(1, 21) * 3):
        engine.lights = [f"directional:{np.sin(turn)},0,{-np.cos(turn)}:1"]
        moving = engine.solve(motion=True)
    assert len(moving.correction.sweeps) == 1
    frame = engine.surface()
    engine.solve(sweeps=3)
    rest = engine.surface()
    ends = [np.average(field.exitance, axis=0, weights=field.area) for field in (frame, rest)]
    assert np.allclose(*ends, rtol=0.01)


def test_a_sweep_in_motion_goes_on_from_those_before(engine):
    changes = []
    for turn in np.radians(np.arange(0, 12) * 3):
        engine.lights = [f"directional:{np.sin(turn)},0,{-np.cos(turn)}:1"]
        solution = engine.solve(motion=True)
        changes.append(solution.correction.sweeps[0].change.whole)
    assert changes[0] > 0.08  # all that SP3 is off
    assert max(changes[4:]) < 0.25 * changes[0]  # what one frame changed
    assert solution.error.whole < 0.04


def test_frames_have_as_many_points_as_their_noise_asks_for(engine):
    """Few in a body that rays cross at once; all in one in which light stays and noise with it."""
    points = {}
    for material in (MATERIAL, "wholemilk"):
        engine.material = material
        engine.solve()
        points[material] = []
        for turn in np.radians(np.arange(0, 8) * 3):
            engine.lights = [f"directional:{np.sin(turn)},0,{-np.cos(turn)}:1"]
            points[material].append(engine.solve(motion=True).correction.sweeps[0].points)
    assert points[MATERIAL][0] == points["wholemilk"][0]
    assert max(points[MATERIAL][4:]) < 0.3 * points[MATERIAL][0]
    assert min(points["wholemilk"]) == points["wholemilk"][0]


def test_after_a_change_of_shape_frames_go_on_from_the_solve_at_rest(engine):
    first = engine.solve(sweeps=1).correction.sweeps[0].change.whole
    engine.set_deformation([Stretch(factor=1.1)])
    moving = engine.solve(motion=True)
    engine.solve(sweeps=2)
    after = engine.solve(motion=True)
    assert after.correction.sweeps[0].change.whole < 0.25 * first
    for solution in (moving, after):
        assert solution.error.whole < 0.04


def test_a_coarser_level_that_suffices_is_corrected_and_judged_on_the_finest(tmp_path):
    path = write_levels(tmp_path / "three.qgraph", [icosphere(level, 10) for level in (3, 2, 1)])
    with quadgraph.Engine(path) as engine:  # on which nothing has been solved
        engine.material, engine.lights = MATERIAL, [SUN]
        loose = engine.solve(error=0.6, model="sp3")
        assert loose.finest > 0
        whole = engine.solve(model="sp3").correction.sweeps[0].change
        change = loose.correction.sweeps[0].change
        for part in ("whole", "unlit", "dimmest"):
            assert getattr(change, part) == pytest.approx(getattr(whole, part), rel=0.3)


def test_seeds_differ_by_the_noise_that_is_stated(engine):
    def solved(seed):
        noise = engine.solve(sweeps=1, sweep_seed=seed).correction.sweeps[0].noise.whole
        field = engine.surface()
        patch = patches_of(body)[cKDTree(body.corners.mean(axis=1)).query(field.position)[1]]
        sums = [np.bincount(patch, field.area * channel) for channel in field.exitance.T]
        return noise, np.stack(sums, axis=1), field.exitance

    body = icosphere(3, 10)
    noise, sums, fields = zip(*(solved(seed) for seed in range(6)), strict=True)
    spread = np.sqrt((np.std(sums, axis=0, ddof=1) ** 2).sum() / (np.mean(sums, axis=0) ** 2).sum())
    assert spread == pytest.approx(noise[0], rel=0.4)
    assert np.array_equal(solved(3)[2], fields[3])


@pytest.fixture
def heard():
    """Ctrl-C is heard, also where the tests run in the background, whose processes ignore it."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


@pytest.mark.usefixtures("heard")
def test_a_solve_ends_where_ctrl_c_is_pressed_and_the_next_one_is_whole(engine):
    engine.solve()
    before = engine.surface().exitance
    threading.Timer(0.3, os.kill, (os.getpid(), signal.SIGINT)).start()
    with pytest.raises(KeyboardInterrupt):
        engine.solve(sweeps=100)
    with pytest.raises(InputError):
        engine.surface()
    engine.solve()
    assert np.array_equal(engine.surface().exitance, before)


def test_a_dense_body_is_as_even_as_without_correction_at_rest_and_in_motion(tmp_path):
    """Samples find nothing but noise in elements of 60 mean free paths: none of it may be seen, or grow."""
    path = write_levels(tmp_path / "ball.qgraph", [icosphere(3, 40), icosphere(2, 40)])
    with quadgraph.Engine(path, device="cpu") as engine:
        engine.material, engine.lights = "spectralon", ["ambient:1"]

        def seen(**how: bool) -> tuple[np.ndarray, np.ndarray]:
            engine.solve(**how)
            picture = engine.render(width=40, height=40, samples=4)
            return engine.surface().exitance, picture.scattered.reshape(-1, 3)[picture.alpha.ravel() == 1]

        expected = seen(correction=False)
        found = [seen(), *(seen(motion=True) for _ in range(6))]
    for frame in found:
        for values, even in zip(frame, expected, strict=True):
            assert np.sqrt(((values - even) ** 2).mean()) < 0.05 * even.mean()
