"""The QuadGraph of a tet mesh: four links or one, symmetric, connected, filling the body; and its relaxed nodes."""

import itertools

import numpy as np
import pytest
from scipy import sparse
from scipy.sparse.csgraph import connected_components
from scipy.spatial import Delaunay

import tiny
from quadgraph.base.errors import InputError
from quadgraph.mesh.surface import MesherInfo, TetMesh
from quadgraph.tets import graph, relax
from quadgraph.tets.tet_geometry import FACE_CORNERS, determinants
from quadgraph.tets.tetrahedralise import tetrahedralise
from shapes import icosphere, join, moved, torus

ONE_TET = np.array([[0.0, 0, 0], [3, 0, 0], [0, 3, 0], [0, 0, 3]])


def ball(points: int = 400, seed: int = 0) -> TetMesh:
    """Return the Delaunay tets of random points in a ball of 10 mm: many tets with several outside faces."""
    generator = np.random.default_rng(seed)
    inside = generator.normal(size=(points, 3))
    inside *= 10 * generator.random((points, 1)) ** (1 / 3) / np.linalg.norm(inside, axis=1, keepdims=True)
    vertices = inside.astype(np.float32).astype(np.float64)
    tets = Delaunay(vertices).simplices.astype(np.int64)
    negative = determinants(vertices, tets) < 0
    tets[negative, :2] = tets[negative, 1::-1]
    return by_hand(vertices, tets)


def by_hand(vertices: np.ndarray, tets: np.ndarray) -> TetMesh:
    return TetMesh(np.asarray(vertices, np.float64), np.asarray(tets, np.int64), MesherInfo("hand", "1", ""))


MESHES = {
    "one tet": by_hand(ONE_TET, [[0, 1, 2, 3]]),
    "cube in five": tiny.FIVE,
    "cube in six": tiny.six(),
    "random ball": ball(),
    "torus": tetrahedralise(torus()),
    "two spheres": tetrahedralise(join(icosphere(2, 5), moved(icosphere(1, 2), 20, 0, 0))),
}


@pytest.fixture(params=MESHES, scope="module")
def mesh(request) -> TetMesh:
    return MESHES[request.param]


@pytest.fixture(scope="module")
def built(mesh) -> graph.Graph:
    return graph.build(mesh)


def link_matrix(built: graph.Graph) -> sparse.csr_matrix:
    """Return how often each node is linked to each other, both kinds of node."""
    n_t, n_f = len(built.tets), len(built.faces)
    rows = np.concatenate([np.repeat(np.arange(n_t), 4), n_t + np.arange(n_f)])
    columns = np.concatenate([built.links.ravel(), built.face_tets])
    return sparse.coo_matrix((np.ones(len(rows)), (rows, columns)), shape=(n_t + n_f,) * 2).tocsr()


def test_four_links_or_one_each_its_own_reverse(built):
    links = link_matrix(built)
    n_t = len(built.tets)
    degree = np.diff(links.indptr)
    assert (degree[:n_t] == 4).all()
    assert (degree[n_t:] == 1).all()
    assert links.data.max() == 1
    assert (links != links.T).nnz == 0
    assert links.diagonal().sum() == 0


def test_link_k_crosses_the_face_opposite_to_vertex_k(built):
    tet, k = np.nonzero(built.links < len(built.tets))
    mine = np.sort(built.tets[tet[:, None], FACE_CORNERS[k]], axis=1)
    other = built.tets[built.links[tet, k]]
    assert (mine[:, :, None] == other[:, None, :]).any(axis=2).all()


def test_all_nodes_of_a_piece_are_reached(built):
    pieces, label = connected_components(link_matrix(built), directed=False)
    assert pieces == built.boundary.components
    assert np.array_equal(label[len(built.tets) :], label[built.face_tets])


def test_at_most_one_outside_face(built):
    assert (built.links >= len(built.tets)).sum(axis=1).max() == 1


def test_the_surface_is_kept(mesh, built):
    before, after = mesh.boundary(), built.boundary
    assert len(after.triangles) == len(before.triangles)
    assert after.is_closed_manifold
    corners = [np.sort(s.corners.reshape(-1, 9), axis=0) for s in (before, after)]
    assert np.array_equal(*corners)


def test_volumes_add_up(mesh, built):
    assert built.volume == pytest.approx(mesh.volume, rel=1e-12)
    assert built.volume == pytest.approx(mesh.boundary().volume, rel=1e-6)


def test_tets_are_positive_in_single_precision(built):
    assert np.array_equal(built.vertices, built.vertices.astype(np.float32))
    assert determinants(built.vertices.astype(np.float32), built.tets).min() > 0


def test_surface_vertices_come_first_and_all_are_used(built):
    assert np.array_equal(np.unique(built.faces), np.arange(built.surface_vertex_count))
    assert np.array_equal(np.unique(built.tets), np.arange(len(built.vertices)))


@pytest.mark.parametrize(("name", "tets"), [("one tet", 4), ("cube in five", 17), ("cube in six", 24)])
def test_splitting_as_in_figure_4(name, tets):
    assert len(graph.build(MESHES[name]).tets) == tets


def test_nodes_lie_at_centroids(built):
    np.testing.assert_allclose(built.inner, built.vertices[built.tets].mean(axis=1), atol=1e-12)
    np.testing.assert_allclose(built.surface, built.vertices[built.faces].mean(axis=1), atol=1e-12)
    assert np.array_equal(built.nodes, np.concatenate([built.inner, built.surface]))


def test_a_centroid_that_rounds_out_of_its_tet_is_replaced():
    # Three lattice steps of float32 high: the centroid's height rounds, but a point inside exists.
    step = np.spacing(np.float32(1000.0)).astype(np.float64)
    corners = 1000 + np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 3 * step]])
    built = graph.build(by_hand(corners, [[0, 1, 2, 3]]))
    assert determinants(built.vertices, built.tets).min() > 0


def test_a_tet_without_room_is_refused():
    step = np.spacing(np.float32(1000.0)).astype(np.float64)
    corners = 1000 + np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, step]])
    with pytest.raises(InputError, match="too flat"):
        graph.build(by_hand(corners, [[0, 1, 2, 3]]))


def _pair(shared: int) -> TetMesh:
    """Return two tets that share as many vertices."""
    mirrored = np.concatenate([ONE_TET[:shared], -ONE_TET[shared:] - 1])
    numbers = [*range(shared), *range(4, 8 - shared)]
    vertices = np.concatenate([ONE_TET, mirrored[shared:]])
    tets = np.array([[0, 1, 2, 3], numbers])
    if determinants(vertices, tets)[1] < 0:
        tets[1, 2:] = tets[1, :1:-1]
    return by_hand(vertices, tets)


@pytest.mark.parametrize("shared", [1, 2])
def test_pinched_boundaries_are_refused(shared):
    with pytest.raises(InputError, match="not a closed manifold"):
        graph.build(_pair(shared))


def test_three_tets_at_a_face_are_refused():
    vertices = np.concatenate([ONE_TET, [[0, 0, 4.0], [0, 0, 5.0]]])
    with pytest.raises(InputError, match="three tets share a face"):
        graph.build(by_hand(vertices, [[0, 1, 2, 3], [0, 1, 2, 4], [0, 1, 2, 5]]))


@pytest.fixture(scope="module")
def sphere() -> graph.Graph:
    return graph.build(tetrahedralise(icosphere(3, 10)))


def test_relaxing_evens_the_links_out(sphere):
    variation = [relax.link_length_variation(relax.relax(sphere, steps)) for steps in (0, 2, relax.DEFAULT_STEPS)]
    local = [entry["local"] for entry in variation]
    assert local[2] < local[1] < local[0]
    assert local[2] < 0.5 * local[0]
    assert variation[2]["overall"] < variation[0]["overall"]


@pytest.mark.parametrize("steps", [1, 100])
def test_relaxed_nodes_stay_in_their_tets(built, steps):
    relaxed = relax.relax(built, steps)
    corners = built.vertices[built.tets]
    inside = graph.barycentric(graph.barycentric_gradients(corners), relaxed.inner - corners[:, 0])
    assert inside.min() > 0.04
    assert np.array_equal(relaxed.surface, built.surface)


def test_no_steps_change_nothing(sphere):
    assert relax.relax(sphere, 0).inner is sphere.inner


def test_barycentric_coordinates_of_tets():
    weights = np.array(list(itertools.product((-0.5, 0.2, 0.7), repeat=3)))
    weights = np.column_stack([1 - weights.sum(axis=1), weights])
    corners = np.repeat(ONE_TET[None] + 0.3, len(weights), axis=0)
    offsets = weights @ (ONE_TET + 0.3) - corners[:, 0]
    found = graph.barycentric(graph.barycentric_gradients(corners), offsets)
    np.testing.assert_allclose(found, weights, atol=1e-12)
