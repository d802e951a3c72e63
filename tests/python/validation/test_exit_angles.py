"""Light by the angle at which it leaves a slab: random walks, exact transport and Chandrasekhar against each other."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import integrate

from quadgraph_validation.bodies.media import Medium
from quadgraph_validation.truth import exit_angles, monte_carlo
from quadgraph_validation.truth.exit_angles import BIN_AREA, BINS
from quadgraph_validation.truth.fresnel import gauss
from quadgraph_validation.truth.slab_transport import discrete_ordinates, radiance_by_angle

WALKS = 40_000
SLABS = [
    (albedo, depth, eta, cosine)
    for albedo in (0.999, 0.9, 0.5)
    for depth in (12.0, 2.0)
    for eta in (1.0, 1.3)
    for cosine in (1.0, 0.3)
]


def medium_of(albedo: float, sigma_t: float = 1.0) -> Medium:
    return Medium(sigma_t * albedo, sigma_t * (1 - albedo))


@pytest.mark.parametrize(("albedo", "depth", "eta", "cosine"), SLABS)
def test_walks_agree_with_exact_transport_in_every_bin(albedo, depth, eta, cosine):
    """Down to a transmittance of 1e-6: what the splitting is for."""
    found = exit_angles.slab(medium_of(albedo), depth, eta, cosine, WALKS, seed=1)
    exact = radiance_by_angle(medium_of(albedo), depth, eta, cosine)
    for side, truth in zip((found.lit, found.unlit), exact, strict=True):
        deviation = (side.mean - truth) / side.error
        print(np.round(deviation, 1))
        assert np.abs(deviation[2:]).max() < 5  # with 25 batches Student's t: 5 is 1 in 20000
        assert np.sqrt((deviation[2:] ** 2).mean()) < 2
        assert (side.error[2:] < 0.25 * truth[2:]).all()


def h_function(albedo: float, cosine: float) -> float:
    """Chandrasekhar's H for isotropic scattering, by its integral."""
    integrand = lambda t: np.log(1 - albedo * np.arctan(t) / t) / (1 + (cosine * t) ** 2)  # noqa: E731
    return float(np.exp(-cosine / np.pi * integrate.quad(integrand, 0, np.inf, limit=500)[0]))


@pytest.mark.parametrize("cosine", [1.0, 0.3])
@pytest.mark.parametrize("albedo", [0.97, 0.9, 0.5])
def test_half_space_reflects_as_chandrasekhar_says(albedo, cosine):
    """L = albedo H(mu) H(mu0) / (4 pi (mu + mu0)) per irradiance, without an index step."""
    depth = 20.0
    expected = []
    for low in np.arange(BINS) / BINS:
        nodes, weights = gauss(5, low, low + 1 / BINS)
        values = [albedo * h_function(albedo, mu) / (4 * np.pi * (mu + cosine)) for mu in nodes]
        expected.append(np.dot(values, weights * nodes) / np.dot(weights, nodes) * h_function(albedo, cosine))
    assert radiance_by_angle(medium_of(albedo), depth, 1.0, cosine)[0] == pytest.approx(expected, rel=1e-4)
    found = exit_angles.slab(medium_of(albedo), depth, 1.0, cosine, WALKS, seed=2).lit
    assert np.sqrt((((found.mean - expected) / found.error) ** 2).mean()) < 2


def test_bins_add_up_to_the_slab():
    medium, thickness, eta = Medium(2.0, 0.1), 1.7, 1.3
    found = exit_angles.slab(medium, thickness, eta, 1.0, WALKS, seed=3)
    shares = [np.pi * BIN_AREA @ side.mean for side in (found.lit, found.unlit)]
    errors = [np.pi * BIN_AREA @ side.error for side in (found.lit, found.unlit)]
    analogue = monte_carlo.slab(medium, thickness, eta, lambertian=False, walks=WALKS, seed=4)
    exact = discrete_ordinates(medium, thickness, eta, lambertian=False)
    for k, truth in enumerate((exact.reflectance, exact.transmittance)):
        assert abs(shares[k] - truth) < 4 * errors[k]
        assert abs(shares[k] - analogue.mean[k]) < 4 * np.hypot(errors[k], analogue.error[k])
    sides = radiance_by_angle(medium, thickness, eta, 1.0) @ (np.pi * BIN_AREA)
    assert sides == pytest.approx([exact.reflectance, exact.transmittance], rel=1e-5)


def test_only_optical_thickness_counts_and_the_seed_decides():
    thin = exit_angles.slab(medium_of(0.9, 0.5), 4.0, 1.3, 0.3, 5000, seed=5)
    dense = exit_angles.slab(medium_of(0.9, 5.0), 0.4, 1.3, 0.3, 5000, seed=5)
    assert thin.lit.mean == pytest.approx(dense.lit.mean)
    assert thin.unlit.mean == pytest.approx(dense.unlit.mean)
    other = exit_angles.slab(medium_of(0.9, 5.0), 0.4, 1.3, 0.3, 5000, seed=6)
    assert (other.lit.mean != dense.lit.mean).any()


def test_errors_shrink_with_the_root_of_the_walks():
    errors = [exit_angles.slab(medium_of(0.9), 2.0, 1.0, 1.0, walks, seed=7).lit.error for walks in (20_000, 320_000)]
    assert np.sqrt((errors[0] ** 2).mean() / (errors[1] ** 2).mean()) == pytest.approx(4, rel=0.4)
