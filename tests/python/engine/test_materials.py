"""A material by the colour that it shows, against closed forms of its own and against transport."""

from __future__ import annotations

import numpy as np
import pytest

import quadgraph
import tiny
from quadgraph_validation.bodies.media import Medium
from quadgraph_validation.truth import boundary, closed_forms, moments
from quadgraph_validation.truth.slab_transport import discrete_ordinates

core = pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")

COLOUR = (0.15, 0.5, 0.85)


@pytest.mark.parametrize("eta", [1.0, 1.3, 1.5])
def test_a_half_space_of_the_coefficients_shows_the_colour(eta):
    text = ",".join([f"reflectance={'/'.join(map(str, COLOUR))}", "mean_free_path=2/1/0.5", f"eta={eta}"])
    found = core.Material(text)
    entered = core.fresnel_transmittance(1.0, eta)
    for colour, sigma_s_prime, sigma_a in zip(COLOUR, found.sigma_s_prime, found.sigma_a, strict=True):
        medium = Medium(sigma_s_prime, sigma_a)
        (response,) = closed_forms.half_space_response(medium, [np.inf], moments.sp3, boundary.sp3(eta), True)
        assert entered * response == pytest.approx(colour, rel=1e-4)
        # 30 mean free paths are as good as a half-space for what absorbs that much.
        if colour < 0.8:
            transport = discrete_ordinates(medium, 30 / medium.sigma_t, eta, lambertian=False)
            assert entered * transport.reflectance == pytest.approx(colour, rel=0.02)


@pytest.fixture(scope="module")
def cube():
    """A body of 2 mm, which light crosses in 1.33 mm on average."""
    with quadgraph.Engine(tiny.PATH, device="cpu") as engine:
        engine.lights = ["ambient:1", "directional:0.3,-0.4,-1:2"]
        yield engine


def test_a_name_that_cannot_look_so_on_a_body_is_said(cube):
    for material, said in (("honey", "honey: a body that light crosses in 1.3 mm"), ("milk", ""), ("marble", "")):
        cube.material = material
        solution = cube.solve(correction=False)
        assert solution.size_warning.startswith(said)
        assert bool(solution.size_warning) == bool(said)
    cube.material = quadgraph.Material.parse("honey")  # numbers promise nothing
    assert cube.solve(correction=False).size_warning == ""


def test_a_picture_has_the_roughness_that_it_is_asked_for_else_that_of_the_material(cube):
    def shown(material, **options):
        cube.material = material
        cube.solve(correction=False)
        return cube.render("30,20", width=24, height=24, samples=4, **options).specular

    usual = shown("wholemilk")
    assert np.array_equal(usual, shown("wholemilk", roughness=0.3))
    glazed = shown("wholemilk,roughness=0.05")
    assert not np.array_equal(glazed, usual)
    assert np.array_equal(glazed, shown("wholemilk", roughness=0.05))
    assert np.array_equal(usual, shown("wholemilk,roughness=0.05", roughness=0.3))
    assert np.array_equal(shown("milk"), shown(quadgraph.Material.parse("milk")))
    assert not np.array_equal(shown("milk"), usual)


def test_a_phase_function_gives_what_its_reduced_coefficient_does():
    tissue = quadgraph.Material.from_phase_function((20, 10, 5), (0.9, 0.8, 0.5), 0.03, 1.4)
    assert np.allclose(tissue.sigma_s_prime, (2, 2, 2.5))
    assert np.allclose(quadgraph.Material.parse("skin1,sigma_s=10,g=.8").sigma_s_prime, 2)
    with pytest.raises(quadgraph.InputError, match="'g': found '1', allowed is a number above -1 and below 1"):
        quadgraph.Material.from_phase_function(20, 1, 0.03)
