"""Walks from a camera through bodies that differ from place to place, held against what is known exactly."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.interpolate import RegularGridInterpolator
from scipy.special import expn

from quadgraph.mesh.surface import Surface
from shapes import cube, icosphere

pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")
camera_walks = pytest.importorskip("quadgraph_validation.truth.camera_walks", reason="needs the extra walks")
known_material = pytest.importorskip("quadgraph_validation.truth.known_material")

RADIUS = 10.0
AMBIENT = {"type": "ambient", "irradiance": np.pi}  # of radiance 1
KEY = {"type": "rectangle", "centre": [0, 50, 50], "u": [120, 0, 0], "v": [0, -80, 80], "power": 40000.0}
ERRORS = 4.5  # standard ones, which chance passes once in 150,000


def material(sigma_s: np.ndarray, sigma_a: np.ndarray, eta: float, first: np.ndarray, spacing: float):
    """Grey coefficients (nz, ny, nx) on a grid."""
    grey = (np.repeat(each[..., None], 3, axis=3) for each in (sigma_s, sigma_a))
    return known_material.KnownMaterial(*grey, eta, np.asarray(first, float), np.full(3, spacing))


def see(surface, lights, found, eye, walks: int, seed: int = 5):
    """A picture in green."""
    walker = camera_walks.CameraWalker(surface, lights)
    return walker.see(eye, 1, found.in_channel(1), found.eta, walks, seed, lambda _share: None)


def straight(pixels: int, width: float) -> camera_walks.Eye:
    """An eye whose rays are parallel within a 500th and meet `width` mm around the origin along -z."""
    fov = 2 * np.degrees(np.arctan(width / 2 / 5000))
    return camera_walks.Eye(np.array([0.0, 0.0, 5000.0]), np.zeros(3), fov, "y", pixels, pixels)


def test_a_constant_volume_looks_like_one_material_throughout():
    """It is denser only beside the ball, so that many collisions are none."""
    eye = camera_walks.Eye(np.array([0.0, 0.0, 60.0]), np.zeros(3), 24.0, "y", 16, 16)
    sigma_s, sigma_a = np.full((11, 11, 11), 0.8), np.full((11, 11, 11), 0.05)
    sigma_s[:, :, 0] = sigma_a[0] = 4.0  # at 15 mm from the middle
    there = material(sigma_s, sigma_a, 1.3, np.full(3, -15.0), 3.0)
    even = known_material.KnownMaterial.even(np.full(3, 0.8), np.full(3, 0.05), 1.3)
    pictures = [see(icosphere(3, RADIUS), [KEY, AMBIENT], each, eye, 256) for each in (there, even)]
    for k in range(2):
        for half in (slice(0, 8), slice(8, 16)):
            off = pictures[0].radiance[k, half].sum() - pictures[1].radiance[k, half].sum()
            error = np.sqrt(sum((each.noise[k, half] ** 2).sum() for each in pictures))
            assert error < 0.05 * pictures[1].radiance[k, half].sum()
            assert abs(off) < ERRORS * error


def test_without_absorption_all_is_seen_but_what_crosses_unscattered():
    """In uniform light, index-matched: what scatters brings the light around, the rest is not in the picture."""
    nodes = np.linspace(-RADIUS, RADIUS, 6)
    z, y, x = np.meshgrid(nodes, nodes, nodes, indexing="ij")
    sigma_s = 0.3 * np.exp(-((x - 4) ** 2 + y**2 + (z - 3) ** 2) / 18) + 0.005 * (1 + np.abs(y) / 2)
    found = material(sigma_s, np.zeros_like(sigma_s), 1.0, np.full(3, -RADIUS), nodes[1] - nodes[0])
    seen = see(cube(2 * RADIUS), [AMBIENT], found, straight(8, 12.0), 1024)
    depth = RegularGridInterpolator((nodes, nodes), np.trapezoid(sigma_s, nodes, axis=0))  # at y, x
    fine = 6 - (np.arange(128) + 0.5) * 12 / 128
    scattered = 1 - np.exp(-depth(np.stack(np.meshgrid(fine, -fine, indexing="ij"), axis=-1)))
    expected = scattered.reshape(8, 16, 8, 16).mean(axis=(1, 3))
    assert expected.max() > 3 * expected.min()
    np.testing.assert_array_less(np.abs(seen.radiance[0] - expected), ERRORS * seen.noise[0] + 1e-3)


def test_layers_look_as_their_integral_equation_says():
    """Scattering and absorption go with depth in a wide index-matched plate under uniform light."""
    depth, edge, cells = 2.0, 40.0, 9
    nodes = np.linspace(0, depth, cells)  # below the upper face
    sigma_s = np.array([0.6, 4.0, 0.2, 2.0, 3.0, 0.4, 5.0, 0.3, 1.0])
    sigma_a = np.array([0.1, 0.0, 1.2, 0.2, 0.05, 2.0, 0.0, 0.5, 1.0])
    body = Surface(cube().vertices * [edge, edge, depth], cube().triangles)
    grid = (each[::-1, None, None] for each in (sigma_s, sigma_a))
    found = material(*grid, 1.0, np.array([3.0, -7.0, -depth / 2]), depth / (cells - 1))
    seen = see(body, [AMBIENT], found, straight(8, 4.0), 1600)
    expected = plate(nodes, sigma_s, sigma_a)
    mean, error = seen.radiance[0].mean(), np.sqrt((seen.noise[0] ** 2).sum()) / seen.noise[0].size
    assert error < 0.01 * expected
    assert abs(mean - expected) < ERRORS * error + 1e-3 * expected


def plate(nodes: np.ndarray, sigma_s: np.ndarray, sigma_a: np.ndarray) -> float:
    """Scattered radiance straight out of layers under radiance 1 from all around, by Peierls' integral equation.

    nodes: depths, mm, between which coefficients, 1/mm, are linear. The source is constant in each of 400 steps.
    """
    edges = np.linspace(nodes[0], nodes[-1], 401)
    middles = (edges[1:] + edges[:-1]) / 2
    scattering, absorption = (np.interp(middles, nodes, each) for each in (sigma_s, sigma_a))
    tau = np.concatenate([[0], np.cumsum((scattering + absorption) * np.diff(edges))])
    at = (tau[1:] + tau[:-1]) / 2
    away = tau - at[:, None]
    within = np.sign(away) * (1 - expn(2, np.abs(away)))
    albedo = scattering / (scattering + absorption)
    entering = albedo * (expn(2, at) + expn(2, tau[-1] - at)) / 2
    source = np.linalg.solve(np.eye(400) - albedo[:, None] * np.diff(within, axis=1) / 2, entering)
    return float(source @ -np.diff(np.exp(-tau)))
