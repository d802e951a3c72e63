"""Polygrids: polycubes, links, where nodes lie, the weights of Appendix B, and a file that is baked of one."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import trimesh

import grids
from grids import RADIUS
from quadgraph import cli
from quadgraph.baking import pipeline
from quadgraph.base.errors import InputError, ToolError
from quadgraph.file import qgraph_file
from quadgraph.mesh.surface import Surface, TetMesh
from quadgraph.tets.graph import Graph
from quadgraph.tets.polygrid import build, grid_report, lattice, placement, polycube, weights
from quadgraph.tets.polygrid.lattice import MISSING
from quadgraph.tets.tet_geometry import determinants
from quadgraph_validation.truth import polygrid_diffusion
from shapes import icosphere


def random_polycube(seed: int) -> np.ndarray:
    generator = np.random.default_rng(seed)
    shares = generator.random((5, 5, 5))
    return polycube.manifold(shares > 0.5, shares)


def surface_of(mesh: trimesh.Trimesh) -> Surface:
    return Surface(np.array(mesh.vertices, np.float64), np.array(mesh.faces, np.int64))


def torus() -> Surface:
    return surface_of(trimesh.creation.torus(major_radius=20, minor_radius=8, major_sections=48, minor_sections=24))


@pytest.mark.parametrize("seed", range(6))
def test_filled_cubes_have_a_manifold_surface_whose_topology_is_told(seed):
    solid = random_polycube(seed)
    corners = lattice.build(solid, 2)
    surface = TetMesh(corners.positions, corners.tets).boundary().compacted()
    assert surface.is_closed_manifold
    assert polycube.topology(solid) == (surface.components, surface.genus)


def test_polycubes_keep_pieces_and_handles():
    two = trimesh.util.concatenate(
        [trimesh.creation.icosphere(radius=8).apply_translation([x, 0, 0]) for x in (-15, 15)]
    )
    for surface, expected in ((icosphere(3, 10), (1, 0)), (torus(), (1, 1)), (surface_of(two), (2, 0))):
        assert polycube.topology(polycube.build(surface).solid) == expected


def test_thin_parts_are_reached():
    """A ball with a pin that is a third of a cube thick: half-full cubes alone would end at the ball."""
    angle = np.linspace(0, np.pi - np.arcsin(0.08), 40)
    arc = 10 * np.stack([np.sin(angle), -np.cos(angle)], axis=1)
    body = surface_of(trimesh.creation.revolve(np.concatenate([arc, [[0.8, 25.0], [0.0, 25.0]]])))
    assert body.is_closed_manifold
    assert body.volume > 0
    cube = polycube.build(body, 8)
    highest = cube.origin[2] + cube.edge * (np.flatnonzero(cube.solid.any(axis=(0, 1))).max() + 1)
    assert highest > 25 - cube.edge


def test_no_polycube_is_made_of_what_no_lattice_shows():
    ring = trimesh.creation.torus(major_radius=20, minor_radius=0.3, major_sections=64, minor_sections=12)
    with pytest.raises(ToolError, match="1 pieces and 1 handles"):
        polycube.build(surface_of(ring), 4)
    for cubes in (1, 33):
        with pytest.raises(InputError, match="cubes"):
            polycube.build(icosphere(2, 1), cubes)


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("cells", [2, 4])
def test_every_node_has_its_links(seed, cells):
    grid = lattice.build(random_polycube(seed), cells)
    sides = np.zeros(grid.interior, int)
    sides[grid.owners] = np.abs(grid.outward).sum(axis=1)
    # Each boundary node has one interior neighbour, each interior node at most one boundary node.
    outside = grid.links >= grid.interior
    assert np.array_equal(np.sort(grid.links[outside]), np.arange(grid.interior, grid.nodes))
    assert outside.sum(axis=1).max() == 1
    row, _ = np.nonzero(outside)
    assert np.array_equal(row[np.argsort(grid.links[outside])], grid.owners)
    # Six links, but for the last of those under a corner.
    missing = grid.links == MISSING
    assert np.array_equal(missing.any(axis=1), sides == 3)
    assert missing[:, :5].sum() == 0
    for links in grid.links[:: max(1, grid.interior // 50)]:
        assert len(set(links[links != MISSING])) == (links != MISSING).sum()
    # Links go both ways, except those across an inner edge or corner.
    pairs = {(i, int(j)) for i in range(grid.interior) for j in grid.links[i] if 0 <= j < grid.interior}
    one_way = [(i, j) for i, j in pairs if (j, i) not in pairs]
    assert set(sides[[i for i, _ in one_way]]) <= {2, 3}
    if cells > 2:  # else the cells across a cube's inner corner are corners themselves
        assert sorted(i for i, _ in one_way) == np.flatnonzero(sides > 1).tolist()


@pytest.mark.parametrize("seed", range(4))
def test_tets_fill_the_polycube(seed):
    solid = random_polycube(seed)
    grid = lattice.build(solid, 4)
    mesh = TetMesh(grid.positions, grid.tets)
    assert np.array_equal(np.unique(grid.tets), np.arange(grid.nodes))
    assert (mesh.tets[:, :1] < grid.interior).all()
    # Edges and corners where faces turn in or out are cut, so that the volume is not quite that of the cells.
    assert mesh.volume == pytest.approx(solid.sum() * 4**3, rel=0.03)


def affine(points: np.ndarray) -> np.ndarray:
    return 2.0 + points @ np.array([0.3, -1.1, 0.7])


def ball(cells: int) -> Graph:
    """One cube blown up to a ball, placed as the paper does."""
    return grids.balls(cells)[0]


def shaken(amount: float) -> Graph:
    """The ball of 4^3 cells with its inner nodes moved at random by up to `amount` mm."""
    graph = ball(4)
    vertices = graph.vertices.copy()
    deep = build.layers(graph) > 1
    vertices[deep] += amount * np.random.default_rng(1).uniform(-1, 1, (int(deep.sum()), 3))
    return replace(graph, vertices=vertices)


def test_weights_are_exact_on_linear_fields_and_on_squares_along_the_links():
    graph = shaken(0.3)
    offsets = grid_report.offsets(graph)
    weight, straight = weights.laplacian(offsets)
    assert straight.mean() < 0.1
    change = affine(graph.vertices[graph.grid_links]) - affine(graph.vertices[graph.surface_vertex_count :])[:, None]
    assert np.abs((weight * change).sum(axis=1))[~straight].max() < 1e-10
    local = np.einsum("ijk,ikl->ijl", offsets, weights.frames(offsets))
    squares = np.einsum("ij,ijk->ik", weight, local**2)
    whole = ~straight & offsets[:, 5].any(axis=1)
    assert np.allclose(squares[whole], 2)
    corner = ~straight & ~offsets[:, 5].any(axis=1)
    assert corner.sum() == 8
    assert np.allclose(squares[corner].sum(axis=1), 6)


def test_weights_are_never_negative():
    for amount, some in ((0.0, False), (1.5, True)):
        weight, straight = weights.laplacian(grid_report.offsets(shaken(amount)))
        assert (weight >= 0).all()
        assert (weight[:, :5] > 0).all()
        assert straight.any() == some


def test_a_regular_grid_has_the_weights_of_the_seven_point_stencil():
    grid = lattice.build(np.ones((1, 1, 1), bool), 6)
    graph = build.as_graph(grid, grid.positions)
    inside = build.layers(graph)[graph.surface_vertex_count :] > 2
    assert np.allclose(weights.laplacian(grid_report.offsets(graph))[0][inside], 1.0)


def test_nodes_lie_where_the_paper_puts_them():
    graph = ball(4)
    first, inner = graph.surface_vertex_count, polygrid_diffusion.neighbours(graph)
    surface = graph.vertices[:first]
    assert np.allclose(np.linalg.norm(surface, axis=1), RADIUS, rtol=1e-6)
    depth = RADIUS - np.linalg.norm(graph.vertices[inner], axis=1)
    assert np.allclose(graph.vertices[inner] / np.linalg.norm(graph.vertices[inner], axis=1)[:, None], surface / RADIUS)
    edges = np.unique(np.sort(graph.faces[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1), axis=0)
    spacing = np.linalg.norm(surface[edges[:, 0]] - surface[edges[:, 1]], axis=1)
    assert depth.max() < placement.PARTNER_SHARE * spacing.max()
    assert depth.min() > placement.PARTNER_SHARE * spacing.min()
    # Nodes of one kind under the cube's symmetry are equally deep.
    assert len(np.unique(depth.round(4))) <= 4


def test_links_of_even_length_are_what_placement_is_for():
    grid = lattice.build(np.ones((1, 1, 1), bool), 8)
    start = grid.positions + 0.3 * np.random.default_rng(3).uniform(-1, 1, (grid.nodes, 3))

    def variance(positions: np.ndarray) -> float:
        links = np.where(grid.links == MISSING, np.arange(grid.interior)[:, None], grid.links)
        length = np.linalg.norm(positions[links] - positions[: grid.interior, None], axis=2)
        return float(np.ma.masked_equal(length, 0).var(axis=1).sum())

    fixed = np.zeros(grid.nodes, bool)
    fixed[grid.interior :] = fixed[grid.owners] = True
    found = placement.least_variance(grid, start, fixed)
    assert np.array_equal(found[fixed], start[fixed])
    middles = placement.least_variance(grid, start, fixed, steps=0)
    assert variance(found) < 0.9 * variance(middles) < 0.9 * variance(start)


def test_a_uniform_field_stays_what_it_is():
    """The furnace: no absorption, uniform light; also where kappa varies, in the divergence form alone."""
    graph = ball(4)
    count, first = len(graph.vertices), graph.surface_vertex_count
    even = polygrid_diffusion.solve(
        graph, np.full(count, 0.4), np.zeros(count), 0.25, np.full(first, 0.25), published=True
    )
    assert np.allclose(even, 1)
    kappa = 0.2 + 0.3 * (graph.vertices[:, 0] > 0)
    assert np.allclose(polygrid_diffusion.solve(graph, kappa, np.zeros(count), 0.25, np.full(first, 0.25)), 1)
    published = polygrid_diffusion.solve(graph, kappa, np.zeros(count), 0.25, np.full(first, 0.25), published=True)
    assert np.abs(published - 1).max() > 0.1


def test_linear_fields_are_solved_exactly():
    graph = ball(4)
    assert not weights.laplacian(grid_report.offsets(graph))[1].any()
    count, first, inner = len(graph.vertices), graph.surface_vertex_count, polygrid_diffusion.neighbours(graph)
    exact = affine(graph.vertices)
    slope = (exact[:first] - exact[inner]) / np.linalg.norm(graph.vertices[:first] - graph.vertices[inner], axis=1)
    load = 0.4 * slope + 0.25 * exact[:first]
    for published in (False, True):
        found = polygrid_diffusion.solve(graph, np.full(count, 0.4), np.zeros(count), 0.25, load, published)
        assert np.allclose(found, exact, atol=1e-8)


def errors_by_cells(graphs: list[Graph], radius: float) -> np.ndarray:
    """Relative RMS errors (n, 2), over all nodes and over those deeper than half the body, of u = exp(r a x), which
    solves kappa lap u = sigma_a u, with its own flux through the boundary nodes' links as the load.
    """
    kappa, sigma_a, outflow, axis = 0.5, 0.005, 0.25, np.array([0.6, 0.64, 0.48])
    rate = np.sqrt(sigma_a / kappa)
    errors = []
    for graph in graphs:
        count, first = len(graph.vertices), graph.surface_vertex_count
        exact = np.exp(rate * graph.vertices @ axis)
        outward = graph.vertices[:first] - graph.vertices[polygrid_diffusion.neighbours(graph)]
        outward /= np.linalg.norm(outward, axis=1, keepdims=True)
        load = kappa * rate * exact[:first] * (outward @ axis) + outflow * exact[:first]
        found = polygrid_diffusion.solve(
            graph, np.full(count, kappa), np.full(count, sigma_a), outflow, load, published=True
        )
        parts = np.ones(count, bool), np.abs(graph.vertices).max(axis=1) < radius / 2
        errors.append([np.linalg.norm((found - exact)[part]) / np.linalg.norm(exact[part]) for part in parts])
    return np.array(errors)


def order(errors: np.ndarray) -> np.ndarray:
    """Order of convergence, where every step halves the cells."""
    return -np.polyfit(np.arange(len(errors)), np.log2(errors), 1)[0]


def test_a_box_converges_and_a_mapped_ball_does_not():
    """Straight links: first order, second away from the edges. Skewed ones leave out mixed derivatives: no order."""
    boxes = []
    for cells in (4, 8, 16):
        grid = grids.one_cube(cells)
        low, high = grid.positions.min(axis=0), grid.positions.max(axis=0)
        boxes.append(build.as_graph(grid, RADIUS * (2 * (grid.positions - low) / (high - low) - 1)))
    box, mapped = (errors_by_cells(graphs, RADIUS) for graphs in (boxes, [ball(4), ball(8)]))
    print(f"errors: box {box.tolist()}, ball {mapped.tolist()}; orders: {order(box)}, {order(mapped)}")
    assert order(box)[0] > 1
    assert order(box)[1] > 1.7
    assert order(mapped).max() < 0.5
    assert mapped.max() < 0.05


def test_a_slab_against_its_closed_form():
    """Light on one side of a plate three times as wide as thick, in its middle: first order, as the boundary's rows."""
    thickness, kappa, sigma_a, outflow, load = 10.0, 0.5, 0.08, 0.25, 0.25
    rate = np.sqrt(sigma_a / kappa)
    even, odd = np.cosh(rate * thickness), np.sinh(rate * thickness)
    rows = [[outflow, -kappa * rate], [kappa * rate * odd + outflow * even, kappa * rate * even + outflow * odd]]
    share = np.linalg.solve(rows, [0, load])
    errors = []
    for cells in (2, 4, 8):
        grid = lattice.build(np.ones((3, 3, 1), bool), cells)
        positions = thickness / cells * (grid.positions - grid.positions.min(axis=0))
        graph = build.as_graph(grid, positions - [1.5 * thickness, 1.5 * thickness, 0])
        height, count = graph.vertices[:, 2], len(graph.vertices)
        lit = np.where(height[: graph.surface_vertex_count] > 0.999 * thickness, load, 0)
        found = polygrid_diffusion.solve(
            graph, np.full(count, kappa), np.full(count, sigma_a), outflow, lit, published=True
        )
        exact = share[0] * np.cosh(rate * height) + share[1] * np.sinh(rate * height)
        middle = np.abs(graph.vertices[:, :2]).max(axis=1) < thickness / 2
        errors.append(np.linalg.norm((found - exact)[middle]) / np.linalg.norm(exact[middle]))
    print(f"errors: {errors}, order {order(np.array(errors)):.2f}")
    assert errors[-1] < 0.05
    assert order(np.array(errors)) > 0.85


@pytest.fixture(scope="module")
def baked(tmp_path_factory) -> tuple[pipeline.BakeReport, qgraph_file.QGraphFile]:
    folder: Path = tmp_path_factory.mktemp("polygrid")
    mesh = icosphere(3, RADIUS)
    trimesh.Trimesh(mesh.vertices, mesh.triangles, process=False).export(folder / "ball.obj", digits=9)
    options = pipeline.BakeOptions(unit="mm", mesher="polygrid", cubes=2, cells=4)
    report = pipeline.bake(folder / "ball.obj", folder / "ball.qgraph", options)
    return report, qgraph_file.read(folder / "ball.qgraph")


def test_a_baked_polygrid_is_a_file_like_any_other(baked):
    report, file = baked
    assert file.level_count == 2
    assert file.metadata["mesher"]["name"] == "polygrid"
    assert file.metadata["polygrid"] == report.polygrid
    assert file.metadata["levels"][0]["volume_mm3"] == pytest.approx(4 / 3 * np.pi * RADIUS**3, rel=0.05)
    assert report.polygrid["uncovered"] == 0
    assert report.polygrid["cubes"] == 8
    vertices, tets = file.sections["level0/vertices"], file.sections["level0/tets"]
    assert determinants(vertices, tets).min() > 0


def test_options_that_do_not_belong_together_are_refused(tmp_path):
    mesh = tmp_path / "ball.obj"
    mesh.write_text("v 0 0 0\n")
    for options, message in (
        ({"mesher": "polygrid", "surface_vertices": 100}, "surface_vertices"),
        ({"mesher": "polygrid", "grading": 1.0}, "grading"),
        ({"cubes": 4}, "cubes"),
        ({"cells": 4}, "cells"),
    ):
        with pytest.raises(InputError, match=message):
            pipeline.bake(mesh, tmp_path / "out.qgraph", pipeline.BakeOptions(unit="mm", **options))
    with pytest.raises(InputError, match="cells: 3"):
        build.build(icosphere(2, 1), cells=3)


def test_the_table_has_ours_below_the_papers_rows(tmp_path, capsys):
    cold = {"light": 10.0, "solve": 60.0, "picture": 30.0, "work": 9.0}
    found = {
        "body": "donut",
        "cubes": 72,
        "cells": 4,
        "nodes": 6600,
        "megabytes": 5.0,
        "cold": cold,
        "coherent": cold | {"solve": 10.0, "work": 6.0},
        "curves": {
            "plain": [(1, 0.5), (2, 0.1)],
            "hierarchical": [(1, 0.1), (2, 0.004)],
            "adaptive": [(0.5, 0.004)],
        },
    }
    record = tmp_path / "record.json"
    record.write_text(json.dumps({"Hole": found}))
    assert cli.main(["polygrid", "--from", str(record), "--chart", str(tmp_path / "curves.png")]) == 0
    lines = capsys.readouterr().out.splitlines()
    published = next(i for i, line in enumerate(lines) if line.startswith("| Hole, published | 36 x 12³ | 62 |"))
    assert lines[published + 1] == "| donut | 72 x 4³ | 6.6 | 5 | 10 / 60 / 30 | 10.0 | 20.0 | 2.00 | 1.50 |"
    assert lines[-1] == "| Hole | never | 2 | 0 |"
    assert (tmp_path / "curves.png").stat().st_size > 5000
    assert cli.main(["polygrid", "--body", "teapot"]) == 1
    assert "bunny" in capsys.readouterr().err
