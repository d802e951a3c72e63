"""Answers that are no numbers, dark although lights are on, or out of balance: none counts as converged."""

from __future__ import annotations

import numpy as np
import pytest

from baked import write_levels
from shapes import torus

core = pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")

IN_THE_BODY = "point:10,0,0:5"
INTO_THE_HOLE = "spot:0,0,0:0,0,1:5:1"


@pytest.fixture(scope="module")
def ring(tmp_path_factory):
    surfaces = [torus(10, 4, 24, 12), torus(10, 4, 12, 8)]
    return write_levels(tmp_path_factory.mktemp("verdict") / "ring.qgraph", surfaces)


def solved(path, lights: list[str], **options) -> dict:
    engine = core.Engine(path, device="cpu")
    engine.set_material("marble")
    engine.set_lights(lights)
    return engine.solve(**options)


@pytest.mark.parametrize("method", ["fem", "quadgraph-fv", "shortest-path"])
def test_light_that_does_not_arrive_is_said(ring, method):
    report = solved(ring, [IN_THE_BODY, INTO_THE_HOLE], method=method)
    assert "not lit" in report["stopped"]
    assert "light 1 (point) is in the body" in report["stopped"]
    assert "light 2 (spot) is aimed past it" in report["stopped"]
    assert not any(level["converged"] for level in report["levels"][-1:])


def test_a_light_in_the_body_is_said_where_others_shine(ring):
    report = solved(ring, [IN_THE_BODY, "ambient:1"])
    assert report["stopped"] == ""
    assert report["light_warning"].startswith("light 1 (point) is in the body")
    assert solved(ring, ["point:0,0,0:5"])["light_warning"] == ""  # in the hole


def test_lights_that_are_off_leave_a_body_dark(ring):
    assert solved(ring, ["ambient:0"])["stopped"] == ""


def test_a_method_that_does_not_conserve_says_so_where_its_error_is_not_known(tmp_path):
    alone = write_levels(tmp_path / "one.qgraph", [torus(10, 4, 24, 12)])
    report = solved(alone, ["ambient:1"], method="quadgraph-fdm")
    assert max(map(abs, report["energy"]["balance"])) > 0.01
    assert "quadgraph-fdm does not conserve energy" in report["stopped"]
    assert not report["levels"][-1]["converged"]
    assert solved(alone, ["ambient:1"], method="fem")["stopped"] == ""


def test_irradiance_beyond_single_precision_is_refused(ring):
    engine = core.Engine(ring, device="cpu")
    q = np.full((len(engine.graph.levels[0].faces), 3), 3e38, np.float32)
    with pytest.raises(Exception, match=r"irradiance of level 0, surface node 0.*allowed is 0 to 1e\+30"):
        engine.set_irradiance(0, q)


def test_a_light_that_moves_in_and_out_is_said_as_it_stands(ring):
    engine = core.Engine(ring, device="cpu")
    engine.set_material("marble")
    for place, inside in (("10,0,0", True), ("0,0,0", False), ("0,10,0", True)):
        engine.set_lights([f"point:{place}:5", "ambient:1"])
        assert engine.solve()["light_warning"].startswith("light 1 (point) is in the body") == inside
    q = np.ones((len(engine.graph.levels[0].faces), 3), np.float32)
    engine.set_irradiance(0, q)
    engine.set_irradiance(1, np.ones((len(engine.graph.levels[1].faces), 3), np.float32))
    assert engine.solve()["light_warning"] == ""
