"""The polygrid methods of the engine: rows and solutions against SciPy and the CPU, hierarchy, layers, coherence."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.special import eval_legendre, spherical_in

import grids
from grids import RADIUS
from light_truth import lit_from_above
from quadgraph.base.errors import FormatError, InputError
from quadgraph.file import qgraph_file
from quadgraph.tets.graph import Graph
from quadgraph_validation.bodies.meshes import face_frames
from quadgraph_validation.truth import polygrid_diffusion

_core = pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")

METHODS = ("polygrid", "polygrid-divergence")
MATERIAL = "sigma_s_prime=1.5/1.0/0.7,sigma_a=0.01/0.03/0.1,eta=1.3"
VEINS = "marble-veins,period=8"


@pytest.fixture(scope="module")
def graphs() -> list[Graph]:
    """A ball of 8^3, 4^3 and 2^3 cells."""
    return grids.balls(8, 3)


@pytest.fixture(scope="module")
def path(graphs, tmp_path_factory):
    return grids.write(tmp_path_factory.mktemp("grid") / "ball.qgraph", graphs)


@pytest.fixture
def engine(path):
    """An engine under the validation layer; every message fails the test."""
    engine = _core.Engine(path, validation=True)
    yield engine
    assert engine.validation_messages == []


def light(engine, direction=(0.3, 0.0, -1.0)) -> None:
    for number, level in enumerate(engine.graph.levels):
        engine.set_irradiance(number, lit_from_above(level), direction=direction)


@pytest.mark.parametrize("material", [MATERIAL, VEINS])
@pytest.mark.parametrize("model", ["diffusion", "sp3"])
@pytest.mark.parametrize("method", METHODS)
def test_gpu_equals_cpu_reference(engine, method, model, material):
    engine.set_material(material)
    light(engine)
    level = engine.graph.levels[0]
    sigma = _core.evaluate_material(engine.graph, 0, _core.Material(material))
    eta = _core.Material(material).eta
    for source in ("buried", "diffuse"):
        way = {"method": method, "model": model, "source": source, "solver": "cascade"}
        engine.solve(**way, tolerance=1e-7, max_iterations=20000)
        expected = _core.solve_reference(
            engine.graph, 0, *sigma, eta, lit_from_above(level), direction=(0.3, 0.0, -1.0), **way, tolerance=1e-10
        )
        field = engine.surface_field()
        for name, found in (("exitance", field["exitance"]), ("phi_face", field["phi"])):
            scale = np.abs(expected[name]).max(axis=0)
            worst = np.abs((found - expected[name]) / scale).max()
            print(f"{way} {name}: worst difference {worst:.1e}")
            assert worst < 2e-5


def kappa_at_vertices(graph: Graph, sigma_s_prime: np.ndarray, sigma_a: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """kappa and sigma_a (n_v,) of channel 0: means of the tets around each vertex by volume."""
    corners = graph.vertices[graph.tets]
    volume = np.abs(np.linalg.det(corners[:, 1:] - corners[:, :1])) / 6
    count = len(graph.vertices)
    total = np.bincount(graph.tets.ravel(), volume.repeat(4), count)
    means = [
        np.bincount(graph.tets.ravel(), (volume * values[: len(graph.tets), 0]).repeat(4), count) / total
        for values in (sigma_s_prime, sigma_a)
    ]
    return 1 / (3 * (means[0] + means[1])), means[1]


@pytest.mark.parametrize("method", METHODS)
def test_rows_are_those_of_scipy(graphs, path, method):
    """Entry by entry, each row over its diagonal: two independent assemblies of Appendix B."""
    graph, engine_graph = graphs[0], _core.Engine(path).graph
    sigma_s_prime, sigma_a = _core.evaluate_material(engine_graph, 0, _core.Material(VEINS))
    rows = _core.assemble(engine_graph, 0, method, sigma_s_prime, sigma_a, 1.3, model="diffusion")
    kappa, absorption = kappa_at_vertices(graph, sigma_s_prime, sigma_a)
    outflow = _core.boundary(method, "buried", "diffusion", 1.3)["k11"]
    expected = polygrid_diffusion.operator(graph, kappa, absorption, outflow, published=method == "polygrid").toarray()
    found = np.zeros_like(expected)
    row = np.repeat(np.arange(len(found)), np.diff(rows["offset"]))
    found[row, rows["column"]] = rows["weight"][:, 0]
    found[np.arange(len(found)), np.arange(len(found))] = rows["diagonal"][:, 0]
    found /= rows["to_phi"][:, 0]  # from x to phi
    expected /= expected.diagonal()[:, None]
    found /= found.diagonal()[:, None]
    assert np.abs(found - expected).max() < 1e-6


@pytest.mark.parametrize("method", METHODS)
def test_furnace(engine, method):
    engine.set_material("sigma_s_prime=2/1/0.5,sigma_a=0,eta=1.3")
    for number, level in enumerate(engine.graph.levels):
        engine.set_irradiance(number, np.full((len(level.faces), 3), 0.7, np.float32))
    for model in ("diffusion", "sp3"):
        engine.solve(method=method, model=model, source="diffuse", tolerance=1e-7, max_iterations=20000)
        assert np.abs(engine.surface_field()["exitance"] / 0.7 - 1).max() < 1e-4


def exact_fluence(vertices: np.ndarray, kappa: float, sigma_a: float, outflow: float, degrees: list[float]):
    """Fluence in a ball whose surface source is a sum of Legendre polynomials (docs/physics.md, "Closed forms")."""
    rate, radius = np.sqrt(sigma_a / kappa), np.linalg.norm(vertices, axis=1)
    cosine = vertices[:, 2] / np.maximum(radius, 1e-12)
    total = np.zeros(len(vertices))
    for degree, amount in enumerate(degrees):
        outside = spherical_in(degree, rate * RADIUS)
        outside += kappa / outflow * rate * spherical_in(degree, rate * RADIUS, derivative=True)
        total += amount * eval_legendre(degree, cosine) * spherical_in(degree, rate * radius) / outside
    return total


def surface_error(graph: Graph, path, method: str) -> float:
    """Relative RMS error of the fluence at the faces of level 0, by area, against the closed form."""
    kappa, sigma_a, eta, degrees = 0.5, 0.05, 1.3, [0.5, 0.6, 0.4, 0.3]
    core_graph = _core.load(path)
    condition = _core.boundary(method, "diffuse", "diffusion", eta)
    centre, _, area = face_frames(core_graph.levels[0])
    cosine = centre[:, 2] / np.linalg.norm(centre, axis=1)
    q = sum(amount * eval_legendre(degree, cosine) for degree, amount in enumerate(degrees))
    shape = (len(graph.tets) + len(graph.faces), 3)
    found = _core.solve_reference(
        core_graph,
        0,
        np.full(shape, 1 / (3 * kappa) - sigma_a, np.float32),
        np.full(shape, sigma_a, np.float32),
        eta,
        np.repeat(np.maximum(q, 0)[:, None], 3, axis=1).astype(np.float32),
        method=method,
        source="diffuse",
        model="diffusion",
    )["phi_face"][:, 0]
    on_sphere = RADIUS * centre / np.linalg.norm(centre, axis=1, keepdims=True)
    exact = condition["source"] * exact_fluence(on_sphere, kappa, sigma_a, condition["k11"], degrees)
    return float(np.sqrt((area * (found - exact) ** 2).sum() / (area * exact**2).sum()))


def test_a_ball_against_its_closed_form(tmp_path):
    """Weights that leave out mixed terms do not converge on skewed links; linear elements on the same nodes do."""
    errors: dict[str, list[float]] = {method: [] for method in (*METHODS, "fem")}
    for cells in (4, 8):
        graph = grids.balls(cells)[0]
        path = grids.write(tmp_path / f"ball-{cells}.qgraph", [graph])
        for method, found in errors.items():
            found.append(surface_error(graph, path, method))
    print(f"relative RMS errors on the surface, 4^3 and 8^3 cells: {errors}")
    for method in METHODS:
        assert errors[method][1] < errors[method][0] < 0.15
        assert errors[method][1] > errors["fem"][1]
    assert errors["fem"][1] < 0.5 * errors["fem"][0]


def test_conjugate_gradients_are_refused_and_cycles_replaced(engine):
    engine.set_material(MATERIAL)
    light(engine)
    with pytest.raises(InputError, match="not symmetric"):
        engine.solve(method="polygrid", solver="dpcg")
    for solver in ("fmg-pcg", "vcycle"):
        report = engine.solve(method="polygrid", solver=solver)
        assert report["solver"] == "cascade"
        assert "not symmetric" in report["replaced"]
    assert engine.solve(method="polygrid", solver="auto")["solver"] == "cascade"


@pytest.mark.parametrize("method", METHODS)
def test_the_cascade_takes_less_work_to_the_same_answer(engine, method):
    engine.set_material("sigma_s_prime=1,sigma_a=0.005,eta=1.3")
    light(engine)
    work, answers = {}, {}
    for solver in ("jacobi", "cascade"):
        work[solver] = engine.solve(method=method, solver=solver, tolerance=1e-3)["work"]
        answers[solver] = engine.surface_field()["exitance"]
    print(f"work: {work}")
    assert work["cascade"] < work["jacobi"]
    difference = np.linalg.norm(answers["cascade"] - answers["jacobi"]) / np.linalg.norm(answers["jacobi"])
    assert difference < 5e-3


def test_deep_nodes_keep_what_the_coarser_level_has(engine):
    engine.set_material("sigma_s_prime=1,sigma_a=0.02,eta=1.3")
    light(engine)
    way = {"method": "polygrid-divergence", "solver": "cascade", "tolerance": 1e-4}
    whole = engine.solve(**way)
    exact = engine.surface_field()["exitance"]
    errors, work = [], []
    for layers in (1, 2, 3, 4):
        report = engine.solve(**way, active_layers=layers)
        assert all(level["residual"] < way["tolerance"] for level in report["levels"])
        # The solver gets there, but half of the light is unaccounted for, with as many layers as there are too.
        assert "polygrid-divergence does not conserve energy" in report["stopped"]
        found = engine.surface_field()["exitance"]
        errors.append(np.linalg.norm(found - exact) / np.linalg.norm(exact))
        work.append(report["work"])
    print(f"errors by layers: {errors}, work: {work} of {whole['work']}")
    assert errors[0] > errors[1] > errors[2]
    assert errors[3] < 1e-3  # 8^3 cells have four layers
    assert work[0] < work[1] < whole["work"]


def test_layers_are_of_polygrids_alone(engine):
    engine.set_material(MATERIAL)
    light(engine)
    with pytest.raises(InputError, match="active_layers"):
        engine.solve(method="fem", active_layers=2)


@pytest.mark.parametrize("layers", [0, 2])
def test_the_last_solution_is_a_good_start(engine, layers):
    engine.set_material("sigma_s_prime=1,sigma_a=0.005,eta=1.3")
    way = {"method": "polygrid", "solver": "cascade", "tolerance": 1e-3, "active_layers": layers}
    light(engine)
    engine.solve(**way)
    turned = (0.35, 0.0, -1.0)
    light(engine, turned)
    cold = engine.solve(**way)
    exact = engine.surface_field()["exitance"]
    light(engine)
    engine.solve(**way)
    light(engine, turned)
    warm = engine.solve(**way, warm=True)
    assert warm["work"] < 0.8 * cold["work"]
    assert np.linalg.norm(engine.surface_field()["exitance"] - exact) / np.linalg.norm(exact) < 1e-2


def test_a_moved_body_has_the_rows_of_its_new_shape(engine, graphs, tmp_path):
    """Weights are found on the device from where the vertices are now."""
    engine.set_material(MATERIAL)
    for number, graph in enumerate(graphs):
        stretched = (graph.vertices * [1.0, 1.3, 0.9]).astype(np.float32)
        engine.set_vertices(number, stretched)
    light(engine)
    way = {"method": "polygrid", "solver": "cascade", "tolerance": 1e-7, "max_iterations": 20000}
    engine.solve(**way)
    moved = engine.surface_field()["exitance"]
    fresh_graphs = [
        Graph(
            (graph.vertices * [1.0, 1.3, 0.9]).astype(np.float32).astype(float),
            graph.tets,
            graph.faces,
            graph.face_tets,
            graph.links,
            graph.inner * [1.0, 1.3, 0.9],
            graph.surface * [1.0, 1.3, 0.9],
            grid_links=graph.grid_links,
        )
        for graph in graphs
    ]
    fresh = _core.Engine(grids.write(tmp_path / "fresh.qgraph", fresh_graphs))
    fresh.set_material(MATERIAL)
    for number, level in enumerate(engine.graph.levels):
        fresh.set_irradiance(number, lit_from_above(level), direction=(0.3, 0.0, -1.0))
    fresh.solve(**way)
    scale = np.abs(moved).max()
    assert np.abs(fresh.surface_field()["exitance"] - moved).max() < 1e-4 * scale


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda s: s["level0/grid_links"].__setitem__((0, 0), 10**6), "index"),
        (lambda s: s["level0/grid_links"].__setitem__((-1, 0), 0), "linked a second time"),
        (lambda s: s["level0/grid_links"].__setitem__((-1, 0), s["level0/faces"].max() + 1), "order of their layers"),
        (lambda s: s["level0/grid_links"].__setitem__((0, 0), s["level0/faces"].max() + 1), "linked to itself"),
        (lambda s: s.pop("level1/grid_links"), "all levels must have it, or none"),
        (lambda s: s.update({"level0/grid_links": s["level0/grid_links"][:-1].copy()}), "511 rows, expected 512"),
    ],
)
def test_broken_links_are_named(path, tmp_path, change, message):
    file = qgraph_file.read(path)
    sections = {name: array.copy() for name, array in file.sections.items() if name != "metadata"}
    change(sections)
    with pytest.raises(FormatError, match=message):
        qgraph_file.write(tmp_path / "broken.qgraph", file.metadata, sections)


def test_both_readers_take_the_links_as_they_were_written(path, graphs):
    file = qgraph_file.read(path)
    for number, level in enumerate(graphs):
        assert np.array_equal(file.sections[f"level{number}/grid_links"], level.grid_links)
    assert len(_core.Engine(path).graph.levels) == 3
