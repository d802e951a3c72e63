"""Two bodies of different materials beside each other, held against random walks through their triangles."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from quadgraph import AmbientLight, DirectionalLight, Engine, Material
from quadgraph.baking.bodies import BodyMesh, bake_bodies
from quadgraph.baking.pipeline import BakeOptions
from quadgraph.mesh.surface import Surface
from quadgraph_validation.bodies.unseen_cases import UnseenMedium
from shapes import icosphere, torus, write_obj

pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")
pytest.importorskip("numba", reason="the extra `walks` is not installed: run tools/setup")

from quadgraph_validation.truth import mesh_walk

# A ball that looks through a ring: its edge is 0.6 mm from it, all about the x axis.
APART = 5.5  # mm, where one ends
NEXT = 6.1  # and the other begins, along x
PALE, DARK = Material(1.2, 0.004, eta=1.4), Material(0.7, 0.12, eta=1.4)
LIGHTS = {"sun": DirectionalLight((-1.0, -0.4, 0.3), 1.0), "sky": AmbientLight(1.0)}
WALKS, BATCHES = 40_000, 12  # half as many walks where long studies are left out


def ring() -> Surface:
    """About the x axis, from NEXT on."""
    turned = torus(6.5, 2.5, 40, 20).vertices[:, [2, 0, 1]]
    return Surface(turned + np.array([NEXT + 2.5, 0, 0]), torus(6.5, 2.5, 40, 20).triangles)


@pytest.fixture(scope="module")
def pair(tmp_path_factory):
    """The file of both, and its finest surface as one, ball first."""
    folder = tmp_path_factory.mktemp("pair")
    shapes = {"ball": icosphere(3, APART), "ring": ring()}
    meshes = [BodyMesh(name, write_obj(shape, folder / f"{name}.obj"), unit="mm") for name, shape in shapes.items()]
    bake_bodies(meshes, folder / "pair.qgraph", BakeOptions(for_materials=(PALE.text, DARK.text)))
    with Engine(folder / "pair.qgraph") as engine:
        level = engine._engine.graph.levels[0]
        surface = Surface(np.array(level.vertices, np.float64), np.array(level.faces, np.int64))
        return folder / "pair.qgraph", surface, np.array(level.tet_bodies[level.face_tets])


def split_medium(left: Material, right: Material) -> UnseenMedium:
    """One material up to APART, the other from NEXT on."""
    pairs = (np.array([left.sigma_s_prime, right.sigma_s_prime]), np.array([left.sigma_a, right.sigma_a]))
    arrays = (np.float32(each.reshape(-1)[:2] if each.ndim == 1 else each[:, 0])[None, None, :] for each in pairs)
    return UnseenMedium("two", left.eta, *arrays, first=(APART, 0.0, 0.0), spacing=NEXT - APART)


def pairs() -> list:
    """Materials of ball and ring: at one index of refraction, and at two."""
    alike = {"pale-ball": (PALE, DARK), "dark-ball": (DARK, PALE)}  # of one index, which two say all the more of
    found = [pytest.param(*both, id=name, marks=pytest.mark.long) for name, both in alike.items()]
    for low, high, long in ((1.3, 1.6, False), (1.0, 1.5, True)):
        for ball, other in ((low, high), (high, low)):
            for one, two, name in ((PALE, DARK, "pale"), (DARK, PALE, "dark")):
                marks = pytest.mark.long if long or name == "dark" or ball == high else ()
                both = replace(one, eta=ball), replace(two, eta=other)
                found.append(pytest.param(*both, id=f"{name}-ball-{ball}-ring-{other}", marks=marks))
    return found


@pytest.mark.parametrize("light", ["sun", pytest.param("sky", marks=pytest.mark.long)])
@pytest.mark.parametrize(("ball", "other"), pairs())
def test_two_bodies_give_what_walks_say(pair, short, ball, other, light):
    path, surface, body = pair
    patch = patches(surface, body)
    eta = np.where(body == 0, ball.eta, other.eta)
    walker = mesh_walk.MeshWalker(surface, split_medium(ball, other), LIGHTS[light], patch, eta=eta)
    walks = WALKS // 2 if short else WALKS
    batches = np.array([walker.batch(walks, number, seed=5).scattered for number in range(BATCHES)])
    areas = np.bincount(patch, np.linalg.norm(surface.doubled_normals, axis=1) / 2)
    true, noise = batches.mean(axis=0) / areas, batches.std(axis=0, ddof=1) / np.sqrt(BATCHES) / areas
    with Engine(path) as engine:
        engine.materials = {"ball": ball, "ring": other}
        engine.lights = [LIGHTS[light]]
        engine.solve()
        field = engine.surface()
    of_patch = np.round(np.bincount(patch, body) / np.bincount(patch))
    power = np.bincount(patch, field.exitance[:, 0] * field.area)
    found = power / areas
    entered = np.bincount(patch, field.q[:, 0] * field.area) / areas
    for which, name in enumerate(("ball", "ring")):
        mine = of_patch == which
        lit, dim = mine & (entered > 0.3 * entered[mine].max()), mine & (entered <= 0.3 * entered[mine].max())
        for part, such in (("lit", lit), ("unlit", dim)):
            if not such.any():  # under a sky
                continue
            size = (true[such] ** 2 * areas[such]).sum()
            noisy = np.sqrt((noise[such] ** 2 * areas[such]).sum() / size)
            off = np.sqrt(max(((found - true)[such] ** 2 * areas[such]).sum() / size - noisy**2, 0))
            print(f"{name}, {light}, {part}: {100 * off:.2f}% off, noise {100 * noisy:.2f}%, {such.sum()} patches")
            assert noisy < (0.02 if part == "lit" else 0.04)
            assert off < (0.03 if part == "lit" else 0.05)


def patches(surface: Surface, body: np.ndarray) -> np.ndarray:
    """Patches of a surface, none of which is of both bodies."""
    middle, normal = surface.corners.mean(axis=1), surface.doubled_normals
    turn = np.arctan2(middle[:, 2], middle[:, 1])
    along = middle[:, 0] > np.where(body == 0, 0.0, NEXT + 2.5)
    outer = np.where(body == 0, middle[:, 0] > APART / 2, (normal[:, 1:] * middle[:, 1:]).sum(axis=1) > 0)
    number = np.floor((turn + np.pi) / (2 * np.pi) * 8).astype(int).clip(0, 7) * 4 + 2 * along + outer
    return np.unique(2 * number + body, return_inverse=True)[1]
