"""Path tracing on the chart: paths that end after some scatterings, frames of few samples, and a machine without it."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest

from baked import write_levels
from quadgraph.base.errors import ToolError
from quadgraph.mesh.surface import Surface
from quadgraph_validation.bodies import scenes
from quadgraph_validation.bodies.media import Medium
from quadgraph_validation.bodies.scenes import PIXELS, StudyScene, View
from quadgraph_validation.chart import chart_measure as measuring
from quadgraph_validation.chart import chart_pictures
from quadgraph_validation.chart.chart_body import ChartBody
from quadgraph_validation.chart.chart_judge import ChartJudge
from quadgraph_validation.chart.chart_method import MethodChain, pde_of
from quadgraph_validation.chart.chart_record import KINDS, kind
from quadgraph_validation.chart.engine_methods import EngineMethod
from quadgraph_validation.chart.traced_method import CUT, TracedMethod, traced_methods
from quadgraph_validation.truth import blocks, half_space_orders, monte_carlo, path_tracing
from quadgraph_validation.truth.fresnel import transmittance_from_outside
from quadgraph_validation.truth.path_tracing import PathEnds
from quadgraph_validation.truth.truth_run import TracedSubject
from shapes import icosphere

ALBEDO, SIDE = 0.9, 30.0  # mm, of a block of as many mean free paths
FRONT = {"A": View(0, 0, 90, ())}


def mitsuba_there():
    pytest.importorskip("mitsuba", reason="Mitsuba is not installed: pip install './python/validation[truth]'")


def dull(position):
    shape = position.shape[:-1]
    return np.full(shape, ALBEDO), np.full(shape, 1 - ALBEDO)


def radiance_of_a_block(eta: float, ends: PathEnds) -> float:
    """Of its middle, seen from before it, in uniform light that comes in with a radiance of 1."""
    scene = StudyScene("block", "", eta, dull, SIDE, None, FRONT)
    corner = np.array([[i >> 2 & 1, i >> 1 & 1, i & 1] for i in range(8)]) - 0.5
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    triangles = np.array([[q[a] for a in half] for q in quads for half in ((0, 1, 2), (0, 2, 3))])
    surface = Surface(SIDE * corner, triangles)
    with path_tracing.tracer(scene, surface, scenes.grid_of(scene, surface), "A", ends, pixels=32) as tracer:
        found = tracer.whole(512, 1) - tracer.reflected(512, 2)
    return float(np.pi * found[12:20, 12:20].mean())


@pytest.mark.parametrize("most", [1, 3, None])
def test_paths_end_after_as_many_scatterings_as_they_may_have(most):
    """By reciprocity what is seen straight from before, in uniform light, is what comes back of light from there."""
    mitsuba_there()
    orders = half_space_orders.by_scatterings(100)[: None if most is None else most + 1]
    expected = orders @ ALBEDO ** np.arange(len(orders))
    found = radiance_of_a_block(1.0, PathEnds(most, roulette=5))
    assert found == pytest.approx(expected, rel=0.06)  # four standard errors; another scattering adds 16% and more


def test_reflections_on_the_inside_take_the_place_of_scatterings():
    mitsuba_there()
    found = radiance_of_a_block(1.4, PathEnds(4))
    walked = [monte_carlo.after_many(Medium(ALBEDO, 1 - ALBEDO), np.inf, 1.4, n, 100_000, seed=1).mean for n in (2, 4)]
    least, most = ((each[0] - each[2]) * float(transmittance_from_outside(1.0, 1.4)) for each in walked)
    print(f"found {found:.4f}, walks of two scatterings at most {least:.4f}, of four {most:.4f}")
    assert least < found < 1.02 * most


@pytest.fixture(scope="module")
def ball(tmp_path_factory) -> Path:
    return write_levels(tmp_path_factory.mktemp("traced") / "ball.qgraph", [icosphere(3, 10.0), icosphere(2, 10.0)])


@pytest.fixture
def body(ball) -> ChartBody:
    scene = scenes.SCENES["sphere"]
    surface = icosphere(3, 10.0)
    original = TracedSubject(scene, Path(), surface, (scenes.grid_of(scene, surface),), "")
    return ChartBody(scene, ball, ball.parent, "cpu", 64, original=original)


def test_frames_follow_the_light_and_pictures_have_the_samples_of_a_frame(body, monkeypatch):
    mitsuba_there()
    asked = []
    whole = path_tracing.Tracer.whole
    monkeypatch.setattr(path_tracing.Tracer, "whole", lambda self, *told: (asked.append(told), whole(self, *told))[1])
    method = TracedMethod(8, CUT)
    method.prepare(body)
    shown = {}
    for step in (9, 0):
        assert method.frame(step)["path tracing"] > 0
        shown[step] = method.picture("A")
    samples, seeds = zip(*asked, strict=True)
    assert samples == (8, 2, 8, 2)  # a picture of twice the edge in pixels
    assert len(set(seeds)) == len(seeds)
    assert shown[0].shape == (PIXELS, PIXELS, 3)
    assert (shown[0][..., 0] == shown[0][..., 2]).all()
    # The light turns away by 45 degrees: what was bright on one side is dark then.
    left, right = (shown[0] - shown[9])[:, : PIXELS // 2].mean(), (shown[0] - shown[9])[:, PIXELS // 2 :].mean()
    assert abs(left - right) > 0.2 * shown[0].mean()


def test_what_path_tracing_says_of_itself():
    assert not list(traced_methods(MethodChain((900,), None)))
    found = list(traced_methods(MethodChain((900,), None, original=True)))
    assert len({method.name for method in found}) == len(found)
    assert {method.most for method in found} == {None, 15}
    assert found[-2].name == "path tracing, 15 scatterings at most · 16 samples a pixel"
    assert found[-1].name == "path tracing · 16 samples a pixel · llvm_ad_rgb"
    for method in found:
        assert pde_of(method.settings) is None
        assert kind({"name": method.name, "settings": method.settings}) in KINDS
    assert [method.moves for method in found] == [*[True, True, False] * 2, False]


@pytest.mark.long
def test_both_variants_trace_the_same_picture(body):
    """By other random numbers: their means differ by noise alone, and a variant that is not there is told."""
    mitsuba_there()
    missing = TracedMethod(4, variant="cuda_no_such")
    with pytest.raises(ToolError, match="variant cuda_no_such"):
        missing.prepare(body)
    shown = []
    for variant in (path_tracing.SCALAR, path_tracing.COMPILED):
        method = TracedMethod(64, variant=variant)
        try:
            method.prepare(body)
        except ToolError as error:
            pytest.skip(str(error))
        assert method.frame(0)["path tracing"] > 0
        shown.append(method.picture("A")[..., 0])
    means = np.array([blocks.means(picture)[blocks.covered(body.coverage("A"))] for picture in shown])
    noise = np.sqrt(((means[0] - means[1]) ** 2).mean()) / means.mean()
    print(f"blocks differ by {noise:.1%}, means by {means[0].mean() / means[1].mean() - 1:+.2%}")
    assert means[0].mean() == pytest.approx(means[1].mean(), rel=4 * noise / np.sqrt(means.shape[1]))
    assert 0 < noise < 0.5


def test_without_mitsuba_the_chart_goes_on_without_it(body, monkeypatch):
    monkeypatch.setitem(sys.modules, "mitsuba", None)
    methods = [TracedMethod(1), EngineMethod(level=1, cycles=1)]
    points = measuring.measure(body, ChartJudge(body, {}, {}), methods, 1, lambda text: None)
    assert "pip install" in points[0].failed
    assert not points[1].failed
    told = measuring.scene_record(body, ChartJudge(body, {}, {}), points)
    assert told["points"][0]["failed"] == points[0].failed


def test_pictures_show_what_the_cut_loses_beside_ours():
    """And ours is no path tracing, however close it comes."""

    def point(method, error):
        return measuring.ChartPoint(method, errors={"pde": None, "transport": {"whole": error}}, pictures={})

    points = [
        point(TracedMethod(16), 0.01),
        point(EngineMethod(level=1), 0.05),
        point(EngineMethod(), 0.04),
        point(TracedMethod(1, CUT), 0.2),
        point(TracedMethod(4, CUT), 0.15),
    ]
    closest = {title: chart_pictures._closest(points, family) for title, family in chart_pictures.SHOWN.items()}
    assert closest == {"published": None, "ours": points[2], "dipole": None, "15 scatterings": points[4]}
