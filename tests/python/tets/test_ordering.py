"""Cache-local order: a permutation of the same graph, in connected blocks, far more local than chance."""

import numpy as np
import pytest

from quadgraph.tets import graph, ordering, relax
from quadgraph.tets.tet_geometry import FACE_CORNERS
from quadgraph.tets.tetrahedralise import tetrahedralise
from shapes import icosphere, join, moved


@pytest.fixture(scope="module")
def built() -> graph.Graph:
    pair = join(icosphere(4, 10), moved(icosphere(2, 3), 20, 0, 0))
    return relax.relax(graph.build(tetrahedralise(pair)), 3)


@pytest.fixture(params=[ordering.in_blocks, ordering.at_random], scope="module")
def ordered(request, built) -> graph.Graph:
    return request.param(built)


def _rows(array: np.ndarray) -> np.ndarray:
    """Return the rows sorted, for comparison as sets."""
    return array[np.lexsort(array.T)]


def test_positions_are_permuted_together(built, ordered):
    for part in (
        lambda g: g.vertices,
        lambda g: np.concatenate([g.vertices[g.tets].reshape(-1, 12), g.inner], axis=1),
        lambda g: np.concatenate([g.vertices[g.faces].reshape(-1, 9), g.surface], axis=1),
    ):
        assert np.array_equal(_rows(part(built)), _rows(part(ordered)))


def test_links_still_cross_the_right_faces(ordered):
    tet, k = np.nonzero(ordered.links >= len(ordered.tets))
    face = ordered.links[tet, k] - len(ordered.tets)
    assert np.array_equal(ordered.face_tets[face], tet)
    assert np.array_equal(ordered.faces[face], ordered.tets[tet[:, None], FACE_CORNERS[k]])
    tet, k = np.nonzero(ordered.links < len(ordered.tets))
    shared = ordered.tets[tet[:, None], FACE_CORNERS[k]]
    assert (shared[:, :, None] == ordered.tets[ordered.links[tet, k]][:, None, :]).any(axis=2).all()


def test_surface_vertices_still_come_first(ordered):
    assert np.array_equal(np.unique(ordered.faces), np.arange(ordered.surface_vertex_count))


def test_vertices_are_numbered_by_first_use_up_to_windows(built):
    ordered = ordering.in_blocks(built)
    stream = np.concatenate([ordered.faces.ravel(), ordered.tets.ravel()])
    _, first = np.unique(stream, return_index=True)
    on_surface = ordered.surface_vertex_count
    vertex = np.arange(len(first))
    window = 2 * (vertex // ordering.WINDOW) + (vertex >= on_surface)
    starts = np.concatenate([[0], np.flatnonzero(np.diff(window)) + 1])
    latest, earliest = (reduce.reduceat(first, starts) for reduce in (np.maximum, np.minimum))
    assert len(starts) > 2
    assert (latest[:-1] < earliest[1:]).all()


def test_rows_of_a_window_shrink_and_need_little_padding(built):
    def padded(graph: graph.Graph) -> float:
        degree = ordering.degrees(graph)
        slices = np.pad(degree, (0, -len(degree) % 32)).reshape(-1, 32)
        return 32 * slices.max(axis=1).sum() / degree.sum()

    ordered = ordering.in_blocks(built)
    degree = ordering.degrees(ordered)
    neighbours = [set(), set()]
    for tet in ordered.tets:
        for seen, vertex in zip(neighbours, (0, ordered.surface_vertex_count), strict=True):
            if vertex in tet:
                seen.update(tet.tolist())
    assert [len(seen) - 1 for seen in neighbours] == [degree[0], degree[ordered.surface_vertex_count]]
    assert (np.diff(degree[: ordering.WINDOW]) <= 0).all()
    assert padded(ordered) < 1.12 < 1.25 < padded(ordering.at_random(built))


def test_blocks_beat_chance(built):
    blocks, chance = (ordering.inner_locality(how(built)) for how in (ordering.in_blocks, ordering.at_random))
    assert blocks["lines_per_block"] < 0.2 * chance["lines_per_block"]
    assert blocks["mean_distance"] < 0.2 * chance["mean_distance"]


def test_random_order_is_seeded(built):
    assert np.array_equal(ordering.at_random(built).tets, ordering.at_random(built).tets)
    assert not np.array_equal(ordering.at_random(built, 1).tets, ordering.at_random(built, 2).tets)


def test_each_block_is_a_breadth_first_ball():
    # A path numbered at random: blocks must be stretches of it, grown from their middle or end.
    generator = np.random.default_rng(3)
    place = generator.permutation(100)
    node = np.argsort(place)
    neighbours = np.full((100, 4), -1)
    neighbours[node[1:], 0] = node[:-1]
    neighbours[node[:-1], 1] = node[1:]
    order = ordering.breadth_first_blocks(neighbours, block=10)
    assert np.array_equal(np.sort(order), np.arange(100))
    first = np.sort(place[order[:10]])
    assert np.array_equal(first, first[0] + np.arange(10))
    assert (np.abs(place[order[:10]] - place[order[0]]) <= 9).all()


def test_isolated_nodes_are_all_taken():
    assert np.array_equal(ordering.breadth_first_blocks(np.full((5, 4), -1), block=2), np.arange(5))


def test_faces_know_their_three_neighbours(built):
    faces = built.faces
    across = ordering.face_neighbours(faces)
    for k in range(3):
        edge = faces[:, [k, (k + 1) % 3]]
        assert (edge[:, :, None] == faces[across[:, k]][:, None, :]).any(axis=2).all()
        assert (across[:, k] != np.arange(len(faces))).all()


def test_locality_of_known_orders():
    chain = np.stack([np.arange(64) - 1, np.arange(64) + 1], axis=1)
    chain[0, 0], chain[-1, 1] = 0, 63
    assert ordering.locality(chain, block=32) == {"mean_distance": 1.0, "lines_per_block": 3.0}


def test_260k_nodes_are_each_taken_once():
    n = 64
    index = np.arange(n**3).reshape(n, n, n)
    down = [np.roll(index, 1, axis).ravel() for axis in (0, 1)]
    neighbours = np.stack([*down, np.roll(index, -1, 0).ravel(), np.roll(index, 1, 2).ravel()], axis=1)
    order = ordering.breadth_first_blocks(neighbours)
    assert np.array_equal(np.sort(order), np.arange(n**3))
