"""Coefficients as a function of position: at the tets or on a grid, and what is refused."""

from __future__ import annotations

import numpy as np
import pytest

import quadgraph
from baked import write_levels
from quadgraph import core
from quadgraph.base.errors import InputError
from quadgraph.mesh.subdivide import subdivide
from quadgraph.mesh.surface import Surface
from shapes import cube

BOX = (np.array([-8.0, -4, -4]), np.array([8.0, 4, 4]))
SUN = quadgraph.DirectionalLight(direction=(0, 0, -1), irradiance=1)
VolumeMaterial = quadgraph.VolumeMaterial


@pytest.fixture(scope="module")
def block(tmp_path_factory):
    """A block of 16 x 8 x 8 mm about the origin, in two levels."""
    levels = [subdivide(cube(8), steps) for steps in (3, 2)]
    surfaces = [Surface(each.vertices * (2, 1, 1), each.triangles) for each in levels]
    return write_levels(tmp_path_factory.mktemp("bodies") / "block.qgraph", surfaces)


@pytest.fixture
def engine(block):
    with quadgraph.Engine(block) as made:
        made.lights = [SUN]
        yield made


def linear(points):
    """Both grow along the block, absorption in each channel at its own pace."""
    x = points[:, 0]
    return 1 + 0.05 * (x + 8), 0.02 * (x[:, None] + 9) * np.array([1, 2, 3])


def halves(points):
    """Little absorption in one half, ten times as much in the other."""
    return 2, np.where(points[:, 0] < 0, 0.02, 0.2)


def of_tets(engine) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Middles of the tets at rest and their coefficients, after a solve that ends soon."""
    engine.solve(cycles=1, correction=False)
    _, scattering, absorption = core.solved_tets(engine._engine)
    return np.array(engine._engine.graph.levels[0].nodes)[: len(absorption)], scattering, absorption


def test_a_linear_function_is_exact_on_a_grid(engine):
    engine.material = VolumeMaterial.from_function(linear, engine.box, spacing=(3, 2.5, 5))
    points, *found = of_tets(engine)
    scattering, absorption = linear(points)
    assert found[0] == pytest.approx(np.repeat(scattering[:, None], 3, axis=1), rel=1e-5)
    assert found[1] == pytest.approx(absorption, rel=1e-5)


def test_a_step_is_smeared_over_one_spacing(engine):
    spacing = 0.5
    engine.material = VolumeMaterial.from_function(halves, engine.box, spacing)
    points, _, absorption = of_tets(engine)
    far = np.abs(points[:, 0]) > spacing
    assert far.mean() > 0.5
    assert absorption[far] == pytest.approx(np.repeat(halves(points[far])[1][:, None], 3, axis=1), rel=1e-5)
    assert (absorption > 0.0199).all()
    assert (absorption < 0.2001).all()


def test_each_half_absorbs_as_the_whole_of_its_material_would(engine):
    """Light spreads by 2.9 and by 0.9 mm, 1 / sqrt(3 sigma_a sigma_t'): far ends know little of the other half."""
    pytest.importorskip("meshio")

    def absorbed_beyond(x: float) -> float:
        """W that fluence leaves where the side of x is farther than x, of the first channel."""
        engine.solve(method="fem", tolerance=1e-5, correction=False)
        mesh = engine.to_meshio()
        corners = mesh.points[mesh.cells[0].data].astype(float)
        volume = np.linalg.det(corners[:, 1:] - corners[:, :1]) / 6
        there = np.sign(x) * corners.mean(axis=1)[:, 0] > abs(x)
        power = mesh.cell_data["sigma_a"][0][:, 0] * mesh.cell_data["fluence"][0][:, 0] * volume
        return float(power[there].sum())

    engine.material = VolumeMaterial.from_function(halves, engine.box, 0.25)
    mixed = absorbed_beyond(-5), absorbed_beyond(5)
    engine.material = quadgraph.Material(2, 0.02)
    assert mixed[0] == pytest.approx(absorbed_beyond(-5), rel=0.1)
    engine.material = quadgraph.Material(2, 0.2)
    assert mixed[1] == pytest.approx(absorbed_beyond(5), rel=0.02)
    assert mixed[1] > 2 * mixed[0]


def test_on_a_grid_and_at_the_tets_it_is_the_same_body(engine):
    engine.material = VolumeMaterial.from_function(linear, engine.box, 2)
    on_grid = engine.solve(correction=False).energy.absorbed
    engine.set_coefficients(linear)
    assert engine.solve(correction=False).energy.absorbed == pytest.approx(on_grid, rel=1e-4)


def test_a_grid_of_a_function_serves_files_and_shortest_paths(engine, tmp_path):
    material = VolumeMaterial.from_function(linear, engine.box, 2)
    material.save(tmp_path / "grid.npz")
    engine.material = material
    expected = engine.solve(correction=False).energy.absorbed
    engine.material = str(tmp_path / "grid.npz")
    assert engine.solve(correction=False).energy.absorbed == pytest.approx(expected, rel=1e-6)
    assert engine.solve(method="shortest-path", path={"cells": 16}).path.solid > 0


@pytest.mark.parametrize(
    "returned",
    [
        lambda points: (2, 0.1),
        lambda points: (np.full(len(points), 2), np.full((len(points), 1), 0.1)),
        lambda points: [[2, 2, 2], np.full((len(points), 3), 0.1)],
    ],
)
def test_numbers_rows_and_channels_do(engine, returned):
    """Whatever of these shapes a function returns, it is the same material."""
    grid = VolumeMaterial.from_function(returned, BOX, 4)
    assert np.shape(grid.sigma_a) == (3, 3, 5, 3)
    assert (grid.sigma_s_prime == 2).all()
    assert (grid.sigma_a == np.float32(0.1)).all()
    assert grid.origin == (-8, -4, -4)
    engine.set_coefficients(returned)
    assert (of_tets(engine)[2] == np.float32(0.1)).all()


def test_rows_of_three_points_are_no_channels():
    grid = VolumeMaterial.from_function(lambda points: (1, points[:, 2]), ([0, 0, 1], [0, 0, 3]), 1)
    assert (grid.sigma_a[:, 0, 0] == [[1, 1, 1], [2, 2, 2], [3, 3, 3]]).all()


@pytest.mark.parametrize(
    ("returned", "said"),
    [
        (lambda p: 1.0, "float found, two are wanted: sigma_s_prime, sigma_a"),
        (lambda p: None, "nothing found, two are wanted"),
        (lambda p: (1, 1, 1), "3 values found, two are wanted"),
        (lambda p: (p[:, :2], 1), r"sigma_s_prime of the function: shape \(\d+, 2\) found; one number, \(\d+,\)"),
        (lambda p: (1, p[1:, 0]), r"sigma_a of the function: shape \(\d+,\) found"),
        (lambda p: (1, "clear"), "sigma_a of the function: .* found, numbers are wanted"),
        (lambda p: (1, [[1, 2], [3]]), "sigma_a of the function: rows of several lengths"),
        (lambda p: (1, np.where(p[:, 0] > 7, np.nan, 1)), r"sigma_a of the function: nan found at \((7|8).* mm"),
        (
            lambda p: (np.where(p[:, 1] < 0, -2.5, 1), 1),
            r"sigma_s_prime of the function: -2.5 found at \(.*, -.*, .*\) mm",
        ),
        (lambda p: (1e39, 1), r"1e\+39 found at .* allowed are 0 to 1e6 \(1/mm\)"),
    ],
)
def test_what_a_function_must_not_return_is_named(engine, returned, said):
    """On a grid and at the tets, and the material that was set stays."""
    engine.material = quadgraph.Material(1, 0.5)
    with pytest.raises(InputError, match=said):
        VolumeMaterial.from_function(returned, BOX, 1)
    with pytest.raises(InputError, match=said):
        engine.set_coefficients(returned)
    assert (of_tets(engine)[2] == 0.5).all()


@pytest.mark.parametrize(
    ("box", "spacing", "said"),
    [
        (BOX, 0, "spacing: 0 found, one number or three above 0"),
        (BOX, (1, 2), "spacing: .* found"),
        (BOX, "fine", "spacing: text found"),
        (BOX, float("nan"), "spacing: nan found"),
        (BOX, 1e-3, "spacing: .* makes 16001 x 8001 x 8001 cells in the box, at most 11,184,810 .* about 0.0473"),
        (BOX, 1e-300, "take more"),
        (([0, 0, 0], [10, 10, 0]), 1e-4, r"100001 x 100001 x 1 cells .* about 0.00314 mm"),
        (BOX, 1 + 2j, "spacing: complex128 found"),
        ((BOX[1], BOX[0]), 1, "box: .* the lowest first"),
        ((BOX[0], (np.inf, 1, 1)), 1, "box: .* finite corners"),
        ((BOX[0], (1e300, 4, 4)), 1, "box: .* finite corners"),
        (BOX[0], 1, r"box: shape \(3,\) found, \(2, 3\) is wanted"),
        ("all", 1, "box: text found"),
    ],
)
def test_a_grid_that_cannot_be_is_named(box, spacing, said):
    with pytest.raises(InputError, match=said):
        VolumeMaterial.from_function(lambda points: (1, 1), box, spacing)


def test_points_of_any_shape_are_found(engine):
    """A plane of points comes back as it was asked for; beside the body there is no number."""
    engine.material = quadgraph.Material(2, 0.02)
    engine.solve(correction=False)
    plane = np.stack(np.meshgrid([-20, 0, 3], [-1, 1], [0.5], indexing="ij"), axis=-1)[:, :, 0]
    found = engine.fluence_at(plane)
    assert found.shape == (3, 2, 3)
    assert np.isnan(found[0]).all()
    assert np.array_equal(found[1:].reshape(-1, 3), engine.fluence_at(plane[1:].reshape(-1, 3)))
    assert np.array_equal(found[1, 0], engine.fluence_at([0, -1, 0.5]))
    assert engine.fluence_at(np.zeros((0, 3))).shape == (0, 3)
    assert np.isnan(engine.fluence_at([[0, 0, np.nan], [0, 0, 1e200]])).all()


@pytest.mark.parametrize("points", [0, [], [[0, 0]], "x", [[0, 0, "up"]], [[0, 0], [0]], [[0, 0, 1j]], [[None] * 3]])
def test_points_of_another_shape_are_named(engine, points):
    engine.material = "wax"
    engine.solve(cycles=1, correction=False)
    with pytest.raises(InputError, match=r"points: .* found, \(n, 3\) or \(\.\.\., 3\) is wanted"):
        engine.fluence_at(points)
