"""What is said of a material that changes within tets is what another sample of it in them changes."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.spatial import cKDTree

from quadgraph import Engine, VolumeMaterial
from quadgraph.baking.pipeline import BakeOptions, bake
from quadgraph.mesh.patches import patches_of
from quadgraph.mesh.surface import Surface
from quadgraph_validation.bodies import unseen_bodies
from shapes import icosphere

core = pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")

CELL, ETA = 4.0, 1.3  # mm
SUN = "directional:0.3,-0.2,-0.9:1"


def checker(points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """sigma_s_prime and sigma_a, (n, 3) each."""
    odd = np.floor(np.asarray(points, np.float64) / CELL).sum(axis=1) % 2 > 0
    return np.outer(np.where(odd, 2.5, 0.5), [1, 1, 1]), np.outer(np.where(odd, 0.1, 0.01), [1, 1, 1])


@pytest.fixture(scope="module")
def ball() -> Surface:
    return icosphere(4, 10.0)


@pytest.fixture(scope="module")
def body(ball, tmp_path_factory):
    folder = tmp_path_factory.mktemp("medium")
    unseen_bodies.write(folder / "ball.ply", ball)
    bake(folder / "ball.ply", folder / "ball.qgraph", BakeOptions(unit="mm", visibility_rays=0))
    return folder / "ball.qgraph"


@pytest.fixture
def engine(body) -> core.Engine:
    opened = core.Engine(body)
    opened.set_lights([SUN])
    return opened


def fill(engine: core.Engine, elsewhere: bool, *, drawn: bool = False) -> None:
    """Give it the checker; drawn: with what it is at other points of the finest tets in place of their middles."""
    graph = engine.graph
    there = checker(core.points_in_tets(graph, 0))
    for number, level in enumerate(graph.levels):
        coefficients = checker(np.array(level.nodes))
        if drawn and number == 0:
            for values, others in zip(coefficients, there, strict=True):
                values[: len(level.tets)] = others[: len(level.tets)]
        engine.set_optical(number, *coefficients, ETA, there if elsewhere and number == 0 else None)


def by_patch(engine: core.Engine, patch: np.ndarray) -> np.ndarray:
    """Exitance of red by patch, of a solve without correction."""
    engine.solve(correction=False)
    field = engine.surface_field()
    return np.bincount(patch, field["area"] * field["exitance"][:, 0]) / np.bincount(patch, field["area"])


def rms(values: np.ndarray) -> float:
    return math.sqrt(np.mean(values**2))


def test_what_is_said_is_what_another_sample_changes(engine, ball):
    errors = []
    for elsewhere in (True, False):
        fill(engine, elsewhere)
        report = engine.solve(correction=True)
        errors.append(report["mesh_error"]["whole"])
        assert ("the material changes within tets" in report["mesh_warning"]) == elsewhere
    told = math.sqrt(errors[0] ** 2 - errors[1] ** 2)
    _, nearest = cKDTree(ball.corners.mean(axis=1)).query(engine.surface_field()["position"])
    patch = patches_of(ball)[nearest]
    own = by_patch(engine, patch)
    fill(engine, False, drawn=True)
    changed = rms(by_patch(engine, patch) - own) / math.sqrt(2) / rms(own)
    assert 0.6 < told / changed < 1.6


@pytest.mark.long
def test_functions_and_grids_are_judged_alike(body, engine):
    fill(engine, True)
    known = engine.solve(correction=True)["mesh_error"]["whole"]
    with Engine(body) as opened:
        opened.lights = [SUN]
        opened.set_coefficients(checker, ETA)
        assert opened.solve().mesh_error.whole == pytest.approx(known, rel=1e-4)
        opened.material = VolumeMaterial.from_function(checker, opened.box, 0.25, ETA)
        assert opened.solve().mesh_error.whole == pytest.approx(known, rel=0.2)
