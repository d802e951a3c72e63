"""Bodies within another, whose surface they share, held against random walks by which surface a point lies in."""

from __future__ import annotations

from itertools import product
from pathlib import Path

import numpy as np
import pytest

from quadgraph import AmbientLight, DirectionalLight, Engine, Material, VolumeMaterial
from quadgraph.baking.bodies import BodyMesh, bake_bodies
from quadgraph.baking.pipeline import BakeOptions, bake
from shapes import icosphere, moved, torus, write_obj

pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")
pytest.importorskip("numba", reason="the extra `walks` is not installed: run tools/setup")

from quadgraph_validation.truth import mesh_walk
from quadgraph_validation.truth.embedded_medium import embedded_medium

RADIUS = 8.0  # mm
HOSTS = {"ball": icosphere(4, RADIUS)}
STONES = {
    "stone": {"stone": moved(icosphere(3, 3.0), 3.2, 1.0, 0.4)},
    "pebbles": {
        "one": moved(icosphere(3, 1.5), 5.2, 2.0, 0.5),
        "two": moved(icosphere(3, 1.0), -3.0, 5.0, 1.0),
        "three": moved(icosphere(3, 1.2), 2.0, -5.0, -3.0),
        "ring": moved(torus(1.8, 0.6, 48, 24), -3.0, -1.5, 3.0),
    },
}
# Of the ball and of what lies within: sigma_s' five times and sigma_a ten times the ball's, or a fifth and a tenth.
MATERIALS = {
    "dark": (Material(1.0, 0.004, eta=1.4), Material(5.0, 0.04, eta=1.4)),
    "clear": (Material(2.0, 0.03, eta=1.4), Material(0.4, 0.003, eta=1.4)),
}
LIGHTS = {"sun": DirectionalLight((-1.0, -0.4, 0.3), 1.0), "sky": AmbientLight(1.0)}
CELL = 0.08  # mm, of the coefficients that walks go by
CASES = [
    pytest.param(*case, id="-".join(case), marks=() if case == ("dark", "stone", "sun") else pytest.mark.long)
    for case in product(MATERIALS, STONES, LIGHTS)
]


@pytest.fixture(scope="module")
def baked(tmp_path_factory):
    """Files by the names of what lies within the ball; that of the ball alone under ''."""
    folder = tmp_path_factory.mktemp("embedded")
    ball, files = write_obj(HOSTS["ball"], folder / "ball.obj"), {}

    def of(stones: str):
        path = folder / f"{stones}.qgraph"
        if path not in files and not stones:
            bake(ball, path, BakeOptions(unit="mm"))
        elif path not in files:
            shapes = [(name, write_obj(shape, folder / f"{name}.obj")) for name, shape in STONES[stones].items()]
            meshes = [BodyMesh(name, mesh, unit="mm") for name, mesh in [("ball", ball), *shapes]]
            bake_bodies(meshes, path, BakeOptions())
        files[path] = None
        return path

    return of


def patches(middles: np.ndarray) -> np.ndarray:
    """(m,) of each place on the ball one of 32 patches: eight azimuths, four heights."""
    turn = np.floor((np.arctan2(middles[:, 1], middles[:, 0]) + np.pi) / (2 * np.pi) * 8).astype(int).clip(0, 7)
    return 4 * turn + np.floor((middles[:, 2] / RADIUS + 1) * 2).astype(int).clip(0, 3)


class Truth:
    """What walks say of the patches: exitance and its noise, W/mm^2."""

    def __init__(self, medium, light, walks: int, batches: int) -> None:
        surface = HOSTS["ball"].rounded()
        patch = patches(surface.corners.mean(axis=1))
        self.areas = np.bincount(patch, np.linalg.norm(surface.doubled_normals, axis=1) / 2)
        walker = mesh_walk.MeshWalker(surface, medium, light, patch)
        found = np.array([walker.batch(walks, number, seed=5).scattered for number in range(batches)]) / self.areas
        self.exitance, self.noise = found.mean(axis=0), found.std(axis=0, ddof=1) / np.sqrt(batches)

    def off(self, engine: Engine) -> dict[str, tuple[float, float]]:
        """Relative RMS by which patches are off, noise taken away, and that noise; lit and unlit ones."""
        field = engine.surface()
        patch = patches(field.position)
        both = (field.exitance, field.q)
        found, entered = (np.bincount(patch, each[:, 0] * field.area) / self.areas for each in both)
        off = {}
        for part, such in (("lit", entered > 0.3 * entered.max()), ("unlit", entered <= 0.3 * entered.max())):
            if not such.any():  # under a sky
                continue
            size = (self.exitance[such] ** 2 * self.areas[such]).sum()
            noise = np.sqrt((self.noise[such] ** 2 * self.areas[such]).sum() / size)
            raw = ((found - self.exitance)[such] ** 2 * self.areas[such]).sum() / size
            off[part] = float(np.sqrt(max(raw - noise**2, 0))), float(noise)
        return off


def as_volume(path: Path, medium, light, truth: Truth) -> dict[str, tuple[float, float]]:
    """By how much the ball alone is off in the coefficients that walks go by, beside which bodies of a file are."""
    with Engine(path) as engine:
        engine.lights = [light]
        engine.material = VolumeMaterial(medium.sigma_s_prime, medium.sigma_a, CELL, medium.first, medium.eta)
        engine.solve()
        return truth.off(engine)


@pytest.mark.parametrize(("which", "stones", "light"), CASES)
def test_stones_in_a_ball_give_what_walks_say(baked, request, short, which, stones, light):
    around, within = MATERIALS[which]
    medium = embedded_medium(around, [(shape, within) for shape in STONES[stones].values()], CELL)
    quick = not request.node.get_closest_marker("long")
    truth = Truth(medium, LIGHTS[light], *((15_000, 8) if quick else (60_000, 16)))
    with Engine(baked(stones)) as engine:
        engine.lights = [LIGHTS[light]]
        engine.materials = dict.fromkeys(engine.bodies, within) | {"ball": around}
        engine.solve()
        found = truth.off(engine)
        engine.materials = dict.fromkeys(engine.bodies, around)
        engine.solve()
        without = truth.off(engine)
    volume = {} if short else as_volume(baked(""), medium, LIGHTS[light], truth)
    for part, (off, noise) in found.items():
        others = "" if short else f"as a volume {100 * volume[part][0]:.2f}%, "
        others += f"without {100 * without[part][0]:.2f}%"
        print(f"{which} {stones}, {light}, {part}: {100 * off:.2f}% off, {others}, noise {100 * noise:.2f}%")
        assert noise < (0.015 if part == "lit" else 0.03)
        assert off < (0.015 if part == "lit" else 0.03)
        if which == "dark":  # clear ones change less than walks tell
            assert without[part][0] > 2 * off
