"""Every level keeps the topology, stays free of crossings and slivers, and lies near the input."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from quadgraph.base.errors import InputError
from quadgraph.mesh.intersections import intersecting_triangles
from quadgraph.mesh.local_mesh import LocalMesh
from quadgraph.mesh.lod import build_chain
from quadgraph.mesh.mesh_io import read_surface
from quadgraph.mesh.slivers import raise_angles
from quadgraph.mesh.surface import Surface
from quadgraph.tets.tetrahedralise import tetrahedralise
from shapes import cube, icosphere, join, moved, torus


def assert_valid(chain: list[Surface]) -> None:
    finest = chain[0]
    for fine, coarse in pairwise(chain):
        assert coarse.is_closed_manifold
        assert (coarse.genus, coarse.components) == (finest.genus, finest.components)
        assert 0.2 < len(coarse.vertices) / len(fine.vertices) < 0.55
        assert np.array_equal(coarse.vertices, coarse.vertices.astype(np.float32))
        assert len(intersecting_triangles(coarse)) == 0


@pytest.mark.parametrize(
    "surface",
    [icosphere(5, 50), torus(around=96, across=48), join(icosphere(4), moved(icosphere(4), 3, 0, 0))],
    ids=["sphere", "torus", "two spheres"],
)
def test_topology_is_kept(surface: Surface) -> None:
    chain = build_chain(surface, levels=3)
    assert len(chain) == 3
    assert chain[0] is surface
    assert_valid(chain)
    assert min(level.min_angle for level in chain[1:]) >= 12


def test_coarse_spheres_approach_the_fine_one_to_second_order() -> None:
    finest, *chain = build_chain(icosphere(6), levels=5)
    h = [1 / np.sqrt(len(level.vertices)) for level in chain]
    error = [1 - level.volume / finest.volume for level in chain]
    assert np.polyfit(np.log(h), np.log(error), 1)[0] > 1.8


def test_bunny(bunny: Surface) -> None:
    told: list[str] = []
    chain = build_chain(bunny, progress=told.append)
    assert len(chain) == 4
    assert 200 <= len(chain[-1].vertices) <= 800
    assert_valid(chain)
    assert min(level.min_angle for level in chain) >= 12
    assert len(told) == len(chain) - 1
    for level in chain[1:]:
        assert level.volume == pytest.approx(bunny.volume, rel=0.02)


@pytest.mark.parametrize("name", ["heptoroid", "fertility"])
def test_shared_meshes_of_high_genus(shared, name: str) -> None:
    chain = build_chain(read_surface(shared / "meshes" / f"{name}.ply", height_mm=100).surface.rounded())
    assert len(chain) >= 3
    assert chain.ended
    assert_valid(chain)
    assert min(level.min_angle for level in chain[1:]) >= 10
    coarsest = tetrahedralise(chain[-1])
    assert coarsest.volume == pytest.approx(chain[-1].volume, rel=1e-9)


def test_chain_ends_where_the_topology_forbids_more() -> None:
    chain = build_chain(cube(), levels=5)
    assert len(chain) < 5
    assert "no valid level" in chain.ended
    assert build_chain(cube()).ended == "the next level would have only 2 vertices"


@pytest.mark.parametrize("options", [{"levels": 0}, {"levels": 17}, {"min_angle_degrees": 60}])
def test_bad_options(options: dict) -> None:
    with pytest.raises(InputError, match="allowed"):
        build_chain(cube(), **options)


def test_slivers_are_removed_without_moving_the_surface() -> None:
    sphere = icosphere(4)
    rng = np.random.default_rng(3)
    pushed = sphere.vertices.copy()
    for a, b in sphere.topology.edges[rng.choice(len(sphere.topology.edges), 40, replace=False)]:
        pushed[a] = pushed[b] + 0.02 * (pushed[a] - pushed[b])
    thin = Surface(pushed, sphere.triangles)
    assert thin.min_angle < 2
    better = raise_angles(thin, 15)
    assert better.min_angle >= 15
    assert better.is_closed_manifold
    assert better.genus == 0
    radius = np.linalg.norm(better.corners.mean(axis=1), axis=1)
    assert radius.min() > 0.985
    assert radius.max() < 1.005


def test_collapse_respects_the_link_condition() -> None:
    # In a double pyramid over a triangle the equator's edges have a third common neighbour across the middle.
    vertices = np.array([[1, 0, 0], [-0.5, 0.8, 0], [-0.5, -0.8, 0], [0, 0, 1], [0, 0, -1.0]])
    top = [(0, 1, 3), (1, 2, 3), (2, 0, 3)]
    bottom = [(1, 0, 4), (2, 1, 4), (0, 2, 4)]
    mesh = LocalMesh(Surface(vertices, np.array(top + bottom)))
    assert mesh.collapse(0, 0, 0.5) is None
