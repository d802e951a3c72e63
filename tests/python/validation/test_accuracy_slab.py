"""Columns that stand for infinite slabs against exact transport, and the table "How coarse may the mesh be?"."""

from __future__ import annotations

import numpy as np
import pytest

from quadgraph_validation.accuracy import coarse_study, slab_study
from quadgraph_validation.bodies import meshes
from quadgraph_validation.bodies.media import Medium, media
from quadgraph_validation.truth import closed_forms, schemes
from quadgraph_validation.truth.closed_forms import Layer
from quadgraph_validation.truth.schemes import DIFFUSION, SP3, Scheme, StudyLight
from quadgraph_validation.truth.slab_transport import COLLIMATED, discrete_ordinates

pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")

BOUNDS = {SP3: 0.01, DIFFUSION: 0.015}


@pytest.fixture(scope="module")
def column():
    return slab_study.column(schemes.on_reference)


def worst_errors(column, name: str, eta: float, lambertian: bool, scheme) -> tuple[float, float]:
    """The largest relative errors of R and T over the channels."""
    found = slab_study.solved(column, media(name), eta, lambertian, scheme)
    truth = [discrete_ordinates(medium, slab_study.THICKNESS, eta, lambertian) for medium in media(name)]
    errors = [slab_study.relative_errors(f, t) for f, t in zip(found, truth, strict=True)]
    print(f"{name} {eta} {lambertian} {scheme.name}: {[[f'{e:+.2%}' for e in pair] for pair in errors]}")
    return max(abs(r) for r, _ in errors), max(abs(t) for _, t in errors)


@pytest.mark.parametrize("scheme", BOUNDS, ids=lambda scheme: scheme.model)
@pytest.mark.parametrize("lambertian", [False, True], ids=["collimated", "Lambertian"])
@pytest.mark.parametrize("eta", [1.0, 1.3])
@pytest.mark.parametrize("name", ["marble", "wholemilk"])
def test_bright_slabs_are_within_the_bounds(column, name, eta, lambertian, scheme):
    assert max(worst_errors(column, name, eta, lambertian, scheme)) < BOUNDS[scheme]


@pytest.mark.parametrize("lambertian", [False, True], ids=["collimated", "Lambertian"])
@pytest.mark.parametrize("name", ["skin1", "ketchup"])
def test_sp3_holds_where_diffusion_does_not(column, name, lambertian):
    """Down to an albedo of .02, at the index of refraction that was measured."""
    reflected, transmitted = worst_errors(column, name, 1.3, lambertian, SP3)
    assert reflected < 0.02
    assert transmitted < 0.04
    assert max(worst_errors(column, name, 1.3, lambertian, DIFFUSION)) > 0.04


def test_energy_is_conserved_from_dense_to_thin_bodies(column):
    for name in ("wholemilk", "ketchup"):
        for light in slab_study.solved(column, media(name), 1.3, False, SP3):
            total = light.reflectance + light.transmittance + light.absorbed + light.unscattered
            assert total == pytest.approx(1, abs=1e-5)


LAYERS = [Layer(Medium(3.0, 0.01), 1.0), Layer(Medium(0.3, 0.002), 2.0), Layer(Medium(1.0, 0.05), 1.0)]


@pytest.mark.parametrize("model", ["diffusion", "sp3"])
@pytest.mark.parametrize("source", ["diffuse", "buried"])
def test_layers_are_joined_as_the_closed_form_joins_them(source, model):
    """Contrast of ten between neighbours, at element boundaries: nothing may leak there."""
    scheme = Scheme("fem", source, model)
    step, eta = 0.05, 1.3
    count = round(sum(layer.thickness for layer in LAYERS) / step)
    body = schemes.on_reference(meshes.column(np.full(count, step), 2 * step))
    depth = np.concatenate([body.mesh.inner, body.centre])[:, 2]
    region = np.minimum(np.searchsorted(np.cumsum([layer.thickness for layer in LAYERS]), depth), len(LAYERS) - 1)
    lit, unlit = body.normal[:, 2] < -0.5, body.normal[:, 2] > 0.5
    light = StudyLight(np.outer(lit, np.ones(3)), (0.0, 0.0, 1.0))
    answer = body.piecewise([[layer.medium] * 3 for layer in LAYERS], region, eta, light, scheme)
    beam = COLLIMATED if source == "buried" else None
    exact = closed_forms.layered_slab(LAYERS, scheme.model_of, scheme.boundary(eta), eta, beam)
    found = [body.mean(answer.exitance, faces)[0] for faces in (lit, unlit)]
    print(f"{scheme.name}: R {found[0]:.5f} of {exact.reflectance:.5f}, T {found[1]:.5f} of {exact.transmittance:.5f}")
    assert found == pytest.approx([exact.reflectance, exact.transmittance], rel=0.003)


# Errors in % of R and T from docs/truth.md, "Reference values", per row of coarse.LAYERS and column of coarse.CASES.
# That table's rounding to one digit and its elements, one-dimensional, leave 0.2; its slabs of five and three elements
# are not these.
COARSE = [
    [(0.3, -0.9), (0.0, -0.1), (0.0, 0.6)],
    [(0.3, -0.9), (0.1, -0.2), (0.1, 0.6)],
    [(0.3, -0.8), (0.2, -0.4), (0.5, 0.5)],
    [(0.4, -0.8), (0.4, -1.0), (2.1, 0.0)],
    [(0.5, -0.6), (0.8, -1.7), (5.3, -1.9)],
]


def test_coarse_meshes_lose_no_more_than_physics_says():
    record = coarse_study.run(schemes.on_reference)
    for row, expected in zip(record["rows"], COARSE, strict=True):
        for cell, errors in zip(row["cells"], expected, strict=True):
            for found, stated in zip(cell["errors"], errors, strict=True):
                print(f"{row['layers']} layers, {cell['medium']}: {100 * found:+.2f} against {stated:+.1f}")
                assert abs(100 * found) < abs(stated) + 0.2
                if cell["medium"] == "marble R":
                    assert 100 * found == pytest.approx(stated, abs=0.1)
