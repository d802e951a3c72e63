"""What is left out where a body within another has an index of refraction of its own: walks in two exact balls."""

from __future__ import annotations

import numpy as np
import pytest

from quadgraph import Engine, Material
from quadgraph.baking.bodies import BodyMesh, bake_bodies
from quadgraph.baking.pipeline import BakeOptions
from shapes import icosphere, write_obj

pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")
pytest.importorskip("numba", reason="the extra `walks` is not installed: run tools/setup")

from numba import njit

from quadgraph_validation.truth import walk_kernel

OUTER, INNER = 8.0, 5.0  # mm: balls about one middle
ETA = 1.4
CASES = {  # sigma_s' and sigma_a of the outer ball, and of the inner
    "alike": ((1.0, 0.01), (1.0, 0.01)),
    "dark": ((0.5, 0.002), (2.5, 0.02)),
    "clear": ((1.0, 0.01), (0.2, 0.001)),
}
INDICES = (1.0, 1.3, 1.4, 1.5, 1.7)
WALKS = 60_000


@njit
def _to_sphere(p, d, radius):
    """Distance along d from p to a sphere about 0, ahead of it; infinite where it is missed."""
    along = p @ d
    root = along * along - (p @ p - radius * radius)
    if root <= 0:
        return np.inf
    near, far = -along - np.sqrt(root), -along + np.sqrt(root)
    return near if near > 1e-9 else (far if far > 1e-9 else np.inf)


@njit
def _met(d, normal, here, beyond, state):
    """A direction after a smooth surface, and whether it went through. normal: towards where it goes."""
    cosine = d @ normal
    reflected, through = walk_kernel.fresnel(cosine, here / beyond)
    if walk_kernel.random(state) < reflected:
        return d - 2 * cosine * normal, False
    ratio = here / beyond
    return ratio * d + (through - ratio * cosine) * normal, True


@njit
def _absorbed(count, outer, inner, coefficients, indices, seed):
    """(2,) Weight absorbed of `count` walks that went into the outer ball under an even sky, each of weight 1, and its
    square; coefficients (2, 2): sigma_s' and sigma_a outside and inside; indices (2,).
    """
    state = np.array([seed], np.uint64)
    found = np.zeros(2)
    for _ in range(count):
        normal = np.array([0.0, 0.0, 1.0])
        p, within, weight = outer * normal, False, 1.0
        while True:  # by the cosine; what is mirrored from outside is drawn again
            sine, turn = np.sqrt(walk_kernel.random(state)), 2 * np.pi * walk_kernel.random(state)
            d = np.array([sine * np.cos(turn), sine * np.sin(turn), -np.sqrt(1 - sine * sine)])
            d, entered = _met(d, -normal, 1.0, indices[0], state)
            if entered:
                break
        lost = 0.0
        while weight > 0:
            scattering, absorption = coefficients[int(within)]
            total = scattering + absorption
            free = -np.log(1 - walk_kernel.random(state)) / total
            wall = _to_sphere(p, d, inner)
            out = np.inf if within else _to_sphere(p, d, outer)
            if free < min(wall, out):
                p = p + free * d
                lost += weight * absorption / total
                weight *= scattering / total
                if weight < 0.05:
                    weight = 0.2 if walk_kernel.random(state) * 0.2 < weight else 0.0
                z, turn = 2 * walk_kernel.random(state) - 1, 2 * np.pi * walk_kernel.random(state)
                side = np.sqrt(1 - z * z)
                d = np.array([side * np.cos(turn), side * np.sin(turn), z])
            elif wall < out:
                p = p + wall * d
                towards = p / inner if within else -p / inner
                d, through = _met(d, towards, indices[int(within)], indices[int(not within)], state)
                within = within != through
            else:
                p = p + out * d
                d, through = _met(d, p / outer, indices[0], 1.0, state)
                if through:
                    break
        found += np.array([lost, lost * lost])
    return found


def share_out(case: str, index: float, walks: int) -> tuple[float, float]:
    """Of the light that went in the share that comes out, and its standard deviation."""
    total, square = _absorbed(walks, OUTER, INNER, np.array(CASES[case]), np.array([ETA, index]), 11) / walks
    return 1 - total, np.sqrt(max(square - total**2, 0) / walks)


@pytest.fixture(scope="module")
def balls(tmp_path_factory):
    folder = tmp_path_factory.mktemp("balls")
    shapes = {"outer": icosphere(4, OUTER), "inner": icosphere(4, INNER)}
    meshes = [BodyMesh(name, write_obj(shape, folder / f"{name}.obj"), unit="mm") for name, shape in shapes.items()]
    bake_bodies(meshes, folder / "balls.qgraph", BakeOptions())
    return folder / "balls.qgraph"


@pytest.mark.long
@pytest.mark.parametrize("case", CASES)
def test_a_ball_in_a_ball_of_one_index_lets_out_what_walks_say(balls, case):
    """Of the outer index the engine is right; what another one of the inner ball changes is told."""
    shares = {index: share_out(case, index, WALKS) for index in INDICES}
    with Engine(balls) as engine:
        bodies = zip(("outer", "inner"), CASES[case], strict=True)
        engine.materials = {name: Material(*pair, eta=ETA) for name, pair in bodies}
        engine.lights = ["ambient:1"]
        energy = engine.solve().energy
    found = float(1 - energy.absorbed[0] / energy.entered[0])
    told = ", ".join(f"{index}: {100 * (share / shares[ETA][0] - 1):+.2f}%" for index, (share, _) in shares.items())
    share, noise = shares[ETA]
    print(f"{case}: {found:.4f} comes out, walks {share:.4f} +- {noise:.4f}; by the index of the inner ball {told}")
    assert noise < 0.003
    assert abs(found - share) < 0.01 + 3 * noise
