"""Rough surfaces beside the random walk over their facets [Heitz 2016], which loses no light."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from baked import write_levels
from quadgraph import Engine, Picture, core
from quadgraph.mesh.surface import Surface
from shapes import icosphere

pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")
camera_walks = pytest.importorskip("quadgraph_validation.truth.camera_walks", reason="needs the extra walks")
known_material = pytest.importorskip("quadgraph_validation.truth.known_material")
microsurface = pytest.importorskip("quadgraph_validation.truth.microsurface")
fresnel = pytest.importorskip("quadgraph_validation.truth.fresnel")

AMBIENT = {"type": "ambient", "irradiance": 1.0}
UP = np.array([0.0, 0.0, 1.0])
PIXELS, BLOCK, WALKS, RADIUS = 32, 4, 1000, 10.0
EYE = np.array([0.0, 12.0, 50.0])
FOV = float(2.1 * np.degrees(np.arcsin(RADIUS / np.linalg.norm(EYE))))


def through(cosine: float, inside: bool, eta: float, alpha: float, count: int = 20000) -> tuple[float, np.ndarray]:
    """Share of walks that go through the surface at that cosine of incidence, and where all of them go on (n, 3)."""
    state = np.array([7], np.uint64)
    sine = float(np.sqrt(1 - cosine**2))
    way = (sine, 0.0, cosine if inside else -cosine)
    found = [microsurface.at_rough_face(UP, *way, inside, eta, alpha, state) for _ in range(count)]
    return float(np.mean([each[3] for each in found])), np.array([each[:3] for each in found])


@pytest.mark.parametrize("inside", [False, True])
def test_a_slightly_rough_surface_is_next_to_a_smooth_one(inside):
    for cosine in (0.9, 0.5):
        share, ways = through(cosine, inside, 1.4, 0.01)
        smooth = fresnel.reflectance_from_inside(cosine, 1.4) if inside else None
        wanted = 1 - smooth if inside else fresnel.transmittance_from_outside(cosine, 1.4)
        assert share == pytest.approx(float(wanted), abs=0.015)
        assert np.allclose(np.linalg.norm(ways, axis=1), 1)


def test_walks_end_on_the_side_that_they_go_to():
    for inside in (False, True):
        _, ways = through(0.3, inside, 1.5, 0.8, 4000)
        state = np.array([3], np.uint64)
        way = (np.sqrt(1 - 0.3**2), 0.0, 0.3 if inside else -0.3)
        for _ in range(4000):
            *_, z, crossed = microsurface.at_rough_face(UP, *way, inside, 1.5, 0.8, state)
            assert (z > 0) == (inside == crossed)
        assert np.isfinite(ways).all()


def test_diffuse_light_goes_through_either_way_by_reciprocity():
    """What uniform light from outside sends in is eta^2 times what uniform light from inside sends out."""
    eta, alpha, steps = 1.4, 0.5, 12
    cosines = np.sqrt((np.arange(steps) + 0.5) / steps)  # each as much of the irradiance
    ways_in = np.mean([through(float(c), False, eta, alpha, 6000)[0] for c in cosines])
    ways_out = np.mean([through(float(c), True, eta, alpha, 6000)[0] for c in cosines])
    assert ways_in == pytest.approx(eta**2 * ways_out, rel=0.03)


@pytest.mark.parametrize(("eta", "alpha"), [(1.3, 0.1), (1.5, 0.3), (1.4, 0.6)])
def test_solves_know_what_the_walk_lets_through(eta, alpha):
    """From either side at any angle, and by the moments that boundaries are made of."""
    table = np.array(core.rough_boundary(eta, alpha))
    outside, inside = table[:33], table[66:]
    points, weights = np.polynomial.legendre.leggauss(12)
    cosines, weights = (points + 1) / 2, weights / 2
    known_in = 1 - np.interp(np.sqrt(cosines), np.linspace(0, 1, 33), outside)
    known_out = 1 - np.interp(cosines, np.linspace(0, 1, 129), inside)
    walked_in, walked_out = (
        np.array([through(float(c), side, eta, alpha)[0] for c in cosines]) for side in (False, True)
    )
    assert np.abs(known_in - walked_in).max() < 0.015
    assert np.sqrt(2 * (weights * cosines * (known_out - walked_out) ** 2).sum()) < 0.015
    for n in (1, 2, 3):
        moment = float((weights * cosines**n * (1 - walked_out)).sum())
        assert core.fresnel_moment(n, eta, alpha) == pytest.approx(moment, rel=0.015)


def blocks(picture: np.ndarray) -> np.ndarray:
    """(h, w): means over blocks of pixels."""
    side = PIXELS // BLOCK
    return picture.reshape(side, BLOCK, side, BLOCK).mean(axis=(1, 3))


def taken(tmp_path: Path, surface: Surface, material: str, **options) -> list[Picture]:
    """By the engine in even light, in and out by each roughness of `alphas`."""
    write_levels(tmp_path / "body.qgraph", [surface], rays=64)
    camera = {"eye": tuple(EYE), "look_at": (0.0, 0.0, 0.0), "fov": FOV, "up": "y"}
    alphas = options.pop("alphas")
    with Engine(tmp_path / "body.qgraph", device=options.pop("device", "cpu")) as engine:
        engine.material = material
        engine.lights = ["ambient:1"]
        size = {"width": PIXELS, "height": PIXELS}
        pictures = []
        for alpha in alphas:
            engine.set_light_roughness(alpha)
            engine.solve(**options)
            pictures.append(engine.render(camera, **size, transmission_roughness=alpha))
        return pictures


def errors(
    tmp_path: Path, surface: Surface, walks: int, alpha: float, sigma_s: float, sigma_a: float, eta: float
) -> dict:
    """Relative RMS over blocks that the body fills, and at its rim, without the walks' noise: as rough, and smooth."""
    even = known_material.KnownMaterial.even(np.full(3, sigma_s), np.full(3, sigma_a), eta)
    eye = camera_walks.Eye(EYE.copy(), np.zeros(3), FOV, "y", PIXELS, PIXELS)
    walker = camera_walks.CameraWalker(surface, [AMBIENT])
    truth = walker.see(eye, 0, even.in_channel(0), eta, walks, 8, lambda _share: None, roughness=alpha)
    text = f"sigma_s_prime={sigma_s},sigma_a={sigma_a},eta={eta}"
    rough, smooth = taken(tmp_path, surface, text, alphas=(alpha, 0))
    covered = blocks(rough.alpha)
    result = {}
    for name, part in (("filled", covered > 0.999), ("rim", (covered > 0.3) & (covered <= 0.999))):
        wanted, noise = blocks(truth.radiance[0])[part], (blocks(truth.noise[0] ** 2)[part] / BLOCK**2).sum()
        for way, picture in (("rough", rough), ("smooth", smooth)):
            off = ((blocks(picture.scattered[..., 0])[part] - wanted) ** 2).sum() - noise
            result[name, way] = float(np.sqrt(max(off, 0) / ((wanted**2).sum() - noise)))
    print({" ".join(key): f"{100 * value:.1f}%" for key, value in result.items()})
    return result


def test_the_rim_of_a_dense_body_is_as_bright_as_walks_have_it(tmp_path, short):
    found = errors(tmp_path, icosphere(3, RADIUS), WALKS // 2 if short else WALKS, 0.3, 1.0, 0.01, 1.4)
    assert found["filled", "rough"] < 0.015
    assert found["rim", "rough"] < 0.02
    assert found["rim", "smooth"] > 2 * found["rim", "rough"]


def test_a_clear_lens_is_frosted(tmp_path, short):
    ball = icosphere(3, RADIUS)
    lens = Surface(ball.vertices * (1, 1, 0.25), ball.triangles)
    found = errors(tmp_path, lens, WALKS // 2 if short else WALKS, 0.3, 0.06, 0.02, 1.5)
    assert found["filled", "rough"] < 0.03
    assert found["filled", "smooth"] > 5 * found["filled", "rough"]


@pytest.mark.parametrize("eta", [1.2, 1.5])
def test_the_unlit_side_is_what_walks_from_facet_to_facet_find(tmp_path, eta):
    """At grazing incidence most light meets several facets before it is inside, and goes deeper than by the first."""
    write_levels(tmp_path / "ball.qgraph", [icosphere(3, RADIUS)], rays=64)
    with Engine(tmp_path / "ball.qgraph", device="cpu") as engine:
        engine.material = f"sigma_s_prime=0.3,sigma_a=0.3,eta={eta}"
        engine.lights = ["directional:0.5,-0.5,-1:2.5"]
        engine.set_light_roughness(0.6)
        certificate = engine.solve(certify=3).certificate
    assert abs(certificate.whole.power) < 0.01 + 3 * certificate.whole.power_noise
    assert abs(certificate.unlit.power) < 0.03 + 3 * certificate.unlit.power_noise
