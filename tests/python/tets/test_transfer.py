"""Transfers between levels and the display mesh's map: weights, exactness, nearest points."""

import numpy as np
import pytest
import trimesh

import tiny
from quadgraph.mesh import display_map
from quadgraph.mesh.surface import Surface
from quadgraph.tets import graph, transfer
from quadgraph.tets.tetrahedralise import tetrahedralise
from shapes import icosphere, torus


@pytest.fixture(scope="module")
def coarse() -> graph.Graph:
    return graph.build(tetrahedralise(icosphere(2, 10)))


def inside(points: int, radius: float, seed: int = 0) -> np.ndarray:
    generator = np.random.default_rng(seed)
    direction = generator.normal(size=(points, 3))
    direction /= np.linalg.norm(direction, axis=1, keepdims=True)
    return radius * generator.random((points, 1)) ** (1 / 3) * direction


def check_weights(rows: transfer.Transfer, limit: int) -> None:
    assert rows.weight.min() >= 0
    np.testing.assert_allclose(rows.weight.sum(axis=1), 1, atol=1e-12)
    assert rows.index.min() >= 0
    assert rows.index.max() < limit


def test_inverse_distance_is_shepards_rule(coarse):
    points = inside(50, 9)
    rows = transfer.inverse_distance(points, coarse.inner, 8)
    check_weights(rows, len(coarse.inner))
    for point, index, weight in zip(points, rows.index, rows.weight, strict=True):
        distance = np.linalg.norm(coarse.inner - point, axis=1)
        assert set(index) == set(np.argsort(distance)[:8])
        expected = distance[index] ** -2.0
        np.testing.assert_allclose(weight, expected / expected.sum(), rtol=1e-9)


def test_a_coincident_point_takes_all_the_weight(coarse):
    rows = transfer.inverse_distance(coarse.inner[:5], coarse.inner, 8)
    assert np.array_equal(rows.index[:, 0], np.arange(5))
    assert np.array_equal(rows.weight, np.tile(np.eye(1, 8), (5, 1)))


def test_few_coarse_points_are_padded():
    rows = transfer.inverse_distance(inside(20, 1), np.array([[1.0, 0, 0], [0, 1, 0]]), 4)
    check_weights(rows, 2)
    assert (rows.weight[:, 2:] == 0).all()


def test_one_coarse_point_gets_everything():
    rows = transfer.inverse_distance(inside(4, 1), np.zeros((1, 3)), 8)
    assert np.array_equal(rows.weight, np.tile(np.eye(1, 8), (4, 1)))
    assert not rows.index.any()


@pytest.mark.parametrize("shape", [icosphere(2, 10), torus()], ids=["ball", "torus"])
def test_linear_functions_are_reproduced_inside(shape):
    coarse = graph.build(tetrahedralise(shape))
    generator = np.random.default_rng(5)
    tet = generator.integers(len(coarse.tets), size=2000)
    weights = generator.dirichlet(np.ones(4), 2000)
    points = np.einsum("ij,ijk->ik", weights, coarse.vertices[coarse.tets[tet]])
    rows = transfer.barycentric(points, coarse)
    check_weights(rows, len(coarse.vertices))
    reached = np.einsum("ij,ijk->ik", rows.weight, coarse.vertices[rows.index])
    np.testing.assert_allclose(reached, points, atol=1e-9)


def test_coarse_vertices_take_their_own_value(coarse):
    rows = transfer.barycentric(coarse.vertices, coarse)
    reached = np.einsum("ij,ijk->ik", rows.weight, coarse.vertices[rows.index])
    np.testing.assert_allclose(reached, coarse.vertices, atol=1e-9)


def test_points_outside_are_clamped_next_to_them(coarse):
    """The polyhedron lies within 10 mm - 10 mm cos(edge/2): clamping may at most about double that distance."""
    directions = icosphere(4, 1).vertices
    points = 10 * directions / np.linalg.norm(directions, axis=1, keepdims=True)
    rows = transfer.barycentric(points, coarse)
    check_weights(rows, len(coarse.vertices))
    reached = np.einsum("ij,ijk->ik", rows.weight, coarse.vertices[rows.index])
    moved = np.linalg.norm(reached - points, axis=1)
    _, nearest, _ = trimesh.proximity.closest_point_naive(
        trimesh.Trimesh(coarse.vertices, coarse.faces, process=False), points
    )
    assert (nearest > 1e-6).any()
    assert moved.max() < 3 * nearest.max()


def test_the_walk_finds_tets_that_are_not_nearest():
    # Long thin tets: the nearest centroids belong to other tets than the one around the point.
    stretched = graph.build(tiny.six())
    scale = np.array([1.0, 1.0, 64.0])
    long = graph.Graph(
        stretched.vertices * scale,
        stretched.tets,
        stretched.faces,
        stretched.face_tets,
        stretched.links,
        stretched.inner * scale,
        stretched.surface * scale,
    )
    points = np.random.default_rng(2).uniform(0.01, 1.99, size=(500, 3)) * scale
    rows = transfer.barycentric(points, long)
    reached = np.einsum("ij,ijk->ik", rows.weight, long.vertices[rows.index])
    np.testing.assert_allclose(reached, points, atol=1e-9)


def test_identical_surfaces_are_matched_exactly():
    surface = torus()
    face, coordinates = display_map.nearest_faces(surface.vertices, surface)
    assert np.array_equal(np.sort(coordinates, axis=1), np.tile([0.0, 0, 1], (len(surface.vertices), 1)))
    reached = np.einsum("ij,ijk->ik", coordinates, surface.corners[face])
    assert np.array_equal(reached, surface.vertices)


@pytest.mark.parametrize("offset", [0.0, 0.7])
def test_nearest_faces_are_nearest(offset):
    surface = torus(around=24, across=12)
    fine = torus(around=40, across=20)
    points = fine.vertices + offset * display_map.vertex_normals(fine)
    face, coordinates = display_map.nearest_faces(points, surface)
    assert coordinates.min() >= 0
    reached = np.einsum("ij,ijk->ik", coordinates, surface.corners[face])
    found = np.linalg.norm(points - reached, axis=1)
    exact = trimesh.proximity.closest_point_naive(
        trimesh.Trimesh(surface.vertices, surface.triangles, process=False), points
    )[1]
    np.testing.assert_allclose(found, exact, atol=1e-9)


def test_closest_points_of_a_triangle_by_brute_force():
    generator = np.random.default_rng(8)
    corners, points = generator.normal(size=(40, 3, 3)), 2 * generator.normal(size=(40, 3))
    coordinates = display_map.closest_point_coordinates(points, corners)
    grid = np.array([(i, j, 200 - i - j) for i in range(201) for j in range(201 - i)]) / 200
    brute = np.linalg.norm(grid @ corners - points[:, None], axis=2).min(axis=1)
    found = np.linalg.norm(np.einsum("ij,ijk->ik", coordinates, corners) - points, axis=1)
    assert (found <= brute + 1e-12).all()
    assert (brute - found < 0.05).all()


def test_normals_of_a_sphere_point_outward():
    sphere = icosphere(3, 5)
    normals = display_map.vertex_normals(sphere)
    np.testing.assert_allclose(np.linalg.norm(normals, axis=1), 1, atol=1e-12)
    assert (np.einsum("ij,ij->i", normals, sphere.vertices) / 5).min() > 0.999


def test_an_unused_vertex_still_gets_a_unit_normal():
    sphere = icosphere(1)
    lonely = Surface(np.concatenate([sphere.vertices, [[9.0, 9, 9]]]), sphere.triangles)
    assert np.array_equal(display_map.vertex_normals(lonely)[-1], [0, 0, 1])
