"""The analytic dipole: its integrals, the matrix on a mesh, and its picture beside the engine's."""

from __future__ import annotations

import numpy as np
import pytest

from quadgraph_validation.bodies.scenes import FOV, PIXELS, View
from quadgraph_validation.chart.dipole import Dipole, transport
from quadgraph_validation.chart.pixels import hits

MEDIA = [(2.19, 0.0021, 1.5), (0.74, 0.032, 1.3), (1.0, 0.01, 1.0), (0.18, 0.061, 1.3)]  # 1/mm, 1/mm, index


def dipole(medium) -> Dipole:
    sigma_s_prime, sigma_a, eta = medium
    return Dipole(np.array(sigma_s_prime), np.array(sigma_a), eta)


@pytest.mark.parametrize("medium", MEDIA)
def test_reflectance_over_the_plane_is_the_closed_form(medium):
    found = dipole(medium)
    logarithm = np.linspace(np.log(1e-5), np.log(1e4), 2000)  # where it vanishes at both ends, sums are exact
    r = np.exp(logarithm)
    integral = (2 * np.pi * r**2 * found.reflectance(r)).sum() * (logarithm[1] - logarithm[0])
    assert integral == pytest.approx(float(found.total()), rel=1e-6)


def test_without_absorption_all_light_comes_back():
    assert float(dipole((1.0, 1e-12, 1.3)).total()) == pytest.approx(1, abs=1e-5)


def test_jensens_numbers():
    """Skin and marble of Jensen et al. 2001, figure 5: diffuse reflectance of the red channel at index 1.3 and 1.5."""
    assert float(dipole((0.74, 0.032, 1.3)).total()) == pytest.approx(0.44, abs=0.02)
    assert float(dipole((2.19, 0.0021, 1.5)).total()) == pytest.approx(0.83, abs=0.02)


def plate(edge: float, count: int) -> tuple[np.ndarray, np.ndarray]:
    """A square about the origin: corners of its triangles (n, 3, 3), and points well within."""
    at = np.linspace(-edge / 2, edge / 2, count + 1)
    x, y = (value.ravel() for value in np.meshgrid(at[:-1], at[:-1]))
    h = edge / count

    def corner(u, v):
        return np.column_stack([x + u * h, y + v * h, 0 * x])

    lower = np.stack([corner(0, 0), corner(1, 0), corner(1, 1)], axis=1)
    upper = np.stack([corner(0, 0), corner(1, 1), corner(0, 1)], axis=1)
    points = np.array([[0.0, 0, 0], [h / 3, h / 2, 0], [h, 2 * h, 0]])
    return np.concatenate([lower, upper]), points


@pytest.mark.parametrize("size", [0.5, 1.5])
def test_even_light_on_a_large_plate_gives_back_the_total(size):
    """Elements of half and of one and a half mean free paths; the plate is many diffusion lengths wide."""
    sigma_s_prime, sigma_a, eta = 1.0, 0.05, 1.3
    edge = 60.0
    corners, points = plate(edge, int(edge / size * (sigma_s_prime + sigma_a)))
    columns = (np.full(len(points), value) for value in (sigma_s_prime, sigma_a))
    medium = Dipole(*columns, eta)
    matrix = transport(medium, points, corners)
    assert matrix.shape == (len(points), len(corners))
    assert np.allclose(matrix.sum(axis=1), medium.total(), rtol=0.02 if size > 1 else 2e-3)


def test_a_point_has_its_own_medium():
    corners, points = plate(20.0, 20)
    media = Dipole(np.array([1.0, 2.0, 0.5]), np.array([0.01, 0.2, 0.05]), 1.0)
    together = transport(media, points, corners)
    for i in range(3):
        alone = Dipole(media.sigma_s_prime[i : i + 1], media.sigma_a[i : i + 1], 1.0)
        assert np.allclose(together[i], transport(alone, points[i : i + 1], corners)[0], rtol=1e-6)


@pytest.mark.parametrize("eta", [1.0, 1.3])
def test_a_picture_without_the_engine_is_the_engines(eta, small_bunny):
    core = pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")
    engine = core.Engine(small_bunny)
    engine.set_material(f"sigma_s_prime=1,sigma_a=0.01,eta={eta}")
    engine.set_lights(["directional:-0.5,-0.5,-0.7:1"])
    engine.solve(model="diffusion", tolerance=1e-2, inter_reflection=False)
    view = View(20, 15, 230, ())
    size = {"width": PIXELS, "height": PIXELS, "samples": 4}
    theirs = engine.render(view=view.text, vertical_fov=FOV, radiance="lambertian", **size)
    from quadgraph.file import qgraph_file
    from quadgraph.mesh.surface import Surface

    file = qgraph_file.read(small_bunny).sections
    shown = Surface(file["display/vertices"].astype(float), file["display/triangles"].astype(np.int64))
    rays = hits(shown, file["display/normals"], view)
    alpha = rays.shown(shown.triangles, np.ones((len(shown.vertices), 1)))[..., 0]
    assert np.abs(alpha - np.asarray(theirs.alpha)).mean() < 2e-3
    exitance = np.asarray(engine.vertex_exitance(), np.float64)
    faces = file["level0/faces"]
    on_display = np.einsum("ik,ikc->ic", file["display/barycentric"], exitance[faces[file["display/face"]]])
    ours = rays.lambertian(shown.triangles, on_display, eta)
    inside = (alpha > 0.999) & (np.asarray(theirs.alpha) > 0.999)
    difference = (ours - np.asarray(theirs.scattered))[inside]
    assert np.sqrt((difference**2).mean() / (np.asarray(theirs.scattered)[inside] ** 2).mean()) < 0.01
