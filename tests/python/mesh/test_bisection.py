"""Triangles that are cut at some of their edges still meet, cover what they did, and become no thinner than half."""

from __future__ import annotations

import numpy as np
import pytest

from quadgraph.mesh import bisection
from quadgraph.mesh.surface import Surface
from shapes import cube, icosphere, torus


def halved(surface: Surface, marked: np.ndarray) -> tuple[Surface, bisection.Cut]:
    """The surface with these edges and what they want cut, flat."""
    marked = bisection.closed(surface, marked)
    middles = surface.vertices[surface.topology.edges[marked]].mean(axis=1)
    made = bisection.cut(surface, marked)
    return Surface(np.concatenate([surface.vertices, middles]), made.triangles), made


@pytest.mark.parametrize("surface", [icosphere(2, 10), torus(), cube(3)])
def test_a_surface_stays_closed_and_what_it_was_and_no_angle_is_below_half(surface: Surface) -> None:
    random, finer = np.random.default_rng(1), surface
    for _ in range(5):
        marked = random.random(len(finer.topology.edges)) < 0.05
        before, (finer, made) = finer, halved(finer, marked)
        assert finer.is_closed_manifold
        assert (finer.genus, finer.components) == (surface.genus, surface.components)
        assert finer.corners == pytest.approx(made.carried(before.corners), abs=1e-12)
    assert len(finer.triangles) > 2 * len(surface.triangles)
    assert (finer.area, finer.volume) == pytest.approx((surface.area, surface.volume), rel=1e-9)
    assert finer.min_angle >= 0.5 * surface.min_angle - 1e-6


def test_without_a_marked_edge_nothing_is_cut_and_with_all_every_triangle_becomes_four() -> None:
    ball = icosphere(2, 10)
    same, made = halved(ball, np.zeros(len(ball.topology.edges), bool))
    assert np.array_equal(same.triangles, ball.triangles)
    assert np.array_equal(made.parent, np.arange(len(ball.triangles)))
    finer, made = halved(ball, np.ones(len(ball.topology.edges), bool))
    assert (np.bincount(made.parent) == 4).all()
    assert bisection.edge_lengths(finer).max() == pytest.approx(bisection.edge_lengths(ball).max() / 2)


def test_a_marked_edge_takes_the_longest_of_its_triangles_with_it() -> None:
    ball = icosphere(1, 10)
    ball = Surface(ball.vertices * [1, 1, 3], ball.triangles)
    for edge in range(0, len(ball.topology.edges), 7):
        marked = np.arange(len(ball.topology.edges)) == edge
        found = bisection.closed(ball, marked)
        lengths = bisection.edge_lengths(ball)[ball.topology.face_edges]
        cut = found[ball.topology.face_edges]
        assert found[edge]
        some = cut.any(axis=1)
        assert (np.where(cut, lengths, 0).max(axis=1)[some] >= lengths.max(axis=1)[some] - 1e-12).all()
