"""Random walks and discrete ordinates against each other and against docs/truth.md, "Reference values"."""

from __future__ import annotations

import numpy as np
import pytest

from quadgraph_validation.bodies.media import Medium, media
from quadgraph_validation.truth import monte_carlo
from quadgraph_validation.truth.fresnel import entering_share
from quadgraph_validation.truth.slab_transport import discrete_ordinates

THICKNESS = 5.0  # mm

# R and T of scattered light per unit of light that arrives from outside: (eta, Lambertian) as docs/truth.md has them.
CASES = [(1.0, False), (1.0, True), (1.3, False), (1.3, True)]
TABLE = {
    "marble": [
        [(0.8495, 0.1265), (0.8795, 0.1003), (0.7806, 0.1656), (0.7565, 0.1487)],
        [(0.8559, 0.0989), (0.8840, 0.0784), (0.7852, 0.1298), (0.7602, 0.1165)],
        [(0.8507, 0.0760), (0.8791, 0.0602), (0.7754, 0.0992), (0.7510, 0.0889)],
    ],
    "wholemilk": [
        [(0.8735, 0.1136), (0.8991, 0.0902), (0.8113, 0.1519), (0.7844, 0.1365)],
        [(0.8865, 0.0861), (0.9091, 0.0683), (0.8254, 0.1162), (0.7968, 0.1044)],
        [(0.8351, 0.0426), (0.8654, 0.0337), (0.7520, 0.0547), (0.7292, 0.0490)],
    ],
}


def shares(medium: Medium, eta: float, lambertian: bool, angles: int = 40) -> np.ndarray:
    light = discrete_ordinates(medium, THICKNESS, eta, lambertian, angles)
    return np.array([light.reflectance, light.transmittance, light.absorbed, light.unscattered])


@pytest.mark.parametrize("name", TABLE)
def test_discrete_ordinates_reproduce_the_tables(name):
    for medium, row in zip(media(name), TABLE[name], strict=True):
        for (eta, lambertian), expected in zip(CASES, row, strict=True):
            found = shares(medium, eta, lambertian)[:2] * entering_share(lambertian, eta)
            assert np.abs(found - expected).max() < 6e-5, (name, eta, lambertian)


@pytest.mark.parametrize(("eta", "lambertian"), CASES)
@pytest.mark.parametrize("name", ["marble", "skin1", "ketchup"])
def test_discrete_ordinates_conserve_energy_and_are_converged(name, eta, lambertian):
    for medium in media(name):
        found = shares(medium, eta, lambertian)
        assert abs(found.sum() - 1) < 1e-10
        assert np.abs(found - shares(medium, eta, lambertian, angles=24)).max() < 1e-8


@pytest.mark.parametrize(("eta", "lambertian"), CASES)
@pytest.mark.parametrize(("name", "channel"), [("marble", 0), ("wholemilk", 2), ("skin1", 1), ("ketchup", 0)])
def test_random_walks_agree_with_discrete_ordinates(name, channel, eta, lambertian):
    medium = media(name)[channel]
    truth = shares(medium, eta, lambertian)
    walks = 100_000
    found = monte_carlo.slab(medium, THICKNESS, eta, lambertian, walks, seed=2)
    error = np.sqrt(truth * (1 - truth) / walks)
    print(f"{name} {channel} {eta} {lambertian}: off by {np.round((found.mean - truth) / error, 1)} standard errors")
    few = truth * walks < 10  # counts that are not normally distributed
    assert (np.abs(found.mean - truth)[~few] < 3 * error[~few]).all()
    assert (found.mean[few] * walks < 30).all()


@pytest.mark.parametrize(
    ("eta", "albedo", "expected"),
    [
        (1.3, 0.999, {np.inf: 0.872, 30: 0.608, 10: 0.309, 5: 0.176, 3: 0.115}),
        (1.3, 0.98, {np.inf: 0.557}),
        (1.3, 0.9, {np.inf: 0.291}),
        (1.3, 0.7, {np.inf: 0.125}),
        (1.0, 0.9, {np.inf: 0.414, 5: 0.224}),
    ],
)
def test_half_space_walks_reproduce_the_transfer_function(eta, albedo, expected):
    found = monte_carlo.half_space(Medium(albedo, 1 - albedo), eta, np.array(list(expected)), 100_000, seed=3)
    assert (np.abs(found.mean - list(expected.values())) < 3 * found.error + 1e-3).all(), found


def test_a_thick_sphere_loses_what_a_slab_absorbs_and_a_clear_one_scatters_nothing():
    thin = monte_carlo.sphere(Medium(1e-9, 1e-9), 10.0, 1.3, bins=4, walks=2000, seed=1)
    assert thin.mean.max() == 0
    white = monte_carlo.sphere(Medium(1.0, 0.0), 3.0, 1.0, bins=8, walks=20_000, seed=1)
    power = white.mean.sum() * 4 * np.pi * 3.0**2 / 8
    never_scattered = 2 * (1 - np.exp(-6.0) * 7) / 36  # of chords 6 c with density 2 c dc
    assert abs(power / (np.pi * 3.0**2) - (1 - never_scattered)) < 0.01


def test_the_same_seed_gives_the_same_walks():
    first, second, other = (monte_carlo.slab(Medium(1, 0.1), 2.0, 1.3, False, 1000, seed).mean for seed in (1, 1, 2))
    assert (first == second).all()
    assert (first != other).any()
