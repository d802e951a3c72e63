"""What was solved, on its mesh: power and places are the engine's, whatever the method, and other programs read it."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest

import quadgraph
from baked import write_levels
from quadgraph.base.errors import InputError
from shapes import torus

POLYGRID = Path(__file__).resolve().parents[2] / "data/polygrid.qgraph"
RING = {"fem", "quadgraph-fv", "quadgraph-fdm"}
GRID = {"polygrid", "polygrid-divergence"}
SUN = quadgraph.DirectionalLight(direction=(0.3, 0, -1), irradiance=(1, 2, 3))
SCATTERING, ABSORPTION = np.array([1.0, 1.5, 2.0]), np.array([0.1, 0.05, 0.2])


@pytest.fixture(scope="module")
def ring(tmp_path_factory) -> Path:
    """A torus, 26 mm across."""
    path = tmp_path_factory.mktemp("bodies") / "ring.qgraph"
    return write_levels(path, [torus(around=32, across=16), torus(around=16, across=8)])


@pytest.fixture
def engine(ring):
    with quadgraph.Engine(ring) as made:
        made.lights = [SUN]
        made.material = quadgraph.Material(sigma_s_prime=SCATTERING, sigma_a=ABSORPTION)
        yield made


def volumes(mesh) -> np.ndarray:
    """Of tets, mm^3; negative where one is turned inside out."""
    corners = mesh.points[mesh.cells[0].data].astype(float)
    return np.linalg.det(corners[:, 1:] - corners[:, :1]) / 6


def absorbed(mesh) -> np.ndarray:
    """The integral of sigma_a times fluence over the tets, W."""
    data = mesh.cell_data
    return (data["sigma_a"][0] * data["fluence"][0] * volumes(mesh)[:, None]).sum(axis=0)


@pytest.mark.parametrize("method", sorted(RING | GRID))
def test_fluence_times_absorption_is_the_power_that_is_absorbed(ring, method):
    """Light that enters as if it had scattered is absorbed by fluence alone; patterns differ from tet to tet."""
    pytest.importorskip("meshio")
    with quadgraph.Engine(ring if method in RING else POLYGRID) as engine:
        engine.lights, engine.material = [SUN], "wood"
        energy = engine.solve(method=method, source="diffuse", correction=False).energy
        assert absorbed(engine.to_meshio()) == pytest.approx(energy.absorbed, rel=1e-4)


def test_what_is_missing_is_absorbed_before_it_scatters(engine):
    """Of light that is taken away on its first way, absorption takes its share of the extinction."""
    pytest.importorskip("meshio")
    energy = engine.solve(inter_reflection=False, correction=False).energy
    at_first = (energy.entered - energy.unscattered_out) * ABSORPTION / (SCATTERING + ABSORPTION)
    assert (at_first > 0.02 * energy.absorbed).all()
    assert absorbed(engine.to_meshio()) + at_first == pytest.approx(energy.absorbed, rel=1e-4)


def test_a_corrected_fluence_lacks_what_does_not_stand_out_of_the_noise(engine):
    """The power is that of the whole correction, of which the fluence has a share, so both differ within the error."""
    pytest.importorskip("meshio")
    report = engine.solve(inter_reflection=False)
    energy = report.energy
    at_first = (energy.entered - energy.unscattered_out) * ABSORPTION / (SCATTERING + ABSORPTION)
    apart = (absorbed(engine.to_meshio()) + at_first) / energy.absorbed - 1
    assert np.abs(apart).max() < report.error.whole


def test_tets_are_the_body_in_its_shape(engine):
    pytest.importorskip("meshio")
    engine.solve()
    whole = volumes(engine.to_meshio())
    assert (whole > 0).all()
    assert whole.sum() == pytest.approx(torus(around=32, across=16).volume, rel=1e-5)
    engine.set_deformation([quadgraph.Transform(scale=(1, 1, 2), translate=(5, 0, 0))])
    engine.solve()
    moved = engine.to_meshio()
    assert volumes(moved) == pytest.approx(2 * whole, rel=1e-3)
    surface = engine.to_meshio("surface")
    places = surface.points[surface.cells[0].data].mean(axis=1)
    assert np.abs(places - engine.surface().position).max() < 1e-5
    assert moved.points[:, 0].mean() == pytest.approx(5, abs=0.2)


def test_triangles_have_what_the_surface_has(engine):
    pytest.importorskip("meshio")
    engine.solve(method="quadgraph-fv")
    mesh, field = engine.to_meshio("surface"), engine.surface()
    for name in ("q", "phi", "exitance", "unscattered"):
        assert np.array_equal(mesh.cell_data[name][0], getattr(field, name))
    corners = mesh.points[mesh.cells[0].data]
    outward = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    assert (np.einsum("ij,ij->i", outward, field.normal) > 0).all()
    assert np.linalg.norm(outward, axis=1) / 2 == pytest.approx(field.area, rel=1e-4)


@pytest.mark.parametrize("method", ["fem", "quadgraph-fv"])
def test_fluence_of_cells_and_points_is_what_is_found_there(engine, method):
    """In the middle of a tet its mean; at a vertex what was solved there, or what the tets around have."""
    pytest.importorskip("meshio")
    engine.solve(method=method)
    mesh = engine.to_meshio()
    tets, cells = mesh.cells[0].data, mesh.cell_data["fluence"][0]
    inside = engine.fluence_at(mesh.points[tets].mean(axis=1))
    assert np.abs(cells - inside).max() < 1e-4 * np.abs(cells).max()
    at_points = mesh.point_data["fluence"]
    if method == "fem":
        assert np.array_equal(at_points, engine.fluence().values)
    else:
        around = (tets == 7).any(axis=1)
        expected = np.average(cells[around], axis=0, weights=volumes(mesh)[around])
        assert at_points[7] == pytest.approx(expected, rel=1e-4)


def test_coefficients_are_those_of_the_solve(engine):
    """Edits among them; what is set later counts from the next solve on."""
    pytest.importorskip("meshio")
    engine.solve()
    before = engine.to_meshio().cell_data["sigma_a"][0]
    assert before == pytest.approx(np.tile(ABSORPTION, (len(before), 1)))
    engine.set_edits([{"operation": "multiply", "sigma_a": (10, 1, 1)}])
    engine.solve()
    engine.material = "marble"
    ratio = engine.to_meshio().cell_data["sigma_a"][0] / before
    assert ratio == pytest.approx(np.tile([10.0, 1, 1], (len(ratio), 1)), rel=1e-5)


def test_a_file_is_read_back(engine, tmp_path):
    meshio = pytest.importorskip("meshio")
    engine.solve()
    made = engine.to_meshio()
    made.write(tmp_path / "ring.vtu")
    read = meshio.read(tmp_path / "ring.vtu")
    assert np.array_equal(read.points, made.points)
    assert np.array_equal(read.cells[0].data, made.cells[0].data)
    for name, values in made.cell_data.items():
        assert np.array_equal(read.cell_data[name][0], values[0])
    assert np.array_equal(read.point_data["fluence"], made.point_data["fluence"])


def test_pyvista_finds_the_same_fluence(engine):
    """VTK interpolates in the tets as the engine does."""
    pyvista = pytest.importorskip("pyvista")
    engine.solve(method="fem")
    grid, skin = engine.to_pyvista(), engine.to_pyvista("surface")
    assert grid.volume == pytest.approx(torus(around=32, across=16).volume, rel=1e-5)
    assert skin.area == pytest.approx(engine.surface().area.sum(), rel=1e-5)
    angles = np.linspace(0, 6, 20)
    points = np.stack([10 * np.cos(angles), 10 * np.sin(angles), 0.5 * np.cos(3 * angles)], axis=1)
    sampled = pyvista.PolyData(points).sample(grid)["fluence"]
    assert sampled == pytest.approx(engine.fluence_at(points), rel=1e-3)


@pytest.mark.parametrize("part", ["inside", "", None, np.ones(2)])
def test_a_part_that_there_is_not_is_named(engine, part):
    engine.solve()
    with pytest.raises(InputError, match=r"part: .* found, 'body' or 'surface' allowed"):
        engine.to_meshio(part)


@pytest.mark.parametrize("part", ["body", "surface"])
def test_there_is_no_mesh_without_a_solution(engine, part):
    with pytest.raises(InputError, match="solve"):
        engine.to_meshio(part)
    engine.solve(method="shortest-path", path={"cells": 20})
    with pytest.raises(InputError, match="shortest-path"):
        engine.to_pyvista(part)


@pytest.mark.parametrize("name", ["meshio", "pyvista"])
def test_a_package_that_is_missing_is_named_with_its_extra(engine, name, monkeypatch):
    engine.solve()
    monkeypatch.setitem(sys.modules, name, None)
    with pytest.raises(InputError, match=rf"{name} cannot be imported .* pip install 'quadgraph\[{name}\]'"):
        getattr(engine, f"to_{name}")()
