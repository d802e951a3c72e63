"""Views of how well a volume's coefficients are known: where they are, what they show, and what is refused."""

from __future__ import annotations

import numpy as np
import pytest

import quadgraph
from baked import write_levels
from quadgraph import cli, core
from quadgraph.base.certainty import CERTAINTY
from quadgraph.base.errors import InputError
from quadgraph.mesh.subdivide import subdivide
from quadgraph.mesh.surface import Surface
from shapes import cube

pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")

SHAPE = (2, 2, 9)  # z, y, x: cells 2 mm apart along the block
SPACING = (2, 8, 8)
SURE, UNSURE = 0.02, 0.5
AHEAD = {"azimuth": 0, "elevation": 0, "orthographic": 20}  # 20 mm over the picture's height


@pytest.fixture(scope="module")
def block(tmp_path_factory):
    """A block of 16 x 8 x 8 mm about the origin."""
    surface = subdivide(cube(8), 2)
    path = tmp_path_factory.mktemp("bodies") / "block.qgraph"
    return write_levels(path, [Surface(surface.vertices * (2, 1, 1), surface.triangles)])


@pytest.fixture(scope="module")
def engine(block):
    with quadgraph.Engine(block, device="cpu") as made:
        made.lights = [quadgraph.DirectionalLight(direction=(0, 0, -1), irradiance=1)]
        yield made


def volume(**deviations: np.ndarray) -> quadgraph.VolumeMaterial:
    """An even material, known as well as these say."""
    return quadgraph.VolumeMaterial(np.ones(SHAPE), np.full(SHAPE, 0.1), SPACING, **deviations)


def halves() -> np.ndarray:
    """Of the cells: sure where x is negative, not sure elsewhere."""
    return np.broadcast_to(np.where(np.arange(9) < 4, SURE, UNSURE), SHAPE)


def colours(engine: quadgraph.Engine, show: str) -> np.ndarray:
    """5 mm to the left and to the right of the middle of the cut across z, (2, 3)."""
    engine.solve(cycles=1, correction=False)
    picture = engine.render(AHEAD, width=60, height=60, show=show).scattered
    return picture[30, [15, 45]]


def test_each_half_has_the_colour_of_its_deviation(engine):
    engine.material = volume(sigma_a_deviation=np.full(SHAPE, SURE))
    sure, _ = colours(engine, "sigma_a_deviation")
    engine.material = volume(sigma_a_deviation=np.full(SHAPE, UNSURE))
    unsure, _ = colours(engine, "sigma_a_deviation")
    assert np.linalg.norm(sure - unsure) > 0.2
    engine.material = volume(sigma_a_deviation=halves(), sigma_s_prime_deviation=halves()[..., ::-1])
    assert colours(engine, "sigma_a_deviation") == pytest.approx(np.array([sure, unsure]), abs=1e-3)
    assert colours(engine, "sigma_s_prime_deviation") == pytest.approx(np.array([unsure, sure]), abs=1e-3)


def test_each_half_has_the_colour_of_its_resolution_length(engine):
    lengths = np.broadcast_to(np.where(np.arange(9) < 4, 1.5, 6.0), SHAPE)
    engine.material = volume(sigma_a_resolution=lengths, sigma_s_prime_resolution=lengths[..., ::-1])
    own, other = (colours(engine, f"{name}_resolution") for name in ("sigma_a", "sigma_s_prime"))
    assert np.linalg.norm(own[0] - own[1]) > 0.2
    assert other == pytest.approx(own[::-1], abs=1e-3)
    with pytest.raises(InputError, match=r"show sigma_a_deviation: no deviations in this material; .*acquire"):
        colours(engine, "sigma_a_deviation")


def test_what_may_be_said_of_coefficients_has_the_same_names_in_the_engine():
    assert core.knowledge_names == list(CERTAINTY)


def test_the_mean_of_the_channels_is_shown(engine):
    even = np.full((*SHAPE, 3), SURE)
    one = np.full(SHAPE, SURE)
    engine.material = volume(sigma_s_prime_deviation=one)
    expected = colours(engine, "sigma_s_prime_deviation")
    coloured = quadgraph.VolumeMaterial(
        np.ones((*SHAPE, 3)), np.full(SHAPE, 0.1), SPACING, sigma_s_prime_deviation=even * (0.5, 2, 0.5)
    )
    engine.material = coloured
    assert colours(engine, "sigma_s_prime_deviation") == pytest.approx(expected, abs=1e-6)


def test_a_file_shows_what_the_material_does(engine, tmp_path):
    """Also where nothing is known: infinite is at the bar's end."""
    spread = np.array(halves())
    spread[..., -1] = np.inf
    material = volume(sigma_a_deviation=spread)
    material.save(tmp_path / "known.npz")
    engine.material = material
    own = colours(engine, "sigma_a_deviation")
    assert np.isfinite(own).all()
    engine.material = str(tmp_path / "known.npz")
    assert np.array_equal(colours(engine, "sigma_a_deviation"), own)


def test_deviations_stay_with_a_body_that_moves(engine):
    engine.material = volume(sigma_a_deviation=halves())
    there = colours(engine, "sigma_a_deviation")
    engine.set_deformation([quadgraph.Transform(axis=(0, 1, 0), degrees=180)])
    assert colours(engine, "sigma_a_deviation") == pytest.approx(there[::-1], abs=1e-3)
    engine.set_deformation([])


@pytest.mark.parametrize("material", ["wax", volume(), volume(sigma_s_prime_deviation=halves())])
def test_a_material_without_them_is_told(engine, material):
    engine.material = volume(sigma_a_deviation=halves())
    engine.material = material
    with pytest.raises(InputError, match=r"show sigma_a_deviation: no deviations in this material; .*acquire"):
        colours(engine, "sigma_a_deviation")


def test_the_command_line_tells_it_and_writes_nothing(block, tmp_path, capsys):
    output = tmp_path / "a.png"
    options = ["--device", "cpu", "--size", "60x60", "--no-correction"]
    asked = ["render", str(block), "--show", "sigma_a_deviation:z,1", *options, "-o", str(output)]
    assert cli.main(asked) == 1
    assert "no deviations in this material" in capsys.readouterr().err
    assert not output.exists()
    volume(sigma_a_deviation=halves()).save(tmp_path / "known.npz")
    assert cli.main([*asked, "--material", str(tmp_path / "known.npz")]) == 0
    assert output.exists()


@pytest.mark.parametrize(
    ("spread", "said"),
    [
        (np.ones((2, 2, 8)), r"shape \(2, 2, 8\) found, that of sigma_a, \(2, 2, 9\), wanted"),
        (np.where(halves() > SURE, -1.0, 1.0), "negative or no number in cell 4, 0 or more allowed"),
        (np.full(SHAPE, np.nan), "negative or no number in cell 0, 0 or more allowed"),
        (np.full(SHAPE, "much"), "numbers wanted"),
    ],
)
def test_a_file_whose_deviations_are_none_is_named(engine, tmp_path, spread, said):
    path = tmp_path / "v.npz"
    np.savez(path, sigma_s_prime=np.ones(SHAPE), sigma_a=np.ones(SHAPE), spacing=1.0, sigma_a_deviation=spread)
    with pytest.raises(InputError, match=rf"v\.npz: sigma_a_deviation: .*{said}"):
        engine.material = str(path)


@pytest.mark.parametrize("spread", [np.ones((2, 2, 8)), -np.ones(SHAPE), np.full(SHAPE, np.nan)])
def test_a_material_whose_deviations_are_none_is_refused(spread):
    with pytest.raises(InputError, match="sigma_a_deviation: "):
        volume(sigma_a_deviation=spread)
