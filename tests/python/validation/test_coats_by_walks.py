"""Coated bodies held against random walks that go to and fro in the coat, of one polarisation each."""

from __future__ import annotations

import numpy as np
import pytest

from baked import write_levels
from quadgraph import AmbientLight, DirectionalLight, Engine, Material
from quadgraph.mesh.surface import Surface
from quadgraph_validation.bodies.unseen_cases import UnseenMedium
from shapes import icosphere

pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")
pytest.importorskip("numba", reason="the extra `walks` is not installed: run tools/setup")

from quadgraph_validation.truth import mesh_walk, microsurface

RADIUS, ZONES, BATCHES, WALKS = 8.0, 6, 8, 12_000
AXIS = np.array([2.0, 3.0, 6.0]) / 7
LIGHTS = {"sun": DirectionalLight(tuple(-AXIS), 1.0), "even": AmbientLight(1.0)}
LONG = pytest.mark.long


@pytest.fixture(scope="module")
def ball(tmp_path_factory):
    path = write_levels(tmp_path_factory.mktemp("coats") / "ball.qgraph", [icosphere(4, RADIUS)])
    with Engine(path) as engine:
        level = engine._engine.graph.levels[0]
        return path, Surface(np.array(level.vertices, np.float64), np.array(level.faces, np.int64))


@pytest.mark.parametrize("light", ["sun", pytest.param("even", marks=LONG)])
@pytest.mark.parametrize(
    ("eta", "coat_eta"), [(1.0, 1.5), pytest.param(1.3, 2.0, marks=LONG), pytest.param(1.6, 1.33, marks=LONG)]
)
def test_a_coated_ball_is_as_walks_say(ball, eta, coat_eta, light):
    path, surface = ball
    medium = UnseenMedium("even", eta, *(np.full((1, 1, 1), c, np.float32) for c in (1.0, 0.01)))
    patch = np.clip(((surface.corners.mean(axis=1) @ AXIS / RADIUS + 1) / 2 * ZONES).astype(int), 0, ZONES - 1)
    areas = np.bincount(patch, np.linalg.norm(surface.doubled_normals, axis=1) / 2)
    found = {}
    for coat in (0.0, coat_eta):
        walker = mesh_walk.MeshWalker(surface, medium, LIGHTS[light], patch, coat=coat)
        batches = [walker.batch(WALKS, number, seed=7) for number in range(BATCHES)]
        scattered = np.array([each.scattered for each in batches]) / areas
        entered = np.array([each.entered.sum() for each in batches])
        with Engine(path) as engine:
            engine.material = Material(1.0, 0.01, eta=eta, coat=float(coat > 0), coat_eta=max(coat, 1.0))
            engine.lights = [LIGHTS[light]]
            report = engine.solve()
            field = engine.surface()
        mine = np.bincount(patch, field.exitance[:, 0] * field.area) / areas
        true, noise = scattered.mean(axis=0), scattered.std(axis=0, ddof=1) / np.sqrt(BATCHES)
        let_in = report.energy.entered[0] / entered.mean() - 1
        spread = entered.std(ddof=1) / entered.mean() / np.sqrt(BATCHES)
        off = mine / true - 1
        print(
            f"coat {coat}: let in {100 * let_in:+.2f} ± {100 * spread:.2f}%, zones",
            " ".join(f"{100 * a:+.1f} ± {100 * b:.1f}" for a, b in zip(off, noise / true, strict=True)),
        )
        assert abs(let_in) < 0.005 + 4 * spread
        assert (np.abs(mine - true) < 4 * noise + 0.02 * true).all()
        found[coat] = mine, true
    print("coated over bare, zones", found[coat_eta][0] / found[0.0][0], "walks", found[coat_eta][1] / found[0.0][1])
    change = (found[coat_eta][0] @ areas) / (found[0.0][0] @ areas) - 1
    assert abs(change) > 0.03  # so that what is off above would show a coat left out


UP = np.array([0.0, 0.0, 1.0])


def follow(way: tuple[float, ...], surfaces: list[tuple[float, float, float]], state: np.ndarray) -> np.ndarray | None:
    """Direction of light that has gone down through rough surfaces (index above, index below, alpha); None: out."""
    at, down = 0, True
    while 0 <= at < len(surfaces):
        above, below, alpha = surfaces[at]
        # `at_rough_face` wants the denser side behind the normal.
        turned = above > below
        normal, inside = (-UP if turned else UP), down == turned
        ratio = max(above / below, below / above)
        *way, through = microsurface.at_rough_face(normal, *way, inside, ratio, alpha, state)
        down = down if through else not down
        at += 1 if down else -1
    return np.array(way) if down else None


@pytest.mark.parametrize(
    ("eta", "alpha", "coat_eta", "coat_alpha"),
    [(1.4, 0.6, 1.333, 0.02), (1.5, 0.5, 1.5, 0.2), (1.3, 0.2, 1.5, 0.02), (1.6, 0.6, 1.333, 0.05)],
)
@pytest.mark.parametrize("cosine", [1.0, 0.6])
def test_facets_of_coat_and_body_spread_light_as_those_of_one_surface(eta, alpha, coat_eta, coat_alpha, cosine):
    """That of docs/physics.md, "Coats"; backwards, along view rays."""
    one = np.hypot(alpha * (eta - coat_eta), coat_alpha * (coat_eta - 1)) / (eta - 1)
    way, state = (np.sqrt(1 - cosine**2), 0.0, -cosine), np.array([11], np.uint64)
    medians = []
    for surfaces in ([(1.0, coat_eta, coat_alpha), (coat_eta, eta, alpha)], [(1.0, eta, one)]):
        ways = [follow(way, surfaces, state) for _ in range(8000)]
        found = np.array([each for each in ways if each is not None])
        middle = found.mean(axis=0) / np.linalg.norm(found.mean(axis=0))
        medians.append(np.degrees(np.median(np.arccos(np.clip(found @ middle, -1, 1)))))
    print(f"half of the light within {medians[0]:.2f} and {medians[1]:.2f} degrees")
    assert medians[1] == pytest.approx(medians[0], rel=0.2)
