"""Exposures merged to radiance: unbiased, with the variance that is stated."""

from __future__ import annotations

import numpy as np
import pytest

from quadgraph.acquisition.capture.capture import NoiseModel
from quadgraph.acquisition.session import brackets
from quadgraph.acquisition.session.frames import Frame

NOISE = NoiseModel(0.0012, 1.5e-4)
EXPOSURES = (0.25, 1.0, 4.0)
SHAPE = (400, 300, 3)
WHITE = 0.98


def truth() -> np.ndarray:
    """From a hundredth, dark in all exposures, to 3, near saturation in the shortest."""
    ramp = np.geomspace(0.01, 3.0, SHAPE[1])
    return np.broadcast_to(ramp[None, :, None], SHAPE) * [1.0, 0.7, 0.4]


def frames(generator: np.random.Generator, black: float = 0.0, shares=(1.0, 1.0, 1.0)) -> list[Frame]:
    """Exposures with noise, clipped at full scale."""
    found = []
    for exposure in EXPOSURES:
        value = exposure * truth()
        value = value + generator.normal(size=SHAPE) * np.sqrt(
            np.array(shares) * (NOISE.read_out**2 + NOISE.shot * value)
        )
        value = np.minimum(value + black, 1.0).astype(np.float32)
        found.append(Frame(value, value >= WHITE, np.array(shares), None))
    return found


def variance(level: float, blacks: int) -> np.ndarray:
    """Of the merged value, by the truth: one over the sum of the weights of exposures that are not saturated."""
    floor = NOISE.read_out**2 * (1 + (1 / blacks if blacks else 0))
    weights = [
        np.where(exposure * truth() + level < WHITE, exposure**2 / (floor + NOISE.shot * exposure * truth()), 0)
        for exposure in EXPOSURES
    ]
    return 1 / np.maximum(np.sum(weights, axis=0), 1e-30)


@pytest.mark.parametrize("blacks", [0, 4])
def test_merged_values_are_off_by_the_stated_variance(blacks):
    generator = np.random.default_rng(3)
    level, black = 0.01 if blacks else 0.0, None
    if blacks:
        black = level + generator.normal(size=(blacks, *SHAPE)).mean(axis=0) * NOISE.read_out
    merged = brackets.merge(frames(generator, level), EXPOSURES, NOISE, black, blacks)
    # Where the expected value of an exposure is near saturation, noise decides whether it counts, which is no noise of
    # a normal distribution; it is a few columns.
    near = np.any([np.abs(exposure * truth() + level - WHITE) < 0.06 for exposure in EXPOSURES], axis=0)
    fine = merged.usable & ~near
    off = merged.values - truth()
    count = int(fine.sum())
    assert count > 250_000
    # Normal: the mean within 4.5 standard errors of 0, by the variance at the true value (that at the measured one is
    # smaller where the value is too small), and chi^2 by the stated variance within as many of its own.
    assert abs((off / np.sqrt(variance(level, blacks)))[fine].mean()) < 4.5 / np.sqrt(count)
    chi_squared = (off**2 / merged.variances)[fine].mean()
    assert abs(chi_squared - 1) < 4.5 * np.sqrt(2 / count) + (0.02 if blacks else 0)  # its exposures share black frames


def test_channels_of_two_pixels_have_half_the_variance():
    shares = (1.0, 0.5, 1.0)
    merged = brackets.merge(frames(np.random.default_rng(4), 0.0, shares), EXPOSURES, NOISE, None, 0)
    whole = brackets.merge(frames(np.random.default_rng(4)), EXPOSURES, NOISE, None, 0)
    ratio = merged.variances / whole.variances
    np.testing.assert_allclose(np.median(ratio, axis=(0, 1)), shares, rtol=0.01)


def test_what_is_saturated_in_all_exposures_does_not_count():
    values = np.full((10, 10, 3), 1.0, np.float32)
    values[:5] = 0.5
    frame = Frame(values, values >= WHITE, np.ones(3), None)
    merged = brackets.merge([frame, frame], [1.0, 1.0], NOISE, None, 0)
    assert merged.usable[:5].all()
    assert not merged.usable[5:].any()
    assert merged.values[0, 0, 0] == pytest.approx(0.5)
    assert merged.variances[0, 0, 0] == pytest.approx((NOISE.read_out**2 + NOISE.shot * 0.5) / 2)


def test_noise_is_found_from_pairs_of_exposures():
    found = brackets.estimate_noise([(frames(np.random.default_rng(5)), EXPOSURES)], None)
    assert found is not None
    assert found.read_out == pytest.approx(NOISE.read_out, rel=0.05)
    assert found.shot == pytest.approx(NOISE.shot, rel=0.05)


def test_one_exposure_tells_no_noise():
    assert brackets.estimate_noise([(frames(np.random.default_rng(6))[:1], EXPOSURES[:1])], None) is None


def test_an_exposure_that_is_stated_wrong_is_told():
    read = frames(np.random.default_rng(7))
    np.testing.assert_allclose(brackets.ratios(read, EXPOSURES, NOISE, None), [1, 1], atol=2e-3)
    found = brackets.ratios(read, (0.25, 1.2, 4.0), NOISE, None)
    np.testing.assert_allclose(found, [1.2, 1 / 1.2], atol=3e-3)
