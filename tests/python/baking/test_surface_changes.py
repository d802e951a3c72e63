"""A bake for a material that changes in space has short triangles where it changes, and the old ones elsewhere."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from quadgraph.baking import pipeline, surface_changes
from quadgraph.baking.surface_changes import EDGE_SHARE, MOST_ANYWAY, brightness, refined
from quadgraph.file import qgraph_file
from quadgraph.mesh.creases import unit
from quadgraph.mesh.looks.file_normals import FoundNormals
from quadgraph.mesh.looks.normal_texture import NormalTexture
from quadgraph.mesh.surface import Surface
from shapes import cube, icosphere, write_obj

core = pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")

PERIOD, RADIUS, PATH = 100.0, 10.0, 2.0  # mm: the checker changes where a coordinate is 0
CHECKER = f"sigma_s_prime=0.45,sigma_a=0.05,second_sigma_s_prime=0.1,second_sigma_a=0.4,pattern=checker,period={PERIOD}"
EVEN = "sigma_s_prime=0.45,sigma_a=0.05"


def odd(points: np.ndarray) -> np.ndarray:
    """Whether places (..., 3) have the checker's second material."""
    return np.floor(points / PERIOD).sum(axis=-1) % 2 > 0


def spread_over(surface: Surface) -> np.ndarray:
    """(m, n, 3) points inside triangles, others than those that the bake looks at."""
    weights = np.random.default_rng(1).dirichlet(np.ones(3), 60)
    return np.einsum("nc,mcj->mnj", weights, surface.corners)


def longest(surface: Surface) -> np.ndarray:
    """(m,) mm."""
    return np.linalg.norm(surface.corners - np.roll(surface.corners, 1, axis=1), axis=2).max(axis=1)


def turned_ball(subdivisions: int) -> Surface:
    """None of its edges lie where the checker changes."""
    found = icosphere(subdivisions, RADIUS)
    return Surface(found.vertices @ Rotation.from_euler("xyz", (0.3, 0.5, 0.7)).as_matrix(), found.triangles).rounded()


@pytest.fixture(scope="module")
def ball() -> Surface:
    return turned_ball(2)


@pytest.fixture(scope="module")
def finer(ball) -> Surface:
    return refined(ball, [CHECKER]).surface


def test_edges_are_short_where_the_checker_changes(ball, finer):
    assert longest(ball).min() > 2.5 * EDGE_SHARE * PATH  # else nothing would be seen
    of_other = odd(spread_over(finer)).mean(axis=1)
    changes = (of_other > 0.1) & (of_other < 0.9)
    assert changes.sum() > 200
    assert longest(finer)[changes].max() < 1.001 * EDGE_SHARE * PATH
    assert longest(finer)[changes].min() > 0.1 * EDGE_SHARE * PATH


def test_triangles_away_from_the_change_are_what_they_were():
    ball = turned_ball(4)
    finer = refined(ball, [CHECKER.replace("0.45", "2")]).surface
    assert len(finer.triangles) > 1.2 * len(ball.triangles)
    kept = {tuple(sorted(triangle)) for triangle in finer.triangles.tolist()}
    away = np.abs(ball.corners).min(axis=(1, 2)) > 2
    assert away.sum() > 0.2 * len(away)
    assert all(tuple(sorted(triangle)) in kept for triangle in ball.triangles[away].tolist())
    assert np.array_equal(finer.vertices[: len(ball.vertices)], ball.vertices)


def test_the_surface_stays_closed_and_comes_nearer_to_the_ball(ball, finer):
    assert finer.is_closed_manifold
    assert (finer.genus, finer.components) == (0, 1)
    assert finer.min_angle > 0.4 * ball.min_angle
    assert np.array_equal(finer.vertices, finer.vertices.astype(np.float32))
    off = np.abs(np.linalg.norm(finer.vertices, axis=1) - RADIUS).max()
    flat = RADIUS - np.linalg.norm(ball.corners.mean(axis=1), axis=1).min()
    assert off < 0.1 * flat


@pytest.mark.parametrize("materials", [[], [EVEN], ["skin1", EVEN], ["layered-skin"]])
def test_materials_that_are_the_same_all_over_the_surface_change_nothing(ball, materials):
    same = refined(ball, materials)
    assert same.surface is ball
    assert (same.cuts, same.note) == ((), "")


def test_only_the_mesher_that_keeps_triangles_gets_others(ball):
    assert refined(ball, [CHECKER], "cgal").surface is ball


def test_smooth_changes_are_cut_by_how_much_they_change(ball):
    clouds = CHECKER.replace(f"checker,period={PERIOD}", "clouds,period=8,sharpness=")
    counts = [len(refined(ball, [f"{clouds}{sharpness}"]).surface.triangles) for sharpness in (1, 20)]
    assert len(ball.triangles) < counts[0] < counts[1]


def test_where_too_many_triangles_would_be_needed_the_longest_are_cut_and_it_is_said():
    dense = CHECKER.replace("0.45", "45").replace("second_sigma_s_prime=0.1", "second_sigma_s_prime=45")
    found = refined(cube(20), [dense.replace(f"period={PERIOD}", "period=3")])
    assert MOST_ANYWAY / 4 < len(found.surface.triangles) <= MOST_ANYWAY
    assert "as more triangles would be too many" in found.note


def test_normals_and_places_in_a_texture_go_along():
    block = cube(20)
    flat = np.repeat(unit(block.doubled_normals)[:, None], 3, axis=1)
    flat[0, 1] = 0  # the file has none there
    places = np.concatenate([block.corners[..., :2] / 20, np.ones((len(flat), 3, 1))], axis=2)
    places[1] = 0
    made = refined(block, [CHECKER.replace(f"period={PERIOD}", "period=7")])
    texture = NormalTexture(np.zeros((1, 1, 3), np.uint8), places)
    found = FoundNormals("file", flat, texture=texture).cut(block, made.cuts)
    expected = np.repeat(unit(made.surface.doubled_normals)[:, None], 3, axis=1)
    assert found.at_corners == pytest.approx(expected, abs=1e-6)  # also where the file has none
    lies = found.texture.places[..., 2] == 1
    assert found.texture.places[lies][:, :2] == pytest.approx(made.surface.corners[lies][:, :2] / 20, abs=1e-6)
    assert not found.texture.places[~lies].any()
    assert 0 < (~lies).sum() < lies.sum()


def test_a_ball_without_normals_of_its_own_is_as_smooth_as_before(ball):
    made = refined(ball, [CHECKER])
    straight = made.straight(ball)
    normals = FoundNormals("angle").cut(ball, made.cuts).at_corners
    assert np.einsum("ijk,ijk->ij", normals, unit(straight.corners)).min() > np.cos(np.radians(3))
    assert np.einsum("ijk,ik->ij", normals, unit(straight.doubled_normals)).min() < np.cos(np.radians(6))


def test_a_bake_shows_one_short_triangle_by_another(ball, finer, tmp_path):
    report = pipeline.bake(
        write_obj(ball, tmp_path / "ball.obj"), tmp_path / "ball.qgraph",
        pipeline.BakeOptions(unit="mm", levels=2, for_materials=(CHECKER,), visibility_rays=0),
    )  # fmt: skip
    assert f"cut into {len(finer.triangles):,} where the material changes" in " ".join(report.notes)
    sections = qgraph_file.read(tmp_path / "ball.qgraph").sections
    assert len(sections["level0/faces"]) == len(sections["display/triangles"]) == len(finer.triangles)
    shown = Surface(sections["display/vertices"].astype(float), sections["display/triangles"].astype(np.int64))
    assert (shown.area, shown.volume) == pytest.approx((ball.area, ball.volume), rel=1e-5)
    faces = sections["level0/faces"][sections["display/face"]]
    reached = np.einsum("nc,ncj->nj", sections["display/barycentric"], sections["level0/vertices"][faces])
    rise = RADIUS - np.linalg.norm(ball.corners.mean(axis=1), axis=1).min()
    assert np.linalg.norm(reached - shown.vertices, axis=1).max() < 1.01 * rise
    graph = core.load(tmp_path / "ball.qgraph")
    middle = np.asarray(graph.levels[0].vertices)[np.asarray(graph.levels[0].faces)].mean(axis=1)
    own = unit(middle) @ unit(shown.corners.mean(axis=1)).T
    assert (own.max(axis=0) > np.cos(0.2 * EDGE_SHARE * PATH / RADIUS)).mean() > 0.95
    assert len(report.levels) == 2


def test_the_brightness_of_a_half_space_is_that_of_exact_transport():
    """H functions, isotropic scattering, light from all around [Chandrasekhar 1960]."""
    mu, weight = np.polynomial.legendre.leggauss(64)
    mu, weight = (mu + 1) / 2, weight / 2
    for albedo in (0.2, 0.8, 0.99):
        h = np.ones_like(mu)
        for _ in range(4000):
            h = 1 / (np.sqrt(1 - albedo) + albedo / 2 * (weight * mu * h / (mu[:, None] + mu)).sum(axis=1))
        plane = 1 - h * np.sqrt(1 - albedo)  # of light from one direction
        exact = 2 * (weight * mu * plane).sum()
        assert brightness(np.array([albedo]), np.array([1 - albedo]))[0] == pytest.approx(exact, abs=0.01)


def test_slight_changes_count_as_none(ball):
    slight = EVEN + ",second_sigma_s_prime=0.46,second_sigma_a=0.05,pattern=checker,period=5"
    assert surface_changes.SLIGHT > 0.46 / 0.45 - 1
    assert refined(ball, [slight]).surface is ball
