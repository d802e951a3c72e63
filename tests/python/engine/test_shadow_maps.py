"""Shadow maps against rays, on bodies with thin and with hidden parts."""

from __future__ import annotations

import numpy as np
import pytest

import light_truth

_core = pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")

ETA = 1.3


@pytest.mark.parametrize("name", ["bunny", "spot", pytest.param("heptoroid", marks=pytest.mark.long)])
def test_the_light_that_enters_is_what_rays_find(name, small_bunny, small_body):
    """Half the lit faces within 2%, all the light within 1%, and next to none where it is dark."""
    engine = _core.Engine(small_bunny if name == "bunny" else small_body(name), validation=True)
    engine.set_material(f"sigma_s_prime=1,sigma_a=0.01,eta={ETA}")
    level = engine.graph.levels[0]
    body = light_truth.Body(light_truth.Surface(level.vertices.astype(float), level.faces))
    faces = np.random.default_rng(3).choice(len(level.faces), 1500, replace=False)
    low, high = level.vertices.min(axis=0), level.vertices.max(axis=0)
    near = (low + high) / 2 + np.array([0, 0.75, 0.55]) * np.linalg.norm(high - low) / 2
    x, y, z = near
    lights = {
        "directional:-5,-8,-4:1": light_truth.directional((-5, -8, -4)),
        f"spot:{x},{y},{z}:0,-0.75,-0.55:90,0:1000": light_truth.spot(
            near, (0, -0.75, -0.55), 90.0, 1e-3, [1000.0] * 3
        ),
    }
    for text, emitter in lights.items():
        engine.set_lights([text])
        engine.solve(tolerance=0.1, inter_reflection=False)
        field = engine.surface_field()
        q, area = field["q"][faces, 0].astype(float), field["area"][faces]
        truth = body.q(faces, emitter, ETA, 64)[:, 0]
        lit = truth > 0.1 * (truth * area).sum() / area.sum()
        median = np.median(np.abs(q - truth)[lit] / truth[lit])
        power = (q * area).sum() / (truth * area).sum() - 1
        leak = (q * area)[truth == 0].sum() / (truth * area).sum()
        print(f"{name}, {text}: median error {median:.3%}, power {power:+.2%}, where it is dark {leak:.3%}")
        assert median < 0.02
        assert abs(power) < 0.01
        assert leak < 0.005
    assert engine.validation_messages == []
