"""Light patterns on a half-space: the transfer function against random walks and closed forms."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
import pytest

from quadgraph_validation.accuracy import half_space_study
from quadgraph_validation.truth import closed_forms, monte_carlo, schemes
from quadgraph_validation.truth.schemes import DIFFUSION, SP3, Scheme

pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")

DEFAULT = Scheme("fem", "buried", "auto")
WALKS = 150_000


@lru_cache(maxsize=64)
def response(eta: float, albedo: float, wavelength: float, scheme: Scheme) -> tuple[float, float]:
    """M/q and the least exitance on a mesh."""
    medium = half_space_study.medium_of(albedo)
    return half_space_study.response(block(albedo, wavelength), medium, eta, wavelength, scheme)


@lru_cache
def walked(eta: float, albedo: float, wavelengths: tuple[float, ...]) -> monte_carlo.Estimate:
    truth = monte_carlo.half_space(half_space_study.medium_of(albedo), eta, np.array(wavelengths), WALKS, seed=4)
    assert (truth.error < 0.01 * truth.mean).all()
    return truth


@lru_cache(maxsize=64)
def block(albedo: float, wavelength: float) -> schemes.StudyBody:
    return half_space_study.block(schemes.on_reference, half_space_study.medium_of(albedo), wavelength)


@pytest.mark.parametrize(
    ("eta", "albedo", "wavelengths", "scheme"),
    [
        (1.3, 0.999, (np.inf, 30.0, 10.0), DIFFUSION),
        (1.3, 0.98, (np.inf, 30.0), SP3),
        (1.3, 0.9, (np.inf, 30.0), SP3),
        (1.3, 0.7, (np.inf, 30.0), SP3),
        (1.0, 0.9, (np.inf, 30.0, 10.0), SP3),
    ],
)
def test_the_answer_follows_transport(eta, albedo, wavelengths, scheme):
    """The rows of docs/truth.md, "Reference values", in the models of `auto`; truth is a longer random walk."""
    for wavelength, expected in zip(wavelengths, walked(eta, albedo, wavelengths).mean, strict=True):
        found = response(eta, albedo, wavelength, scheme)[0]
        print(f"eta {eta}, albedo {albedo}, wavelength {wavelength}: {found:.4f} against {expected:.4f}")
        assert found == pytest.approx(expected, rel=0.05)


@pytest.mark.parametrize(
    ("eta", "albedo", "wavelengths"),
    [
        (1.3, 0.999, (np.inf, 30.0, 10.0)),
        (1.3, 0.9, (np.inf, 30.0)),
        (1.0, 0.9, (np.inf, 30.0, 10.0)),
    ],
)
def test_light_patterns_are_followed_down_to_ten_mean_free_paths(eta, albedo, wavelengths):
    """By the engine as it answers by default."""
    medium = half_space_study.medium_of(albedo)
    for wavelength, expected in zip(wavelengths, walked(eta, albedo, wavelengths).mean, strict=True):
        body = half_space_study.block(schemes.on_engine(), medium, wavelength)
        found, least = half_space_study.response(body, medium, eta, wavelength, DEFAULT)
        print(f"eta {eta}, albedo {albedo}, wavelength {wavelength}: {found:.4f} against {expected:.4f}")
        assert found == pytest.approx(expected, rel=0.05)
        assert least >= 0


@pytest.mark.parametrize("scheme", [DIFFUSION, SP3], ids=lambda scheme: scheme.model)
@pytest.mark.parametrize("wavelength", [30.0, 10.0, 3.0])
def test_the_mesh_adds_little_to_the_error_of_its_model(wavelength, scheme):
    """So what is missing at short wavelengths is missing in the model."""
    medium = half_space_study.medium_of(0.98)
    exact = closed_forms.half_space_response(
        medium, np.array([wavelength]), scheme.model_of, scheme.boundary(1.3), buried=True
    )
    assert response(1.3, 0.98, wavelength, scheme)[0] == pytest.approx(exact[0], rel=0.02)


@pytest.mark.parametrize("scheme", [DIFFUSION, SP3], ids=lambda scheme: scheme.model)
@pytest.mark.parametrize("wavelength", [30.0, 5.0, 2.0, 1.0, 0.5])
def test_no_pattern_makes_the_exitance_negative(wavelength, scheme):
    for albedo in (0.999, 0.7):
        share, least = response(1.3, albedo, wavelength, scheme)
        assert share > 0
        assert least >= 0
