"""Light enters by normal maps: as much in all, and by places as where the surface is displaced as the map shows."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from test_normal_maps import LEANING, slopes_of, texel
from test_normal_textures import COLOUR, SLOPES, baked, leaning

import quadgraph
from baked import write_levels
from quadgraph.base.errors import InputError
from quadgraph.mesh.subdivide import subdivide
from quadgraph.mesh.surface import Surface
from shapes import cube

SIZE, WAVE, STEEPEST = np.array([24.0, 8.0, 6.0]), 6.0, 0.3  # mm; of one wave, mm; slope
ETA = 1.4
MATERIAL = f"sigma_s_prime=3,sigma_a=.5,eta={ETA}"


def towards_at(degrees: float) -> np.ndarray:
    """Towards a lamp, so many degrees from upright."""
    return np.array([np.sin(np.radians(degrees)), 0, np.cos(np.radians(degrees))])


def lamp(towards: np.ndarray) -> dict:
    """Far away there."""
    return {"type": "directional", "direction": (-towards).tolist(), "irradiance": 1.0}


SLANTED = towards_at(50)
LAMP = lamp(SLANTED)


def slab(edge: float, height: float) -> Surface:
    """A slab whose upper side is in waves along x, so many mm high."""
    counts = np.round(SIZE / edge).astype(int)
    number = np.full(counts + 1, -1)
    grid = np.stack(np.meshgrid(*(np.arange(n + 1) for n in counts), indexing="ij"), axis=-1)
    outside = ((grid == 0) | (grid == counts)).any(axis=-1)
    number[outside] = np.arange(outside.sum())
    places = grid[outside] * (SIZE / counts)
    places[:, 2] += height * np.cos(2 * np.pi * places[:, 0] / WAVE) * places[:, 2] / SIZE[2]
    triangles = []
    for axis in range(3):
        for end in (0, counts[axis]):
            side = np.take(number, end, axis=axis)
            side = side if (end > 0) == (axis != 1) else side.T
            a, b, c, d = (part.ravel() for part in (side[:-1, :-1], side[1:, :-1], side[1:, 1:], side[:-1, 1:]))
            triangles += [np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)]
    return Surface(places, np.concatenate(triangles))


@pytest.fixture(scope="module")
def folder(tmp_path_factory) -> Path:
    path = tmp_path_factory.mktemp("entering")
    height = STEEPEST * WAVE / (2 * np.pi)
    for name, high in (("plain", 0.0), ("displaced", height)):
        write_levels(path / f"{name}.qgraph", [slab(0.5, high), slab(1.0, high)], rays=32)
    x = (np.arange(960) + 0.5) / 960 * SIZE[0]
    falls = STEEPEST * np.sin(2 * np.pi * x / WAVE)  # there the normal of the upper side leans to the right
    waves = np.array([texel((slope, 0)) for slope in falls])
    Image.fromarray(np.tile(waves, (4, 1, 1))).save(path / "waves.png")
    Image.fromarray(np.tile(LEANING, (8, 8, 1))).save(path / "leaning.png")
    Image.fromarray(np.tile(np.array([[texel((0.5, 0)), texel((-0.5, 0))]]), (8, 512, 1))).save(path / "fine.png")
    write_levels(path / "cube.qgraph", [subdivide(cube(20.0), 3), subdivide(cube(20.0), 2)], rays=32)
    return path


def waves(folder: Path) -> dict:
    placement = {"centre": (SIZE / 2 * [1, 1, 2]).tolist(), "size": [SIZE[0], SIZE[1], 1.0]}
    return {"image": str(folder / "waves.png"), "placement": placement}


def solved(
    body: Path,
    map_: dict | None,
    device: str = "cpu",
    lights: list | None = None,
    material: str = MATERIAL,
    **solver: object,
):
    """Solution and surface of a scene."""
    with quadgraph.Stage(device=device) as stage:
        picture = {"transmission_roughness": 0} | ({"normal_map": map_} if map_ else {})
        solver = {"correction": False, **solver}
        members = {"material": material, "lights": lights or [LAMP], "solver": solver, "picture": picture}
        stage.show(quadgraph.Scene.from_dict({"body": str(body), **members}))
        solution = stage.solve()
        return solution, stage.engine.surface()


def by_phase(surface) -> np.ndarray:
    """What leaves twelve parts of the middle waves, W for each mm^2 below them."""
    middle, part = surface.position, WAVE / 12
    inner = (np.abs(middle[:, 0] - SIZE[0] / 2) < WAVE) & (np.abs(middle[:, 1] - SIZE[1] / 2) < 2.0)
    upper = inner & (middle[:, 2] > 0.7 * SIZE[2]) & (surface.normal[:, 2] > 0.5)
    bins = (middle[upper, 0] % WAVE / part).astype(int)
    power = np.asarray(surface.exitance)[upper, 0] * surface.area[upper]
    below = surface.area[upper] * surface.normal[upper, 2]
    return np.bincount(bins, power, 12) / np.bincount(bins, below, 12)


def beside_displaced(folder: Path, lights: list, correction: bool) -> tuple[list[float], list[float]]:
    """How far the exitance of the plain slab without and with the map of the waves is off the displaced one's: RMS over
    the parts of a wave, and in all.
    """

    def found(name, map_):
        return by_phase(solved(folder / f"{name}.qgraph", map_, lights=lights, correction=correction)[1])

    displaced, plain, mapped = found("displaced", None), found("plain", None), found("plain", waves(folder))
    off = [float(np.sqrt(np.mean((each - displaced) ** 2)) / displaced.mean()) for each in (plain, mapped)]
    all_ = [float(each.mean() / displaced.mean() - 1) for each in (plain, mapped)]
    print(f"correction {correction}: exitance by places {100 * off[0]:.1f}% off without the map, {100 * off[1]:.1f}%")
    print(f"  with it; in all {100 * all_[0]:+.1f}% and {100 * all_[1]:+.1f}%")
    return off, all_


def sky_of_one_lobe(file: Path) -> dict:
    """An environment that is bright about SLANTED, as the fourth power of the cosine with it."""
    rows, columns = 64, 128
    down, along = (np.arange(rows) + 0.5) / rows * np.pi, ((np.arange(columns) + 0.5) / columns - 0.5) * 2 * np.pi
    towards = np.stack(
        [
            np.sin(down)[:, None] * np.sin(along),
            np.cos(down)[:, None] * np.ones(columns),
            -np.sin(down)[:, None] * np.cos(along),  # the middle is behind the body
        ],
        axis=-1,
    )
    bright = np.maximum(towards @ SLANTED, 0) ** 4
    Image.fromarray(np.repeat(np.round(255 * bright)[..., None], 3, axis=-1).astype(np.uint8)).save(file)
    return {"type": "environment", "file": str(file), "radiance": 1.0}


@pytest.mark.parametrize("correction", [False, True])
def test_light_of_a_sky_enters_by_places_as_by_the_displaced_surface(folder, correction):
    off, all_ = beside_displaced(folder, [sky_of_one_lobe(folder / "lobe.png")], correction)
    assert off[0] > 0.05
    assert off[1] < 0.5 * off[0]
    assert abs(all_[1]) < 0.03


def test_even_light_is_let_in_alike_by_facets_that_lean(folder):
    lights = [{"type": "ambient", "irradiance": 1.0}]
    entered = [
        np.mean(solved(folder / "plain.qgraph", map_, lights=lights, correction=True, sweeps=1)[0].energy.entered)
        for map_ in (None, waves(folder))
    ]
    assert entered[1] == pytest.approx(entered[0], rel=0.01)


@pytest.mark.parametrize(("degrees", "correction"), [(50, False), (50, True), (70, False), (80, False)])
def test_exitance_by_place_is_that_of_the_displaced_surface(folder, degrees, correction):
    off, all_ = beside_displaced(folder, [lamp(towards_at(degrees))], correction)
    assert off[0] > 0.1
    assert off[1] < 0.3 * off[0]
    assert abs(all_[1]) < 0.05


def transmitted(cosine: float) -> float:
    inside = np.sqrt(1 - (1 - cosine**2) / ETA**2)
    s, p = (cosine - ETA * inside) / (cosine + ETA * inside), (ETA * cosine - inside) / (ETA * cosine + inside)
    return 1 - (s**2 + p**2) / 2


def let_in(slopes: np.ndarray, towards: np.ndarray = SLANTED) -> float:
    """By facets of the side towards +z with such slopes, for each mm^2 of the side."""
    across = np.array([*slopes, 1.0])
    met = across @ towards
    return met * transmitted(met / np.linalg.norm(across))


def on_front(surface) -> np.ndarray:
    """What the side towards +z lets in, which is the same everywhere."""
    q = np.asarray(surface.q)[surface.normal[:, 2] > 0.99, 0]
    assert q == pytest.approx(np.full(q.shape, q.mean()), rel=1e-4)
    return q.mean()


def test_a_face_lets_in_what_facets_of_its_map_do(folder):
    map_ = {"image": str(folder / "leaning.png")}
    slopes = slopes_of(LEANING)
    found = [on_front(solved(folder / "cube.qgraph", each)[1]) for each in (None, map_, {**map_, "strength": 0.5})]
    assert found == pytest.approx([let_in(share * slopes) for share in (0, 1, 0.5)], rel=1e-3)
    assert found[1] > 1.2 * found[0]
    fine = {"image": str(folder / "fine.png")}
    assert on_front(solved(folder / "cube.qgraph", fine)[1]) == pytest.approx(found[0], rel=2e-3)
    behind = {**LAMP, "direction": [-1, 0, 0.2]}  # lights no facet, however that leans
    assert on_front(solved(folder / "cube.qgraph", map_, lights=[behind])[1]) == 0


def test_light_from_all_around_enters_by_the_mesh(folder):
    even = [{"type": "ambient", "irradiance": 1.0}]
    map_ = {"image": str(folder / "leaning.png")}
    found = [solved(folder / "cube.qgraph", each, lights=even)[1].exitance for each in (None, map_)]
    assert np.array_equal(*found)


@pytest.mark.parametrize("strength", [1, 10])
def test_waves_let_in_as_much_as_a_plain_side(folder, strength):
    """All of it, where nothing is reflected, however steep they are."""
    found, clear = [], "sigma_s_prime=3,sigma_a=.5,eta=1"
    for map_ in (None, {**waves(folder), "strength": strength}):
        surface = solved(folder / "plain.qgraph", map_, material=clear)[1]
        upper = surface.normal[:, 2] > 0.9
        q = np.asarray(surface.q)[upper, 0]
        found.append(q @ surface.area[upper])
    assert found[1] == pytest.approx(found[0], rel=0.01)
    assert q.min() < 0.8 * q.mean() < 1.2 * q.mean() < q.max() < 2.001 * q.mean()


def test_devices_let_in_the_same(folder):
    found = [solved(folder / "plain.qgraph", waves(folder), device=name)[1] for name in ("cpu", "llvmpipe")]
    for layer in ("q", "exitance"):
        a, b = (np.asarray(getattr(each, layer)) for each in found)
        assert np.abs(a - b).max() < 1e-3 * b.max()


def test_light_goes_on_inside_as_facets_refract_it(folder):
    """Straight at the facets: through these it goes straight on, less deep than through a side that bends it down."""
    slopes = slopes_of(LEANING)
    towards = np.array([*slopes, 1.0]) / np.linalg.norm([*slopes, 1.0])
    found = []
    for map_ in (None, {"image": str(folder / "leaning.png")}):
        surface = solved(folder / "cube.qgraph", map_, lights=[lamp(towards)])[1]
        assert on_front(surface) == pytest.approx(let_in(slopes if map_ else np.zeros(2), towards), rel=1e-3)
        found.append(np.asarray(surface.exitance)[surface.normal[:, 2] > 0.99, 0].mean() / on_front(surface))
    assert found[1] > found[0] * 1.001


def test_a_map_that_turns_with_the_body(folder):
    map_ = {"image": str(folder / "leaning.png")}
    turn = {"type": "transform", "axis": [0, 0, 1], "degrees": 90}
    with quadgraph.Engine(folder / "cube.qgraph", device="cpu") as engine:
        engine.material = MATERIAL
        engine.lights = [quadgraph.DirectionalLight(tuple(LAMP["direction"]), 1.0)]
        engine.set_normal_map(map_)
        engine.set_deformation([turn])
        engine.solve(correction=False)
        x, y = slopes_of(LEANING)
        assert on_front(engine.surface()) == pytest.approx(let_in(np.array([-y, x])), rel=1e-3)
        engine.set_normal_map(None)
        engine.solve(correction=False)
        assert on_front(engine.surface()) == pytest.approx(let_in(np.zeros(2)), rel=1e-3)
        with pytest.raises(InputError, match="strength"):
            engine.set_normal_map({**map_, "strength": 11})


def test_light_enters_by_the_normal_texture_of_the_file(tmp_path):
    body, _ = baked(leaning(tmp_path / "leaning.glb"), tmp_path)
    assert on_front(solved(body, None)[1]) == pytest.approx(let_in(SLOPES), rel=1e-3)
    Image.fromarray(np.tile(COLOUR, (4, 4, 1))).save(tmp_path / "none.png")
    none = {"image": str(tmp_path / "none.png"), "strength": 0}
    assert on_front(solved(body, none)[1]) == pytest.approx(let_in(np.zeros(2)), rel=1e-3)
