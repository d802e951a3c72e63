"""What faces see of each other: closed forms of visibility, and that it moves with the body."""

from __future__ import annotations

import dataclasses
import json
import sys
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from quadgraph.baking import pipeline
from quadgraph.base.errors import InputError, ToolError
from quadgraph.commands.info import describe
from quadgraph.file import qgraph_file, sections
from quadgraph.tets import exchange
from quadgraph_validation.bodies import meshes
from shapes import torus, write_obj

EDGE, THICKNESS, GAP = 10.0, 1.0, 4.0


@pytest.fixture(scope="module")
def plates():
    return meshes.facing_plates(EDGE, THICKNESS, GAP, across=12)


@pytest.fixture(scope="module")
def shell():
    return meshes.shell(5.0, 7.0, layers=1, subdivisions=3)


def rows(table: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Row and face of every entry."""
    faces = int(table[0]) - 1
    return np.repeat(np.arange(faces), np.diff(table[: faces + 1].astype(np.int64))), table[faces + 1 :].astype(
        np.int64
    )


def received(table: np.ndarray, rays: int, exitance: np.ndarray) -> np.ndarray:
    """Irradiance (n_f,) of every face under (n_f,) `exitance`, W/mm^2, as the rays sample it."""
    row, face = rows(table)
    return np.bincount(row, exitance[face], len(exitance)) / rays


def point_to_square(point: np.ndarray) -> np.ndarray:
    """Form factor from elements at (n, 2) `point` to the parallel square of EDGE at distance GAP, by contour."""

    def corner(x: np.ndarray, y: np.ndarray) -> np.ndarray:
        a, b = np.sqrt(1 + x * x), np.sqrt(1 + y * y)
        return (x / a * np.arctan(y / a) + y / b * np.arctan(x / b)) / (2 * np.pi)

    low, high = (-EDGE / 2 - point) / GAP, (EDGE / 2 - point) / GAP
    return sum(
        sign * corner(x[:, 0], y[:, 1])
        for sign, x, y in ((1, high, high), (-1, low, high), (-1, high, low), (1, low, low))
    )


def test_rays_are_weighted_by_the_cosine(plates):
    frames = exchange.frames(plates.vertices, plates.faces)
    way = exchange.directions(frames, np.arange(len(plates.faces)), 256)
    np.testing.assert_allclose(np.linalg.norm(way, axis=2), 1, atol=1e-12)
    cosine = np.einsum("nrk,nk->nr", way, frames[:, 2])
    # The midpoint rule for the mean of cos = sqrt(1 - u) over u; its error falls as N^-3/2 where the root ends.
    np.testing.assert_allclose(cosine.mean(axis=1), 2 / 3, atol=256**-1.5)
    across = np.einsum("nrk,njk->nrj", way, frames[:, :2])
    assert np.abs(across.mean(axis=1)).max() < 4 / 256
    np.testing.assert_allclose(
        np.einsum("nri,nrj->nij", across, across) / 256, np.full((len(way), 1, 1), 0.25) * np.eye(2), atol=0.01
    )


def test_inside_of_a_shell_every_ray_meets_the_shell(shell):
    seen = exchange.Seen(0, 256, exchange.table(shell, 256))
    inside = np.linalg.norm(shell.surface, axis=1) < 6
    assert inside.sum() == 1280
    assert (seen.share[inside] == 1).all()
    assert (seen.share[~inside] == 0).all()
    _, face = rows(seen.table)
    assert inside[face].all()
    # Uniform light inside arrives as it left.
    np.testing.assert_allclose(received(seen.table, 256, np.where(inside, 0.7, 3.0)), 0.7 * inside, rtol=1e-14)


def test_inside_of_a_shell_every_face_is_seen_by_its_area(shell):
    """Form factors in a sphere are the areas' shares, from everywhere; so is each column of a sampled row's sum."""
    rays = 1024
    _, face = rows(exchange.table(shell, rays))
    area = meshes.face_frames(shell)[2]
    inside = np.linalg.norm(shell.surface, axis=1) < 6
    expected = (np.where(inside, area, 0) / area[inside].sum() * rays * inside.sum())[inside]
    found = np.bincount(face, minlength=len(area))[inside]
    # Counts of independent rays would be off by sqrt(expected), a thirty-second of about 1024.
    assert np.sqrt(np.mean((found - expected) ** 2 / expected)) < 1


def test_a_ball_sees_nothing_of_itself():
    ball = meshes.ball(10.0, 0)
    table = exchange.table(ball, 64)
    assert (table == len(ball.faces) + 1).all()
    assert len(table) == len(ball.faces) + 1


def test_facing_squares_see_each_other_as_the_closed_form_says(plates):
    _, normal, area = meshes.face_frames(plates)
    centre = plates.surface
    upper = (normal[:, 2] < -0.5) & (centre[:, 2] > 0)
    lower = (normal[:, 2] > 0.5) & (centre[:, 2] < 0)
    exact = point_to_square(centre[upper, :2])
    errors = []
    for rays in (16, 64, 256, 1024):
        seen = exchange.Seen(0, rays, exchange.table(plates, rays))
        assert (seen.share[~(upper | lower)] == 0).all()
        row, face = rows(seen.table)
        assert (upper[row] == lower[face]).all()
        errors.append(np.sqrt(np.mean((seen.share[upper] - exact) ** 2)))
        assert errors[-1] < np.sqrt(np.mean(exact * (1 - exact)) / rays)
    # Points of low discrepancy: N^-3/4 for a region with a smooth rim, against N^-1/2 at random.
    rate = np.polyfit(np.log([16, 64, 256, 1024]), np.log(errors), 1)[0]
    print("RMS error of the visible share at 16, 64, 256, 1024 rays:", errors, "order", rate)
    assert rate < -0.6
    # The whole square sees of the other what the mean of the points' closed form says; rays from many faces average.
    whole = (seen.share * area)[upper].sum() / area[upper].sum()
    assert whole == pytest.approx(np.average(exact, weights=area[upper]), abs=errors[-1] / np.sqrt(upper.sum()) * 4)


def test_what_is_sent_is_received(plates):
    """A_i F_ij = A_j F_ji: light from the upper plate to the lower is as much as the same light back."""
    centre, _, area = meshes.face_frames(plates)
    table = exchange.table(plates, 256)
    upper, lower = (np.where(side, 1.0, 0.0) for side in (centre[:, 2] > 0, centre[:, 2] < 0))
    there = (received(table, 256, upper) * area)[centre[:, 2] < 0].sum()
    back = (received(table, 256, lower) * area)[centre[:, 2] > 0].sum()
    assert there == pytest.approx(back, rel=1e-3)


def moved_mesh(graph, rotation: Rotation, offset: np.ndarray):
    """The graph carried along, rounded to what a file holds."""
    vertices = (graph.vertices @ rotation.as_matrix().T + offset).astype(np.float32).astype(np.float64)
    return dataclasses.replace(graph, vertices=vertices, surface=vertices[graph.faces].mean(axis=1))


def test_a_fresh_matrix_after_a_rigid_motion_is_the_stored_one(plates, shell):
    rotation, offset = Rotation.from_rotvec([0.4, -1.1, 0.7]), np.array([3.0, -20.0, 11.0])
    exitance = np.random.default_rng(4).uniform(0.5, 1.5, max(len(plates.faces), len(shell.faces)))
    for graph in (plates, shell):
        before, after = (exchange.table(g, 256) for g in (graph, moved_mesh(graph, rotation, offset)))
        count = len(graph.faces)
        pairs = [np.bincount(row * count + face, minlength=count * count) for row, face in map(rows, (before, after))]
        flipped = np.abs(pairs[0] - pairs[1]).sum()
        rays = 256 * count
        # Coordinates move by their rounding, 1e-6 mm at 20 mm; a ray changes its face if that carries it over an edge,
        # on faces of about 0.8 mm after some 10 mm: 1e-6 / 0.8 * 10 / 0.8, times the sides of a triangle and slack.
        print(f"{flipped / 2} of {rays} rays changed their face")
        assert flipped / 2 < 1e-4 * rays
        both = [received(t, 256, exitance[:count]) for t in (before, after)]
        assert np.abs(both[0] - both[1]).max() <= 2 / 256 * 1.5
        assert np.sqrt(np.mean((both[0] - both[1]) ** 2)) < 1e-3 * np.sqrt(np.mean(both[0] ** 2))


def test_where_single_precision_fails_double_decides(plates, monkeypatch):
    """A ray tracer that says only wrong faces, seen from behind, changes at most rays that graze an edge."""
    right = exchange.table(plates, 8)
    normals = exchange.frames(plates.vertices, plates.faces)[:, 2]
    wrong = SimpleNamespace(run=lambda origins, ways: (ways @ normals.T).argmax(axis=1).astype(np.int32))
    monkeypatch.setattr(exchange, "_scene", lambda corners: (wrong, None))
    again = exchange.table(plates, 8)
    np.testing.assert_allclose(received(again, 8, np.ones(len(normals))), received(right, 8, np.ones(len(normals))))
    assert np.mean(again != right) < 1e-2


def test_rays_at_shared_edges_and_corners_do_not_slip_through(shell):
    """Straight at the edges and corners of the inside, as close as single precision can aim."""
    caster = exchange._Caster(shell)
    inside = np.flatnonzero(np.linalg.norm(shell.surface, axis=1) < 6)
    corners = shell.vertices[shell.faces[inside]]
    targets = np.concatenate([corners.reshape(-1, 3), ((corners + np.roll(corners, 1, axis=1)) / 2).reshape(-1, 3)])
    for face in inside[:20]:
        away = targets[~(np.abs((targets - shell.surface[face]) @ caster.frames[face, 2]) < 1e-3)]
        way = away - caster.origins[face]
        met = caster.first_faces(np.array([face]), (way / np.linalg.norm(way, axis=1)[:, None])[None])
        assert (met >= 0).all()


def test_the_finest_level_that_is_small_enough_is_taken():
    def sized(*counts: int) -> list:
        return [SimpleNamespace(faces=range(n)) for n in counts]

    assert exchange.level_of(sized(70000, 8193, 8192, 100)) == 2
    assert exchange.level_of(sized(20, 10)) == 0
    assert exchange.level_of(sized(70000, 9000)) == 1


@pytest.fixture(scope="module")
def ring(tmp_path_factory) -> Path:
    return write_obj(torus(), tmp_path_factory.mktemp("ring") / "ring.obj")


def test_the_bake_stores_it_once_and_the_same_every_time(ring, tmp_path):
    options = pipeline.BakeOptions(unit="mm", levels=2)
    reports = [pipeline.bake(ring, tmp_path / name, options) for name in ("a.qgraph", "b.qgraph")]
    assert (tmp_path / "a.qgraph").read_bytes() == (tmp_path / "b.qgraph").read_bytes()
    file = qgraph_file.read(tmp_path / "a.qgraph")
    assert file.metadata["options"]["visibility_rays"] == exchange.DEFAULT_RAYS
    seen = sections.read_exchange(file)
    assert (seen.level, seen.rays) == (0, exchange.DEFAULT_RAYS)
    assert reports[0].exchange == describe(file)["exchange"]
    assert reports[0].exchange["bytes"] == seen.table.nbytes
    assert reports[0].exchange["entries"] == seen.entries > 0
    assert 0 < reports[0].exchange["share"] < 1
    assert reports[0].seconds["exchange"] > 0


def test_the_bunny_sees_itself_at_little_cost(small_bunny):
    """9% of all directions (docs/physics.md, "Inter-reflection", on a finer surface); within 10 s and 8 MB."""
    report = json.loads(small_bunny.with_suffix(".json").read_text())
    print(report["exchange"], report["seconds"])
    assert report["exchange"]["share"] == pytest.approx(0.09, abs=0.015)
    assert report["exchange"]["bytes"] < 8e6
    assert report["seconds"]["exchange"] < 10


def test_the_bake_can_leave_it_out(ring, tmp_path):
    report = pipeline.bake(ring, tmp_path / "a.qgraph", pipeline.BakeOptions(unit="mm", levels=1, visibility_rays=0))
    file = qgraph_file.read(tmp_path / "a.qgraph")
    assert report.exchange is None
    assert sections.read_exchange(file) is None
    assert describe(file)["exchange"] is None
    assert "embreex" not in file.metadata["tools"]


@pytest.mark.parametrize("rays", [-1, exchange.MOST_RAYS + 1])
def test_unusable_numbers_of_rays_are_refused_at_once(rays, tmp_path):
    with pytest.raises(InputError, match=f"visibility_rays: {rays} found, 0 .none. to 4096 allowed"):
        pipeline.bake(
            tmp_path / "absent.obj", tmp_path / "a.qgraph", pipeline.BakeOptions(unit="mm", visibility_rays=rays)
        )


def test_a_missing_ray_tracer_is_named(plates, monkeypatch):
    monkeypatch.setitem(sys.modules, "embreex.rtcore_scene", None)
    with pytest.raises(ToolError, match="embreex is missing"):
        exchange.bake([plates], 16)


def test_an_interruption_leaves_no_file(ring, tmp_path, monkeypatch):
    def interrupt(*args: object) -> np.ndarray:
        raise KeyboardInterrupt

    monkeypatch.setattr(exchange, "directions", interrupt)
    with pytest.raises(KeyboardInterrupt):
        pipeline.bake(ring, tmp_path / "a.qgraph", pipeline.BakeOptions(unit="mm", levels=1))
    assert not list(tmp_path.iterdir())
