"""What the public classes do to a body: coefficients on a grid, edits, cuts, shapes and images as lights."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from PIL import Image

import quadgraph
from baked import write_levels
from light_truth import write_hdr
from quadgraph.base.errors import InputError
from shapes import icosphere

RADIUS = 10.0
MEDIUM = quadgraph.Material(sigma_s_prime=1, sigma_a=0.05)
SUN = quadgraph.DirectionalLight(direction=(0, 0, -1), irradiance=1)
LIFT = (0.0, 0.0, 3.0)


@pytest.fixture(scope="module")
def ball(tmp_path_factory) -> Path:
    """A sphere about the origin."""
    return write_levels(tmp_path_factory.mktemp("bodies") / "ball.qgraph", [icosphere(3, RADIUS), icosphere(2, RADIUS)])


@pytest.fixture
def engine(ball):
    with quadgraph.Engine(ball) as made:
        made.lights = [SUN]
        made.material = MEDIUM
        yield made


def entered(engine: quadgraph.Engine, *lights: quadgraph.Light) -> np.ndarray:
    """Power that these lights bring into the body, W."""
    engine.lights = lights
    return engine.solve().energy.entered


def test_an_even_grid_is_a_material(engine):
    expected = engine.solve().energy.absorbed
    even = np.ones((2, 3, 4))
    engine.material = quadgraph.VolumeMaterial(even, 0.05 * even, spacing=8)
    assert engine.solve().energy.absorbed == pytest.approx(expected, rel=1e-5)


def test_a_grid_lies_as_its_origin_says(engine):
    """One half of the ball black: light that comes from above ends there at once if it is the upper one."""

    def halves(lower: float, upper: float) -> tuple[float, float]:
        """Absorbed, W, and mean exitance of the lower side, W/mm^2."""
        absorption = np.array([lower, upper]).reshape(2, 1, 1)
        grid = quadgraph.VolumeMaterial(np.ones((2, 1, 1)), absorption, spacing=(1, 1, 1), origin=(0, 0, -0.5))
        engine.material = grid
        absorbed = engine.solve().energy.absorbed[0]
        field = engine.surface()
        return absorbed, float(field.exitance[field.position[:, 2] < -RADIUS / 2].mean())

    clear, black_below, black_above = halves(0.05, 0.05), halves(5, 0.05), halves(0.05, 5)
    assert clear[0] < black_below[0] < black_above[0]
    assert black_below[1] < 0.5 * clear[1]
    assert black_above[1] < 0.5 * clear[1]


def test_a_grid_in_a_file_is_the_same(engine, tmp_path):
    rows = np.linspace(0.02, 0.2, 5)[:, None, None]
    grid = quadgraph.VolumeMaterial(np.ones_like(rows), rows, spacing=4)
    grid.save(tmp_path / "grid.npz")
    engine.material = grid
    expected = engine.solve().energy.absorbed
    engine.material = str(tmp_path / "grid.npz")
    assert engine.solve().energy.absorbed == pytest.approx(expected, rel=1e-6)


def test_an_edit_takes_light_and_gives_it_back(engine):
    before = engine.solve().energy.absorbed
    engine.set_edits([{"operation": "multiply", "sigma_a": (10, 1, 1)}])
    edited = engine.solve().energy.absorbed
    assert edited[0] > 1.5 * before[0]
    assert edited[1:] == pytest.approx(before[1:], rel=1e-3)
    engine.set_edits([])
    assert engine.solve().energy.absorbed == pytest.approx(before, rel=1e-6)


def test_a_cut_takes_half_of_the_voxels(engine):
    path: quadgraph.PathOptions = {"cells": 40}
    whole = engine.solve(method="shortest-path", path=path).path
    ball = icosphere(3, RADIUS)
    # A cell that the surface crosses is solid.
    assert ball.volume < whole.solid * whole.cell**3 < ball.volume + ball.area * whole.cell
    engine.set_cuts([{"type": "plane", "normal": (1, 0, 0), "offset": 0}])
    assert engine.solve(method="shortest-path", path=path).path.solid == pytest.approx(whole.solid / 2, rel=0.05)


def test_shortest_paths_darken_as_the_body_absorbs(engine):
    """The far side is lit through the body, the near one at once."""

    def seen(material: quadgraph.Material, view: str) -> float:
        engine.material = material
        engine.solve(method="shortest-path", path={"cells": 32})
        return float(engine.render(view, width=32, height=32).scattered.mean())

    front, back = "0,0", "180,0"
    darker = quadgraph.Material(sigma_s_prime=1, sigma_a=0.2)
    near, far = (seen(darker, view) / seen(MEDIUM, view) for view in (front, back))
    assert far < 0.5 * near < 1


@pytest.fixture
def lifted(engine) -> quadgraph.Shapes:
    """Two shapes of the body: as it lies, and moved as a whole."""
    graph = engine._engine.graph

    def moves(vertices: np.ndarray) -> np.ndarray:
        return np.stack([np.zeros_like(vertices), np.broadcast_to(np.float32(LIFT), vertices.shape)])

    return quadgraph.Shapes(moves(graph.display["vertices"]), [moves(level.vertices) for level in graph.levels])


@pytest.mark.parametrize(
    ("how", "share"), [({"weights": (0, 1)}, 1), ({"weights": (5, 0.5)}, 0.5), ({"frame": 0.25}, 0.25)]
)
def test_shapes_in_memory_move_a_body(engine, lifted, how, share):
    energy = engine.solve().energy
    rest = engine.surface().position
    assert lifted.count == 2
    engine.set_deformation([quadgraph.Displaced(lifted, **how)])
    moved = engine.solve()
    assert np.abs(engine.surface().position - rest - share * np.array(LIFT)).max() < 1e-5
    assert moved.energy.absorbed == pytest.approx(energy.absorbed, rel=1e-3)


def test_a_stage_shows_shapes_in_memory(ball, lifted):
    scene = quadgraph.Scene(
        ball, MEDIUM, [SUN], deformation=[quadgraph.Twist(0), quadgraph.Displaced(lifted, weights=(0, 1))]
    )
    with quadgraph.Stage() as stage:
        stage.show(quadgraph.Scene(ball, MEDIUM, [SUN]))
        stage.solve()
        rest = stage.engine.surface().position
        stage.show(scene)
        assert stage.scene.deformation == scene.deformation
        assert stage.solve().converged
        assert np.abs(stage.engine.surface().position - rest - np.array(LIFT)).max() < 1e-5


def test_a_stage_has_no_solution_of_a_body_that_it_moved(ball):
    with quadgraph.Stage() as stage:
        stage.show(quadgraph.Scene(ball, MEDIUM, [SUN]))
        solution = stage.solve()
        stage.show(quadgraph.Scene(ball, quadgraph.Material(1, 0.5), [SUN]))
        assert stage.engine.solution is solution
        stage.show(quadgraph.Scene(ball, MEDIUM, [SUN], deformation=[quadgraph.Twist(20)]))
        assert stage.engine.solution is None
        with pytest.raises(InputError, match="nothing was solved since the body was loaded or moved"):
            stage.engine.fluence_at((0, 0, 0))


def test_no_file_has_shapes_in_memory(ball, lifted, tmp_path):
    file = quadgraph.SceneFile(quadgraph.Scene(ball, deformation=[quadgraph.Displaced(lifted, frame=1)]))
    file.set("/camera/fov", 40)
    assert file.at(0).camera["fov"] == 40
    for refused in (
        file.at(0).to_dict,
        lambda: file.save(tmp_path / "scene.json"),
        lambda: file.set("/deformation/0", {"type": "twist", "degrees": 1}),
    ):
        with pytest.raises(InputError, match="qshapes"):
            refused()
    assert not list(tmp_path.iterdir())


def test_a_bright_environment_all_around_is_ambient_light(engine, tmp_path):
    held = write_hdr(tmp_path / "even.hdr", np.full((16, 32, 3), 0.25))
    environment = quadgraph.EnvironmentLight(tmp_path / "even.hdr", radiance=2)
    ambient = quadgraph.AmbientLight(irradiance=2 * np.pi * held[0, 0, 0])
    assert entered(engine, environment) == pytest.approx(entered(engine, ambient), rel=0.02)


def test_a_projector_sends_what_its_image_has(engine, tmp_path):
    """From above, within the ball: half of the image black is half of the power."""
    image = np.full((64, 64, 3), 255, np.uint8)
    Image.fromarray(image).save(tmp_path / "white.png")
    image[:, :32] = 0
    image[..., 2] = 0
    Image.fromarray(image).save(tmp_path / "half.png")

    def thrown(name: str) -> np.ndarray:
        beam = {"position": (0, 0, 60), "direction": (0, 0, -1), "angle": 10, "power": 3}
        return entered(engine, quadgraph.ProjectorLight(file=tmp_path / name, **beam))

    white, half = thrown("white.png"), thrown("half.png")
    assert white == pytest.approx(np.full(3, 3 * 0.98), rel=0.03)
    assert half[:2] == pytest.approx(white[:2] / 2, rel=0.05)
    assert half[2] == 0


def test_motion_starts_from_the_last_solution(engine):
    first = engine.solve(tolerance=1e-4).levels[-1].iterations
    assert engine.solve(tolerance=1e-4, warm=True).levels[-1].iterations < first
    rays = {mean: entered_evenly(engine, mean) for mean in (False, True)}
    assert rays[True] == pytest.approx(rays[False], rel=0.05)
    assert not np.array_equal(rays[True], rays[False])


def entered_evenly(engine: quadgraph.Engine, mean_rays: bool) -> np.ndarray:
    """What uniform illumination leaves in the body, W."""
    engine.lights = [quadgraph.AmbientLight(irradiance=1)]
    return engine.solve(mean_rays=mean_rays).energy.absorbed


@pytest.mark.parametrize("options", [{"smoothing": 3}, {"tolerance": 2}, {"nonsense": 1}, {"path": {"cells": 1}}])
def test_an_option_that_is_not_allowed_is_named(engine, options):
    with pytest.raises(InputError, match=next(iter(options))):
        engine.solve(**options)


@pytest.mark.parametrize("eta", ["1.3", [1.3, 1.4], None])
def test_an_index_that_is_no_number_is_named(engine, eta):
    with pytest.raises(InputError, match=r"eta: .* found, a number is wanted"):
        engine.set_coefficients(lambda points: (1.0, 0.1), eta)
    engine.set_coefficients(lambda points: (1.0, 0.1), np.float32(1.3))
