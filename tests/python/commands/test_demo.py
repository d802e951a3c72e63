"""The picture of the demo: a real mesh baked and rendered, looked at by numbers."""

from __future__ import annotations

import numpy as np
import pytest

_core = pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")


@pytest.fixture(scope="module")
def bunny_engine(small_bunny):
    """The demo's bunny, 60 mm high, in marble, on fewer vertices; validation messages fail."""
    engine = _core.Engine(small_bunny, validation=True)
    engine.set_material("marble")
    yield engine
    assert engine.validation_messages == []


def luminance(picture) -> np.ndarray:
    """Mean of the scattered channels, NaN where the object does not cover the pixel."""
    covered = picture.alpha > 0.99
    return np.where(covered, picture.scattered.mean(axis=2), np.nan)


def test_the_demo_picture_is_not_black_and_has_contrast(bunny_engine):
    bunny_engine.set_lights(_core.default_lights())
    bunny_engine.solve()
    picture = bunny_engine.render(width=256, height=256)
    shown = picture.srgb().astype(float).mean(axis=2)[picture.alpha > 0.99]
    assert np.median(shown) > 40
    assert np.quantile(shown, 0.95) - np.quantile(shown, 0.05) > 60
    assert (shown > 250).mean() < 0.1


def test_light_from_behind_is_brighter_through_the_ears_than_through_the_body(bunny_engine):
    bunny_engine.set_lights(["directional:0,0,1:1"])
    report = bunny_engine.solve()
    assert all(level["converged"] for level in report["levels"])
    image = luminance(bunny_engine.render(view="0,0", width=256, height=256))
    rows = np.flatnonzero(np.isfinite(image).any(axis=1))
    top, bottom = rows[0], rows[-1]
    ears = image[top : top + (bottom - top) // 6]
    body = image[top + (bottom - top) // 2 : bottom]
    assert np.nanmedian(ears) > 3 * np.nanmedian(body) > 0


def test_coarser_levels_agree_with_the_error_estimate(bunny_engine):
    bunny_engine.set_lights(["directional:0,0,1:1"])
    error = bunny_engine.solve(tolerance=1e-5)["error"]
    assert 0 < error["whole"] < 0.1
    assert 0 < error["unlit"] < 0.3
