"""Parts of the shortest-path method: paths against SciPy and closed forms, voxels against winding numbers."""

from __future__ import annotations

from itertools import product
from pathlib import Path

import numpy as np
import pytest
import trimesh
from scipy.ndimage import binary_dilation
from scipy.sparse import coo_array
from scipy.sparse.csgraph import dijkstra

from quadgraph.base.errors import InputError
from quadgraph.mesh import mesh_io
from quadgraph.mesh.surface import Surface
from shapes import cube, icosphere, join, moved, torus

_core = pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")

FAR = _core.PATH_FAR


def solve(cost: np.ndarray, entering: np.ndarray, cell: float, solver: str) -> np.ndarray:
    """Lengths (3, nz, ny, nx) on the device, with the validation layer; FAR is infinite."""
    found = _core.shortest_paths(cost, entering, cell, solver, validation=True).astype(np.float64)
    return np.where(found >= FAR, np.inf, found)


def same_channels(values: np.ndarray) -> np.ndarray:
    """One grid for all channels."""
    return np.broadcast_to(values, (3, *values.shape)).astype(np.float32)


def dijkstra_lengths(cost: np.ndarray, start: np.ndarray, cell: float) -> np.ndarray:
    """SciPy's, for one channel: edges to 26 neighbours at the mean cost, and one from a source to every start."""
    number = np.arange(cost.size).reshape(cost.shape)
    rows, columns, weights = [], [], []
    for step in product((-1, 0, 1), repeat=3):
        if step == (0, 0, 0):
            continue
        here = tuple(slice(max(0, -s), n - max(0, s)) for s, n in zip(step, cost.shape, strict=True))
        there = tuple(slice(max(0, s), n - max(0, -s)) for s, n in zip(step, cost.shape, strict=True))
        both = (cost[here] >= 0) & (cost[there] >= 0)
        rows.append(number[here][both])
        columns.append(number[there][both])
        weights.append(((cost[here] + cost[there]) / 2 * cell * np.linalg.norm(step))[both])
    lit = np.flatnonzero(np.isfinite(start))
    rows.append(np.full(len(lit), cost.size))
    columns.append(lit)
    weights.append(start.ravel()[lit])
    edges = (np.concatenate(weights), (np.concatenate(rows), np.concatenate(columns)))
    graph = coo_array(edges, (cost.size + 1, cost.size + 1)).tocsr()
    return dijkstra(graph, indices=cost.size)[: cost.size].reshape(cost.shape)


@pytest.mark.parametrize("size", [(24, 16, 32), (8, 48, 16)])
def test_lattice_is_dijkstra(size):
    random = np.random.default_rng(3)
    cost = np.exp(random.uniform(-3, 3, (3, *size))).astype(np.float32)
    cost[:, random.random(size) < 0.35] = -1
    cost[:, :, :, 11] = -1  # a wall, and no light behind it
    entering = np.where((random.random((3, *size)) < 0.01) & (cost >= 0), random.uniform(0.01, 9, (3, *size)), 0)
    entering[..., 12:] = 0
    found = solve(cost, entering, 0.4, "lattice")
    for channel in range(3):
        with np.errstate(divide="ignore"):
            # Above 0, as SciPy wants its edges; what is added to all starts changes no path.
            start = 10 - np.log(entering[channel].astype(np.float32).astype(np.float64))
        expected = dijkstra_lengths(cost[channel].astype(np.float64), start, np.float32(0.4)) - 10
        reached = np.isfinite(expected)
        assert np.array_equal(np.isfinite(found[channel]), reached)
        assert np.allclose(found[channel][reached], expected[reached], rtol=2e-6, atol=2e-5)
        assert reached[..., :11].any()
        assert not reached[..., 11:].any()


def test_device_follows_the_reference():
    random = np.random.default_rng(5)
    cost = np.exp(random.uniform(-1, 1, (3, 16, 24, 16))).astype(np.float32)
    cost[:, :, 11, :13] = -1
    entering = np.where((random.random(cost.shape) < 0.02) & (cost >= 0), 1.0, 0)
    for solver in ("eikonal", "lattice"):
        start = np.where(entering > 0, 0, FAR)
        expected = _core.shortest_paths_reference(cost, start, 0.3, solver)
        assert np.allclose(solve(cost, entering, 0.3, solver)[cost >= 0], expected[cost >= 0], rtol=2e-6, atol=1e-5)


def cube_middles(count: int) -> np.ndarray:
    """Middles (n, n, n, 3) as x, y, z of the cells of a cube of edge 1 about cell n / 2."""
    axis = (np.arange(count) - count // 2) / count
    return np.stack(np.meshgrid(axis, axis, axis, indexing="ij"), axis=-1)[..., ::-1]


def from_a_point(count: int, solver: str) -> np.ndarray:
    """Errors of the lengths from the middle cell, cost 1."""
    cost, entering = np.ones((count,) * 3), np.zeros((count,) * 3)
    entering[(count // 2,) * 3] = 1
    found = solve(same_channels(cost), same_channels(entering), 1 / count, solver)
    assert np.array_equal(found[0], found[1])
    return found[0] - np.linalg.norm(cube_middles(count), axis=-1)


def test_error_of_the_eikonal_falls_with_resolution_and_that_of_the_lattice_does_not():
    sizes = (8, 16, 32)
    eikonal, lattice = (
        [np.sqrt((from_a_point(count, solver) ** 2).mean()) for count in sizes] for solver in ("eikonal", "lattice")
    )
    order = -np.polyfit(np.log(sizes), np.log(eikonal), 1)[0]
    print("eikonal", eikonal, "order", order, "lattice", lattice)
    assert order > 0.5
    assert lattice[-1] > 0.95 * lattice[0]
    assert eikonal[-1] < 0.25 * lattice[-1]


def test_lattice_is_up_to_13_percent_too_long():
    count = 32
    distance = np.linalg.norm(cube_middles(count), axis=-1)
    far = distance > 0.2
    ratio = 1 + from_a_point(count, "lattice")[far] / distance[far]
    assert 1.12 < ratio.max() < 1.13
    assert ratio.min() > 1 - 1e-5


@pytest.mark.parametrize("way", [(1, 0.3, 0.7), (0.2, 1, -0.1), (-0.5, -0.4, 1)])
def test_plane_fronts_are_exact_in_every_direction(way):
    count = 24
    depth = cube_middles(count) @ (np.array(way) / np.linalg.norm(way))
    lit = np.abs(depth + 0.2) < 2 / count
    entering = np.where(lit, np.exp(-2 * depth), 0)
    found = solve(same_channels(np.full((count,) * 3, 2.0)), same_channels(entering), 1 / count, "eikonal")[0]
    # Where all that arrives has come straight from the lit cells.
    inside = np.linalg.norm(cube_middles(count), axis=-1) < 0.2
    assert np.abs(found - 2 * depth)[inside & (depth > -0.1)].max() < 1e-6


def test_symmetric_light_gives_symmetric_lengths():
    random = np.random.default_rng(1)
    half = np.exp(random.uniform(-1, 1, (16, 24, 8)))
    cost = np.concatenate([half, half[..., ::-1]], axis=2)
    entering = np.zeros_like(cost)
    entering[3, 5, [2, 13]] = 1
    for solver in ("eikonal", "lattice"):
        found = solve(same_channels(cost), same_channels(entering), 0.1, solver)
        assert np.array_equal(found, found[..., ::-1])


def test_wrong_grids_are_refused():
    fine = np.ones((3, 8, 8, 8), np.float32)
    with pytest.raises(InputError, match="multiple of 8"):
        _core.shortest_paths(np.ones((3, 8, 8, 9)), np.ones((3, 8, 8, 9)), 1.0)
    with pytest.raises(InputError, match="1536 costs and 3072 lights"):
        _core.shortest_paths(fine, np.concatenate([fine, fine], axis=1), 1.0)
    with pytest.raises(InputError, match="path solver 'x': allowed are eikonal, lattice"):
        _core.shortest_paths(fine, fine, 1.0, "x")
    with pytest.raises(InputError, match="path cells: found 1000, allowed are 8 to 150"):
        _core.voxels(cube().vertices, cube().triangles, 1000)
    with pytest.raises(InputError, match="vertex 12 is not there"):
        _core.voxels(cube().vertices, [[0, 1, 12]], 16)


def voxels(surface: Surface, cells: int) -> tuple[np.ndarray, np.ndarray, float]:
    """Flags (nz, ny, nx), middles (nz, ny, nx, 3) in mm and side of the cells, with the validation layer."""
    found = _core.voxels(surface.vertices, surface.triangles, cells, validation=True)
    flags = found["flags"]
    z, y, x = (np.arange(n) + 0.5 for n in flags.shape)
    middles = np.stack(np.meshgrid(z, y, x, indexing="ij"), axis=-1)[..., ::-1] * found["cell"] + found["origin"]
    return flags, middles, found["cell"]


def winding_numbers(surface: Surface, points: np.ndarray) -> np.ndarray:
    """(n,), by solid angles (Jacobson et al. 2013; van Oosterom and Strackee 1983)."""
    numbers = []
    for part in np.array_split(points, max(1, len(points) * len(surface.triangles) // 500_000)):
        a, b, c = (surface.vertices[surface.triangles[:, k]] - part[:, None] for k in range(3))
        la, lb, lc = (np.linalg.norm(v, axis=2) for v in (a, b, c))
        volume = (a * np.cross(b, c)).sum(axis=2)
        rest = la * lb * lc + (a * b).sum(axis=2) * lc + (b * c).sum(axis=2) * la + (c * a).sum(axis=2) * lb
        numbers.append(np.arctan2(volume, rest).sum(axis=1) / (2 * np.pi))
    return np.concatenate(numbers)


def differing(surface: Surface, cells: int, most: int = 500) -> tuple[float, float]:
    """Among at most `most` cells farther than one from the surface, the share solid though outside, or the other
    way round, and the share that no winding number decides (open surfaces have such around their holes).
    """
    flags, middles, _ = voxels(surface, cells)
    crossed = (flags & _core.CELL_SURFACE) != 0
    away = np.flatnonzero(~binary_dilation(crossed, np.ones((3, 3, 3))).ravel())
    away = np.random.default_rng(0).permutation(away)[:most]
    numbers = np.abs(winding_numbers(surface, middles.reshape(-1, 3)[away]))
    decided = np.abs(numbers - 0.5) > 0.25
    solid = (flags.ravel()[away] & _core.CELL_SOLID) != 0
    return float((decided & (solid != (numbers > 0.5))).mean()), float((~decided).mean())


def without(surface: Surface, chosen: np.ndarray) -> Surface:
    """Without those triangles."""
    return Surface(surface.vertices, surface.triangles[~chosen])


def assert_inside(shares: tuple[float, float], undecided: float) -> None:
    """Nothing is wrong, and little undecided."""
    assert shares[0] == 0
    assert shares[1] < undecided


def test_volume_of_closed_bodies_is_within_a_layer_of_cells():
    for surface in (icosphere(3, 10.0), cube(7.0), torus()):
        mesh = trimesh.Trimesh(surface.vertices, surface.triangles)
        for cells in (16, 48):
            flags, _, cell = voxels(surface, cells)
            solid = ((flags & _core.CELL_SOLID) != 0).sum() * cell**3
            inside = ((flags & _core.CELL_INSIDE) != 0).sum() * cell**3
            assert abs(solid - mesh.volume) < mesh.area * cell
            assert abs(inside - mesh.volume) < 0.2 * mesh.area * cell
        assert differing(surface, 32) == (0, 0)


def test_bad_meshes_have_an_inside():
    sphere, random = icosphere(3, 10.0), np.random.default_rng(2)
    cap = sphere.vertices[sphere.triangles].mean(axis=1)[:, 2] > 8
    turned = sphere.triangles.copy()
    some = random.random(len(turned)) < 0.3
    turned[some] = turned[some][:, ::-1]
    fin = Surface(np.array([[0, 0, 5.0], [14, 0, 0], [0, 2, -5]]), np.array([[0, 1, 2]]))
    assert_inside(differing(without(sphere, cap), 32), 0.05)
    assert differing(join(sphere, moved(sphere, 8, 3, 0)), 32) == (0, 0)  # crosses itself
    assert_inside(differing(join(sphere, fin), 32), 0.02)  # open and not manifold
    assert differing(join(sphere, Surface(0.5 * sphere.vertices, sphere.triangles[:, ::-1])), 32) == (0, 0)
    assert_inside(differing(without(sphere, random.random(len(sphere.triangles)) < 0.02), 32), 0.02)  # torn
    # Triangles that do not agree on which side is out have no winding number; the sphere is there all the same.
    flags, middles, cell = voxels(Surface(sphere.vertices, turned), 32)
    radius = np.linalg.norm(middles, axis=-1)
    solid = (flags & _core.CELL_SOLID) != 0
    assert solid[radius < 10 - 2 * cell].all()
    assert not solid[radius > 10 + 2 * cell].any()


def test_sheets_are_not_lost():
    sheet = Surface(np.array([[0, 0, 0], [10, 0, 1], [10, 10, 3], [0, 10, 2.0]]), np.array([[0, 1, 2], [0, 2, 3]]))
    flags, _, cell = voxels(sheet, 40)
    solid = (flags & _core.CELL_SOLID) != 0
    columns = solid.any(axis=0)
    assert columns.sum() * cell**2 == pytest.approx(100, rel=0.06)
    assert solid.sum() < 2 * columns.sum()


def test_half_a_cell_is_no_matter_of_chance():
    # A cube whose faces lie in the middles of cells: exactly one side of each counts.
    for cells in (16, 24):
        flags, _, _ = voxels(cube(7.0), cells)
        assert ((flags & _core.CELL_INSIDE) != 0).sum() in ((cells - 1) ** 3, cells**3, (cells + 1) ** 3)


@pytest.mark.parametrize("name", ["beetle", "bunny-open", "dragon-res3", "suzanne", "teapot"])
def test_bad_meshes_of_the_world(shared: Path, name: str):
    surface = mesh_io.read_surface(shared / "meshes" / "bad" / f"{name}.ply", height_mm=100).surface
    wrong, undecided = differing(surface, 32, 2_500_000 // len(surface.triangles))
    print(f"{name}: of the cells away from the surface {wrong:.2%} differ, {undecided:.2%} have no winding number")
    assert wrong < 0.03
