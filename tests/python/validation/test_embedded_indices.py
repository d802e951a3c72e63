"""A body within another that has an index of refraction of its own: beside walks in two exact balls."""

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
INDICES = (1.0, 1.2, 1.5, 1.8)
WALKS = 150_000
BANDS = 4  # of the surface, as wide along the sun's way: from what lies behind to what faces it


@njit(cache=True)
def _to_sphere(p, d, radius):
    """Distance along d from p to a sphere about 0, ahead of it; infinite where it is missed."""
    along = p @ d
    root = along * along - (p @ p - radius * radius)
    if root <= 0:
        return np.inf
    near, far = -along - np.sqrt(root), -along + np.sqrt(root)
    return near if near > 1e-9 else (far if far > 1e-9 else np.inf)


@njit(cache=True)
def _met(d, normal, here, beyond, state):
    """A direction after a smooth surface, and whether it went through. normal: towards where it goes."""
    cosine = d @ normal
    reflected, through = walk_kernel.fresnel(cosine, here / beyond)
    if walk_kernel.random(state) < reflected:
        return d - 2 * cosine * normal, False
    ratio = here / beyond
    return ratio * d + (through - ratio * cosine) * normal, True


@njit(cache=True)
def _start(sun, radius, state):
    """A place on the outer ball and a direction outside, of the sun along -z or of an even sky."""
    if sun:
        away, turn = radius * np.sqrt(walk_kernel.random(state)), 2 * np.pi * walk_kernel.random(state)
        p = np.array([away * np.cos(turn), away * np.sin(turn), np.sqrt(radius * radius - away * away)])
        return p, np.array([0.0, 0.0, -1.0])
    sine, turn = np.sqrt(walk_kernel.random(state)), 2 * np.pi * walk_kernel.random(state)
    d = np.array([sine * np.cos(turn), sine * np.sin(turn), -np.sqrt(1 - sine * sine)])
    return np.array([0.0, 0.0, radius]), d


@njit(cache=True)
def _left(count, sun, outer, inner, coefficients, indices, bands, seed):
    """(bands, 2) Power that leaves after it has scattered by bands of the surface along z, of `count` walks that went
    into the outer ball, each of power 1, and its square; coefficients (2, 2): sigma_s' and sigma_a outside and inside;
    indices (2,).
    """
    state = np.array([seed], np.uint64)
    found = np.zeros((bands, 2))
    for _ in range(count):
        within, weight, scattered = False, 1.0, False
        while True:  # what is mirrored from outside is drawn again
            p, d = _start(sun, outer, state)
            d, entered = _met(d, -p / outer, 1.0, indices[0], state)
            if entered:
                break
        while weight > 0:
            scattering, absorption = coefficients[int(within)]
            total = scattering + absorption
            free = -np.log(1 - walk_kernel.random(state)) / total
            wall = _to_sphere(p, d, inner)
            out = np.inf if within else _to_sphere(p, d, outer)
            if free < min(wall, out):
                p = p + free * d
                weight *= scattering / total
                scattered = True
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
                    band = min(int((p[2] / outer + 1) / 2 * bands), bands - 1)
                    if scattered:
                        found[band] += np.array([weight, weight * weight])
                    break
    return found


def walked(case: str, index: float, sun: bool) -> tuple[np.ndarray, np.ndarray]:
    """Shares of the light that went in that leave by each band, and their standard errors."""
    found = _left(WALKS, sun, OUTER, INNER, np.array(CASES[case]), np.array([ETA, index]), BANDS, 11) / WALKS
    return found[:, 0], np.sqrt(np.maximum(found[:, 1] - found[:, 0] ** 2, 0) / WALKS)


@pytest.fixture(scope="module")
def balls(tmp_path_factory):
    folder = tmp_path_factory.mktemp("balls")
    shapes = {"outer": icosphere(4, OUTER), "inner": icosphere(4, INNER)}
    meshes = [BodyMesh(name, write_obj(shape, folder / f"{name}.obj"), unit="mm") for name, shape in shapes.items()]
    bake_bodies(meshes, folder / "balls.qgraph", BakeOptions())
    with Engine(folder / "balls.qgraph", device="cpu") as engine:
        yield engine


def solved(engine, case: str, index: float, sun: bool, **options) -> np.ndarray:
    """The same shares by the engine."""
    bodies = zip(("outer", "inner"), CASES[case], (ETA, index), strict=True)
    engine.materials = {name: Material(*pair, eta=eta) for name, pair, eta in bodies}
    engine.lights = ["directional:0,0,-1:1"] if sun else ["ambient:1"]
    entered = engine.solve(**options).energy.entered[0]
    field = engine.surface()
    height = field.position[:, 2] / np.linalg.norm(field.position, axis=1)
    band = np.minimum(((height + 1) / 2 * BANDS).astype(int), BANDS - 1)
    return np.bincount(band, field.exitance[:, 0] * field.area, BANDS) / entered


def percent(values: np.ndarray) -> str:
    return " ".join(f"{100 * value:+.1f}" for value in np.atleast_1d(values))


def long_but(case: str, index: float):
    return pytest.param(case, index, marks=() if (case, index) == ("clear", 1.0) else pytest.mark.long)


rows = pytest.mark.parametrize(("case", "index"), [long_but(case, index) for case in CASES for index in INDICES])


def all_of(share: np.ndarray, noise: np.ndarray) -> tuple[float, float]:
    return share.sum(), float(np.sqrt((noise**2).sum()))


@rows
def test_what_an_index_within_changes_in_the_sun_is_what_walks_say(balls, case, index):
    """Of the exitance by bands, against that with one index, where flat faces matter as much."""
    (share, noise), (alike, its_noise) = walked(case, index, sun=True), walked(case, ETA, sun=True)
    wanted, by_noise = share / alike - 1, np.hypot(noise / share, its_noise / alike)
    one = solved(balls, case, ETA, sun=True)
    found = solved(balls, case, index, sun=True, certify=4.0) / one - 1
    certificate = balls.solution.certificate
    alone, of_one = (solved(balls, case, eta, sun=True, correction=False) for eta in (index, ETA))
    print(
        f"{case}, {index}: from behind to the front {percent(found)}, walks {percent(wanted)} +- {percent(by_noise)}, "
        f"uncorrected {percent(alone / of_one - 1)}"
    )
    assert (np.abs(found - wanted) < 0.015 + 3 * by_noise).all()
    assert abs(certificate.unlit.power) < 0.03 + 3 * certificate.unlit.power_noise


@pytest.mark.long
@rows
def test_what_an_index_within_changes_in_all_is_what_walks_say(balls, case, index):
    (share, noise), (alike, its_noise) = all_of(*walked(case, index, False)), all_of(*walked(case, ETA, False))
    found = solved(balls, case, index, sun=False).sum() / solved(balls, case, ETA, sun=False).sum() - 1
    print(f"{case}, {index}, even light: {100 * found:+.2f}%, walks {100 * (share / alike - 1):+.2f}%")
    assert abs(found - (share / alike - 1)) < 0.003 + 3 * np.hypot(noise, its_noise) / alike


@pytest.mark.long
@pytest.mark.parametrize("case", CASES)
def test_a_ball_in_a_ball_of_one_index_lets_out_what_walks_say(balls, case):
    share, noise = all_of(*walked(case, ETA, sun=False))
    found = solved(balls, case, ETA, sun=False).sum()
    print(f"{case}: {found:.4f} comes out, walks {share:.4f} +- {noise:.4f}")
    assert noise < 0.003
    assert abs(found - share) < 0.01 + 3 * noise
