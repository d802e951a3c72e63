"""A material by the colour that it shows, against closed forms of its own and against transport."""

from __future__ import annotations

import numpy as np
import pytest

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
