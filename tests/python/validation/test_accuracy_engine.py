"""The engine, as it answers by default, against transport; its CPU reference is held to more in the other files.

Light patterns that it follows are in test_accuracy_half_space.py, beside the walks that tell what they give.
"""

from __future__ import annotations

import pytest

from quadgraph_validation.accuracy import half_space_study, slab_study
from quadgraph_validation.bodies.media import media
from quadgraph_validation.truth import schemes
from quadgraph_validation.truth.schemes import DIFFUSION, SP3, Scheme
from quadgraph_validation.truth.slab_transport import discrete_ordinates

pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")

DEFAULT = Scheme("fem", "buried", "auto")
ON_ENGINE = schemes.on_engine()


@pytest.fixture(scope="module")
def column():
    return slab_study.column(ON_ENGINE)


@pytest.mark.parametrize("lambertian", [False, True], ids=["collimated", "Lambertian"])
@pytest.mark.parametrize(
    ("name", "scheme", "lit", "unlit"),
    [
        ("marble", SP3, 0.01, 0.01),
        ("wholemilk", SP3, 0.01, 0.01),
        ("marble", DIFFUSION, 0.015, 0.015),
        ("wholemilk", DEFAULT, 0.015, 0.015),
        ("skin1", DEFAULT, 0.02, 0.04),
        ("ketchup", DEFAULT, 0.02, 0.04),
    ],
    ids=lambda value: value.model if isinstance(value, Scheme) else str(value),
)
def test_slabs_are_within_the_bounds(column, name, scheme, lit, unlit, lambertian):
    found = slab_study.solved(column, media(name), 1.3, lambertian, scheme)
    for medium, light in zip(media(name), found, strict=True):
        truth = discrete_ordinates(medium, slab_study.THICKNESS, 1.3, lambertian)
        reflected, transmitted = slab_study.relative_errors(light, truth)
        assert abs(reflected) < lit
        assert abs(transmitted) < unlit
        total = light.reflectance + light.transmittance + light.absorbed + light.unscattered
        assert total == pytest.approx(1, abs=1e-5)


def test_a_short_pattern_leaves_nothing_negative():
    medium = half_space_study.medium_of(0.999)
    body = half_space_study.block(ON_ENGINE, medium, 2.0)
    found, least = half_space_study.response(body, medium, 1.3, 2.0, DEFAULT)
    assert found > 0
    assert least >= 0
