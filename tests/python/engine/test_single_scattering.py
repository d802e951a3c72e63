"""Light scattered once along the refracted view ray, as the polygrid paper adds it, against its closed form."""

from __future__ import annotations

import numpy as np
import pytest

import grids
from quadgraph.base.errors import InputError
from quadgraph.tets.polygrid import build
from quadgraph_validation.truth.fresnel import transmittance_from_outside

_core = pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")

SIGMA_S_PRIME, SIGMA_A = np.array([1.5, 1.0, 0.6]), np.array([0.1, 0.5, 1.4])  # 1/mm
LOOK = {"view": "0,0,400", "vertical_fov": 2.0, "width": 32, "height": 32}  # the middle of the box's front face
SMOOTH = {**LOOK, "transmission_roughness": 0}
IRRADIANCE = 2.0  # of a face across the light, W/mm^2


@pytest.fixture(scope="module")
def box(tmp_path_factory):
    """A box of 20 mm as a polygrid of 4^3 cells, some 40 mean free paths thick."""
    grid = grids.one_cube(4)
    low, high = grid.positions.min(axis=0), grid.positions.max(axis=0)
    graph = build.by_layers(build.as_graph(grid, 20 * (grid.positions - low) / (high - low) - 10))
    return grids.write(tmp_path_factory.mktemp("box") / "box.qgraph", [graph])


@pytest.fixture(scope="module")
def engine(box):
    """An engine under the validation layer; every message fails."""
    engine = _core.Engine(box, validation=True)
    yield engine
    assert engine.validation_messages == []


def lit(engine, eta: float, slope: float) -> float:
    """Light it from the front, so far from the normal; the inside cosine of what enters."""
    numbers = ("/".join(map(str, values)) for values in (SIGMA_S_PRIME, SIGMA_A))
    engine.set_material("sigma_s_prime={},sigma_a={},eta={}".format(*numbers, eta))
    engine.set_lights([f"directional:{slope},0,-1:{IRRADIANCE}"])
    return float(np.sqrt(1 - slope**2 / (1 + slope**2) / eta**2))


@pytest.mark.parametrize(
    ("method", "eta", "slope"), [("polygrid", 1.0, 0.0), ("polygrid", 1.3, 1.0), ("quadgraph-fdm", 1.3, 1.0)]
)
def test_a_flat_face_follows_the_law_of_lommel_and_seeliger(engine, method, eta, slope):
    """Seen along the normal, L = T sigma_s' / (4 pi eta^2 sigma_t) phi mu / (1 + mu).

    phi is the fluence below the face of light that travels at the inside cosine mu.
    """
    inside = lit(engine, eta, slope)
    outside = 1 / np.sqrt(1 + slope**2)
    engine.solve(method=method, source="diffuse")
    once = engine.render(**SMOOTH, radiance="single").scattered - engine.render(**LOOK, radiance="lambertian").scattered
    enters, leaves = transmittance_from_outside(np.array([outside, 1.0]), eta)
    fluence = enters * outside * IRRADIANCE / inside  # at the surface, of light that has not scattered
    albedo = SIGMA_S_PRIME / (SIGMA_S_PRIME + SIGMA_A)
    expected = leaves / eta**2 * albedo / (4 * np.pi) * fluence * inside / (1 + inside)
    print(f"{once[16, 16]} for {expected}")
    assert np.allclose(once[12:20, 12:20], expected, rtol=0.01)
    assert ("radiance", "lambertian") in engine.metadata


def test_it_is_asked_for_by_name_and_refused_where_there_are_no_levels(engine):
    lit(engine, 1.3, 0.0)
    engine.solve(method="polygrid", source="diffuse")
    engine.render(**LOOK, radiance="single")
    assert ("radiance", "single") in engine.metadata
    engine.solve(method="shortest-path", path_cells=16)
    with pytest.raises(InputError, match="with shortest-path nothing is gathered"):
        engine.render(**LOOK, radiance="single")


def test_what_is_gathered_of_a_polygrid_adds_up_to_its_exitance():
    """Over all faces of a ball and all directions; with one kappa both methods have the same fluence and radiance."""
    engine = _core.Engine(grids.PATH, validation=True)
    engine.set_material("sigma_s_prime=.6,sigma_a=.02,eta=1")
    engine.set_lights(["directional:0,0,-1:1"])
    squares, weights = np.polynomial.legendre.leggauss(4)  # of the cosine's square
    angle = np.pi / 4 + np.arange(4) * np.pi / 2
    found = {}
    for method in ("polygrid", "polygrid-divergence"):
        engine.solve(method=method, tolerance=1e-5, max_iterations=10000)
        field = engine.surface_field()
        normal, count = field["normal"], len(field["normal"])
        across = np.cross(normal, np.eye(3)[np.abs(normal).argmin(axis=1)])
        across /= np.linalg.norm(across, axis=1)[:, None]
        power, radiances = np.zeros(3), []
        for square, weight in zip((squares + 1) / 2, weights / 2, strict=True):
            for turn in angle:
                sideways = np.cos(turn) * across + np.sin(turn) * np.cross(normal, across)
                way = np.sqrt(square) * normal + np.sqrt(1 - square) * sideways
                light = engine.leaving(np.arange(count, dtype=np.uint32), way.astype(np.float32))
                radiances.append(light["radiance"])
                power += np.pi * weight / 4 * (field["area"][:, None] * light["radiance"]).sum(axis=0)
        found[method] = np.array(radiances)
        leaves = (field["area"][:, None] * field["exitance"]).sum(axis=0)
        print(f"{method}: {power} W gathered, {leaves} W leave")
        assert np.allclose(power, leaves, rtol=0.05)
    difference = found["polygrid"] - found["polygrid-divergence"]
    assert np.linalg.norm(difference) < 1e-3 * np.linalg.norm(found["polygrid"])
    assert engine.validation_messages == []
