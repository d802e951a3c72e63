"""A subdivided surface comes nearer to the smooth body that it stands for, and keeps its corners."""

from __future__ import annotations

import numpy as np
import pytest

from quadgraph.base.errors import InputError
from quadgraph.mesh.creases import creases
from quadgraph.mesh.intersections import intersecting_triangles
from quadgraph.mesh.subdivide import subdivide
from quadgraph.mesh.surface import Surface
from shapes import cube, icosphere, torus


def cylinder(around: int) -> Surface:
    """A cylinder about z of radius 1 and height 2: one smooth side, two flat ends, two round rims."""
    angle = 2 * np.pi * np.arange(around) / around
    ring = np.column_stack([np.cos(angle), np.sin(angle)])
    vertices = [np.column_stack([ring, np.full(around, z)]) for z in (-1.0, 1.0)]
    a, b = np.arange(around), (np.arange(around) + 1) % around
    sides = np.concatenate([np.column_stack(t) for t in ((a, b, b + around), (a, b + around, a + around))])
    low, high = 2 * around, 2 * around + 1
    ends = [
        np.column_stack([b, a, np.full(around, low)]),
        np.column_stack([a + around, b + around, np.full(around, high)]),
    ]
    return Surface(
        np.concatenate([*vertices, [[0, 0, -1], [0, 0, 1]]]), np.concatenate([sides, *ends]).astype(np.int64)
    ).rounded()


@pytest.mark.parametrize("surface", [icosphere(2, 10), torus(), cube(3), cylinder(16)])
def test_vertices_stay_and_every_triangle_becomes_four(surface: Surface) -> None:
    finer = subdivide(surface, 2)
    assert len(finer.triangles) == 16 * len(surface.triangles)
    assert np.array_equal(finer.vertices[: len(surface.vertices)], surface.vertices)
    assert finer.is_closed_manifold
    assert (finer.genus, finer.components) == (surface.genus, surface.components)
    assert np.array_equal(finer.vertices, finer.vertices.astype(np.float32))
    assert not len(intersecting_triangles(finer))
    assert subdivide(surface, 0) is surface


def test_new_vertices_are_on_the_ball_by_the_fourth_power_of_the_edge() -> None:
    off = []
    for level in (1, 2, 3):
        ball = icosphere(level, 10)
        new = subdivide(ball, 1).vertices[len(ball.vertices) :]
        off.append(np.abs(np.linalg.norm(new, axis=1) - 10).max())
    flat = 10 * (1 - np.cos(np.arcsin(0.5 * 0.55)))  # of the middles of straight edges on the coarsest
    assert off[0] < 0.1 * flat
    assert np.log2(off[0] / off[1]) > 3.3
    assert np.log2(off[1] / off[2]) > 3.3


def test_a_coarse_ball_gets_the_volume_of_the_ball() -> None:
    exact = 4 / 3 * np.pi * 1000
    coarse = icosphere(2, 10)
    assert abs(subdivide(coarse, 2).volume / exact - 1) < 0.1 * abs(coarse.volume / exact - 1)


def test_a_cube_stays_a_cube() -> None:
    box = cube(2)
    assert creases(box).sum() == 12
    finer = subdivide(box, 3)
    assert finer.volume == pytest.approx(8, rel=1e-6)
    assert finer.area == pytest.approx(24, rel=1e-6)
    assert creases(finer).sum() == 12 * 8


def test_the_rim_of_a_cylinder_is_round_and_its_ends_are_flat() -> None:
    surface = cylinder(16)
    assert creases(surface).sum() == 32
    finer = subdivide(surface, 2)
    rim = np.abs(np.abs(finer.vertices[:, 2]) - 1) < 1e-6
    radius = np.linalg.norm(finer.vertices[:, :2], axis=1)
    outer = finer.vertices[:, 2][radius > 0.9]
    assert rim.sum() > 32
    assert np.abs(outer).max() <= 1 + 1e-6
    on_rim = rim & (radius > 0.95)
    assert on_rim.sum() == 2 * 64
    assert np.abs(radius[on_rim] - 1).max() < 0.1 * (1 - np.cos(np.pi / 16))
    assert finer.volume == pytest.approx(2 * np.pi, rel=0.004)


def test_what_would_cross_stays_flat() -> None:
    """Two shells that nearly touch: the inner one, curved, would come through the flat outer one."""
    inner = icosphere(1, 1.0)
    outer = Surface(inner.vertices * 1.02, inner.triangles)
    hollow = Surface(
        np.concatenate([outer.vertices, inner.vertices]),
        np.concatenate([outer.triangles, inner.triangles[:, ::-1] + len(outer.vertices)]),
    ).rounded()
    finer = subdivide(hollow, 1)
    assert not len(intersecting_triangles(finer))
    assert finer.volume > hollow.volume


@pytest.mark.parametrize("count", [-1, 6])
def test_bad_counts_are_refused(count: int) -> None:
    with pytest.raises(InputError, match=f"refine: {count} found, allowed are 0 to 5"):
        subdivide(cube(), count)


def test_too_many_triangles_are_refused() -> None:
    with pytest.raises(InputError, match=r"5 steps would make .* triangles"):
        subdivide(icosphere(6), 5)
