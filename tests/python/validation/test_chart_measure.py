"""What the chart measures: the light's way, the chain's levels, frames, judging, and methods that plug in."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from baked import write_levels
from quadgraph.base.errors import InputError, SolverError, ToolError
from quadgraph.base.relative_error import relative_rms
from quadgraph_validation.bodies.media import Medium
from quadgraph_validation.bodies.scene_bakes import Choice
from quadgraph_validation.bodies.scenes import PIXELS, SCENES, StudyScene, View, of_medium, pale
from quadgraph_validation.chart import chart_measure as measuring
from quadgraph_validation.chart import chart_method as registry
from quadgraph_validation.chart import chart_record as records
from quadgraph_validation.chart.chart_body import STEP_DEGREES, ChartBody, light_at
from quadgraph_validation.chart.chart_judge import ChartJudge
from quadgraph_validation.chart.chart_method import SETTLED, SWING, MethodChain
from quadgraph_validation.chart.engine_methods import EngineMethod, engine_methods
from quadgraph_validation.chart.path_method import PathMethod, path_methods
from quadgraph_validation.truth import monte_carlo
from quadgraph_validation.truth.stored_truth import StoredTruth
from shapes import icosphere

pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")

RADIUS = 10.0  # mm
BALL = StudyScene("ball", "", 1.0, pale, 4.0, (0.0, 0.0, -1.0), {"A": View(70, 15, 46, ())}, height=2 * RADIUS)


@pytest.fixture(scope="module")
def ball(tmp_path_factory) -> Path:
    return write_levels(tmp_path_factory.mktemp("chart") / "ball.qgraph", [icosphere(3, RADIUS), icosphere(2, RADIUS)])


@pytest.fixture
def body(ball) -> ChartBody:
    return ChartBody(BALL, ball, ball.parent, "", 32)


class SomeTruth:
    """A PDE truth that equals a level's exitance, whatever it is asked."""

    def __init__(self):
        self.noise = {"whole": 0.001}

    def error(self, level, exitance):
        return {"whole": float(exitance.mean()) + level}


class Told:
    """A method that writes down what it is asked, of given times a frame."""

    family = "told"

    def __init__(self, name, log, fails=False):
        self.name, self._log, self._fails = name, log, fails
        self.settings = {
            "model": "sp3",
            "source": "buried",
            "level": 1,
            "inter_reflection": False,
            "bake": "chain",
            "radiance": "told",
            "runs_on": "paper",
        }

    def prepare(self, body):
        self._log.append((self.name, "prepare"))
        if self._fails:
            raise SolverError("it does not converge")

    def frame(self, step):
        self._log.append((self.name, step))
        return {"irradiance": 1.0 + step, "own pass": 10.0}

    def exitance(self):
        return np.full((2, 3), 0.5)

    def picture(self, view):
        return np.ones((PIXELS, PIXELS, 3))


def test_the_light_arrives_in_even_steps():
    for scene in SCENES.values():
        if scene.direction is None:
            assert light_at(scene, 0) == scene.light
            continue
        ways = [np.array(light_at(scene, k).split(":")[1].split(","), float) for k in (0, 1, 2)]
        assert np.allclose(ways[0], scene.direction, rtol=1e-7)
        cosines = [a @ b / np.linalg.norm(a) / np.linalg.norm(b) for a, b in (ways[:2], ways[1:])]
        assert np.degrees(np.arccos(cosines)) == pytest.approx([STEP_DEGREES] * 2, rel=1e-6)


def test_a_coarser_level_is_shown_on_the_same_mesh(body):
    fine, coarse = (EngineMethod(level=level, radiance="lambertian") for level in (0, 1))
    for method in (fine, coarse):
        method.prepare(body)
        method.frame(0)
    assert len(fine.exitance()) == 4 * len(coarse.exitance()) == 1280
    covered = [method.picture("A")[..., 0] > 0 for method in (fine, coarse)]
    assert (covered[0] == covered[1]).all()
    assert not np.array_equal(fine.picture("A"), coarse.picture("A"))


def test_frames_follow_the_light_to_the_answer_that_a_cold_solve_finds(body):
    cold = EngineMethod(model="diffusion")
    cold.prepare(body)
    before = cold.exitance()
    engine = body.engine(0, ("fem", "diffusion", "buried"))
    engine.set_lights([BALL.light])
    engine.solve(model="diffusion", inter_reflection=False, tolerance=1e-5)
    answer = cold.exitance()

    def distance(exitance):
        return np.sqrt(((exitance - answer) ** 2).sum() / (answer**2).sum())

    assert distance(before) > 0.05
    for method, bound in ((cold, 2e-3), (EngineMethod(model="diffusion", cycles=1), 0.02)):
        method.prepare(body)
        passes = [method.frame(step) for step in SWING[1:]]
        assert distance(method.exitance()) < bound
        assert min(measuring.stages(passes[-1]).values()) > 0
        assert measuring.stages(passes[-1])["solve"] == pytest.approx(
            sum(passes[-1].values()) - sum(ms for s, ms in measuring.stages(passes[-1]).items() if s != "solve")
        )


KETCHUP = Medium(0.18, 0.061)  # in red: a body of four mean free paths, which SP3's boundary condition gets wrong
KETCHUP_BALL = replace(BALL, name="ketchup", eta=1.3, coefficients=of_medium([0.18] * 3, [0.061] * 3), coloured=True)
ZONES = 10


def zone_means(body: ChartBody, exitance: np.ndarray) -> np.ndarray:
    """(ZONES,) of one channel over zones of equal height, from the far side of the light."""
    corners = body.file.sections["level0/vertices"][body.file.sections["level0/faces"]].astype(float)
    area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    middle = corners.mean(axis=1)
    zone = ((middle[:, 2] / np.linalg.norm(middle, axis=1) + 1) / 2 * ZONES).astype(int)
    return np.bincount(zone, area * exitance[:, 0]) / np.bincount(zone, area)


@pytest.mark.long
def test_corrections_come_close_to_random_walks_where_the_model_does_not(ball):
    body = ChartBody(KETCHUP_BALL, ball, ball.parent, "", 32)
    known = {method.name: method for method in engine_methods(body.chain)}
    truth = monte_carlo.sphere(KETCHUP, RADIUS, KETCHUP_BALL.eta, ZONES, 400_000, seed=3).mean
    names = {"SP3": "fem, SP₃ · level 0 · fmg-pcg"}
    names |= {how: f"fem, SP₃, corrected · level 0 · fmg-pcg · {how}" for how in ("1 sweep", "2 sweeps", "in motion")}
    errors, swept = {}, {}
    for how, name in names.items():
        method = known[name]
        method.prepare(body)
        passes = [method.frame(step) for step in SWING[1:]][-1]
        off = (zone_means(body, method.exitance()) - truth).reshape(2, -1)  # the dark half, and the lit one
        errors[how] = max(np.linalg.norm(off, axis=1) / np.linalg.norm(truth.reshape(2, -1), axis=1))
        swept[how] = passes.get("transport sweep", 0.0)
        assert measuring.stages(passes)["solve"] > swept[how]
    print("off the walks:", {how: f"{error:.2%}" for how, error in errors.items()})
    assert max(errors["1 sweep"], errors["2 sweeps"]) < 0.3 * errors["SP3"]
    assert errors["in motion"] < 0.5 * errors["SP3"]
    assert swept.pop("SP3") == 0 < min(swept.values())


def test_methods_are_corrected_where_their_names_say_so_alone(body):
    """Those too that come after corrected ones, on the engine of these."""
    plain = EngineMethod()
    plain.prepare(body)
    plain.frame(0)
    before = plain.exitance()
    others = [EngineMethod(cycles=1), EngineMethod(method="quadgraph-fv", solver="dpcg")]
    for method in (EngineMethod(sweeps=1), plain, *others):
        method.prepare(body)
        corrected = "transport sweep" in method.frame(0)
        assert corrected == ("corrected" in method.name) == (method.settings["sweeps"] > 0)
        if method is plain:
            everywhere = np.ones(len(before))
            assert relative_rms(everywhere, plain.exitance() - before, before) < 2 * SETTLED


def test_what_is_corrected_answers_no_pde(body):
    judge = ChartJudge(body, {("sp3", "buried"): SomeTruth()}, {})
    for sweeps in (0, 1):
        method = EngineMethod(sweeps=sweeps)
        method.prepare(body)
        assert (judge.errors(method, {})["pde"] is None) == (sweeps > 0)


class ToldEngine:
    """Keeps what it is told."""

    def __init__(self):
        self.lights, self.solves, self.passes = [], [], []

    def set_lights(self, lights):
        self.lights += lights

    def solve(self, **options):
        self.solves.append(options)

    def render(self, **options):
        pass


@pytest.mark.parametrize("motion", [False, True])
def test_frames_in_motion_follow_others_by_three_degrees_each(motion, monkeypatch):
    engine = ToldEngine()
    body = ChartBody(BALL, Path(), Path(), "", 32)
    monkeypatch.setattr(body, "engine", lambda *_: engine)
    method = EngineMethod(sweeps=1, motion=motion)
    for _ in range(2):
        engine.lights.clear()
        engine.solves.clear()
        method.prepare(body)
        for step in SWING[1:]:
            method.frame(step)
    ways = np.array([text.split(":")[1].split(",") for text in engine.lights], float)
    turns = np.degrees(np.arccos((ways[1:] * ways[:-1]).sum(axis=1)))
    assert ways[-1] == pytest.approx(BALL.direction)
    assert [options["motion"] for options in engine.solves] == [False, *[motion] * (len(ways) - 1)]
    if motion:
        assert len(ways) > 12
        assert turns[turns > 0.1] == pytest.approx(3, rel=1e-6)
    else:
        assert turns == pytest.approx(STEP_DEGREES, rel=1e-6)


class Baked:
    """A bake that is there, or fails."""

    def __init__(self, path):
        self.path = path

    def made(self):
        if self.path is None:
            raise ToolError("quadgraph-cgal-mesh: not found")
        return self.path


def test_the_body_baked_in_another_way_is_judged_by_path_tracing_alone(body, tmp_path):
    fine, coarse = Choice(), Choice(7000, grading=3.0)
    path = write_levels(tmp_path / "fine.qgraph", [icosphere(4, RADIUS), icosphere(3, RADIUS)])
    both = ChartBody(BALL, body.path, tmp_path, "", 32, {fine: Baked(path), coarse: Baked(None)})
    methods = [EngineMethod(radiance="lambertian", choice=choice) for choice in (fine, coarse)]
    assert [(method.settings["bake"], method.settings["K"]) for method in methods] == [("default", None), ("K", 3.0)]
    judge = ChartJudge(both, {("sp3", "buried"): SomeTruth()}, {})
    points = measuring.measure(both, judge, methods, 1, lambda text: None)
    told = measuring.scene_record(both, judge, points)
    assert points[0].errors["pde"] is None
    assert len(methods[0].exitance()) == 5120
    assert told["points"][1]["failed"] == "quadgraph-cgal-mesh: not found"
    (bake,) = told["bakes"]
    assert [level["faces"] for level in bake["levels"]] == [5120, 1280]
    assert len(body.chain.faces) == 2
    frames = [method for method in engine_methods(both.chain) if method.choice == fine]
    assert {method.method for method in frames} == {"fem", "quadgraph-fdm"}


def test_methods_take_turns_and_one_that_fails_is_told_and_left_out(body):
    log = []
    methods = [Told("a", log), Told("bad", log, fails=True), Told("b", log)]
    judge = ChartJudge(body, {("sp3", "buried"): SomeTruth()}, {})
    points = measuring.measure(body, judge, methods, 2, lambda text: None)
    turn = [("a", "prepare"), ("a", 1), ("a", 0), ("bad", "prepare"), ("b", "prepare"), ("b", 1), ("b", 0)]
    assert log == turn + [entry for entry in turn if entry[0] != "bad"]
    told = measuring.scene_record(body, judge, points)
    assert told["points"][1]["failed"] == "it does not converge"
    assert told["points"][0]["ms"] == 11.5
    assert told["points"][0]["stages"]["solve"] == 10
    assert told["points"][0]["errors"] == {"pde": {"whole": 1.5}, "transport": None, "walks": None}
    assert [panel.errors for panel in records.panels(told)] == [[1.5, 1.5]]


def test_a_picture_that_is_the_truth_has_no_error_and_another_has_its_own(body):
    method = EngineMethod(model="diffusion", radiance="lambertian")
    method.prepare(body)
    method.frame(0)
    shown = method.picture("A")
    image = StoredTruth.empty({}, PIXELS, PIXELS)
    for _ in range(2):
        image.add(shown[..., 0])
    judge = ChartJudge(body, {("diffusion", "buried"): SomeTruth()}, {"A": image})
    found = judge.errors(method, {"A": shown})
    assert found["transport"] == pytest.approx({"whole": 0, "unlit": 0}, abs=1e-6)
    assert judge.errors(method, {"A": 1.1 * shown})["transport"] == pytest.approx({"whole": 0.1, "unlit": 0.1})
    # A ball seen from 70 degrees beside the light has (1 - cos 70 degrees) / 2 of its disc in the dark.
    blocks = judge.noise()["blocks"]
    assert 0.6 * 0.33 < blocks["unlit"] / blocks["whole"] < 0.33
    bounced = EngineMethod(model="diffusion", inter_reflection=True)
    assert judge.errors(bounced, {"A": shown})["pde"] is None


def test_half_of_a_ball_in_parallel_light_is_unlit(body):
    light = body.lit()
    z = body.display.vertices[:, 2]
    assert light[z > 0.2 * RADIUS].all()
    assert not light[z < -0.2 * RADIUS].any()


def test_a_registered_method_is_in_every_chart_and_found_by_its_name(monkeypatch):
    monkeypatch.setattr(registry, "_PROVIDERS", [engine_methods])
    chain = MethodChain((14000, 3500, 900), 1)
    before = registry.methods(chain)
    registry.register(lambda chain: [Told(f"told, {len(chain.faces)} levels", [])])
    assert len(registry.methods(chain)) == len(before) + 1
    assert [method.name for method in registry.methods(chain, ["told"])] == ["told, 3 levels"]
    with pytest.raises(InputError, match="method 'teapot': in no name"):
        registry.methods(chain, ["teapot"])


@pytest.mark.parametrize("chain", [MethodChain((14000, 3500, 900, 200), 1), MethodChain((900,), None)])
def test_default_methods_have_names_of_their_own_and_stay_on_the_chain(chain):
    found = list(engine_methods(chain))
    assert len({method.name for method in found}) == len(found) <= 40
    assert {method.level for method in found} == set(range(len(chain.faces)))
    assert all(method.level <= (chain.seen or 0) for method in found if method.inter_reflection)
    assert any(method.inter_reflection for method in found) == (chain.seen is not None)
    assert {method.method for method in found} == {"fem", "quadgraph-fv", "quadgraph-fdm"}
    assert {method.solver for method in found} == {"fmg-pcg", "vcycle", "dpcg", "cascade", "jacobi"}


def test_shortest_paths_are_on_the_chart(body):
    methods = list(path_methods(body.chain))
    assert [(m.cost, m.paths, m.cells) for m in methods[:4]] == [
        ("transport", "eikonal", 64),
        ("transport", "lattice", 64),
        ("extinction", "eikonal", 64),
        ("extinction", "lattice", 64),
    ]
    coarse, fine = (PathMethod(cells=cells) for cells in (16, 24))
    for method in (coarse, fine):
        method.prepare(body)
        passes = method.frame(SWING[-1])
        assert {"path light", "shortest paths", "surface"} <= set(passes)
        assert not {"voxels", "path cost"} & set(passes)  # kept while only the light turns
        assert method.exitance().shape == (1280, 3)
    shown = fine.picture("A")
    assert shown.shape == (PIXELS, PIXELS, 3)
    assert (shown[body.coverage("A") > 0.999] > 0).mean() > 0.99
    # The ball's coefficients: straight through it costs what they say.
    along = body.engine(0, ("shortest-path",)).exitance_at([[0, 0, RADIUS], [0, 0, -RADIUS]])[:, 0]
    sigma_s, sigma_a = (float(value[0, 0]) for value in BALL.in_channels(np.zeros((1, 3))))
    sigma_tr = np.sqrt(3 * sigma_a * (sigma_a + sigma_s))
    assert np.log(along[0] / along[1]) == pytest.approx(2 * RADIUS * sigma_tr, rel=0.15)
