"""Which pixels count, what they weigh, and how unknown gains go away: on made-up pictures, without the engine."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import numpy as np
import pytest

from quadgraph.acquisition.capture.capture import Capture, NoiseModel, Photograph
from quadgraph.acquisition.capture.photographs import Measured
from quadgraph.acquisition.model.prediction import Predicted
from quadgraph.acquisition.model.problem import Problem, huber_cost, huber_weights
from quadgraph.base.errors import InputError

SIZE = 24
NOISE = NoiseModel(0.01, 0.001)


def photograph(number: int, gain: float | str) -> Photograph:
    """The statement of one photograph of exposure 2."""
    path = f"photographs[{number}]"
    return Photograph(path, Path(f"{number}.exr"), "front", ("key",), 2.0, gain, None, NOISE, None)


def picture(number: int, gloss: float = 0.0) -> Predicted:
    """A disc whose radiance falls from left to right, with as much gloss over it in its upper half."""
    row, column = np.mgrid[:SIZE, :SIZE]
    disc = np.hypot(row - 11.5, column - 11.5) < 10
    radiance = np.repeat((disc * (0.3 + 0.02 * column + 0.1 * number))[..., None], 3, axis=2)
    shine = gloss * radiance * (row < 12)[..., None]
    return Predicted(radiance, shine, disc.astype(float), np.full(radiance.shape, 0.02), np.zeros(radiance.shape, int))


def problem(values: list[np.ndarray], gains: list[float | str], polarised: bool = True, gloss: float = 0.0) -> Problem:
    """Photographs of these values."""
    stated = tuple(photograph(number, gain) for number, gain in enumerate(gains))
    fixed = (Path("capture.json"), Path("body.qgraph"), None, None, 1.3, [], {}, {"front": (SIZE, SIZE)}, {}, {})
    capture = Capture(*fixed, polarised, stated)
    measured = [
        Measured(each, value, np.full(value.shape, NOISE.read_out**2), np.ones(value.shape, bool))
        for each, value in zip(stated, values, strict=True)
    ]
    return Problem(capture, measured, [picture(number, gloss) for number in range(len(gains))])


def test_gains_are_found_by_group_and_known_ones_left():
    pictures = [picture(number) for number in range(3)]
    true = np.array([[1.3, 1.2, 1.1], [1.3, 1.2, 1.1], [0.7, 0.7, 0.7]])
    values = [2 * gain * each.radiance for gain, each in zip(true, pictures, strict=True)]
    found = problem(values, ["camera", "camera", 0.7])
    for channel in range(3):
        value = found.values([each.radiance for each in pictures], channel)
        gains = found.gains(value, found.pixels[channel].data, np.ones(len(value)), channel)
        np.testing.assert_allclose(gains, [*true[:2, channel], 1.0])  # a known one is in the values already
        np.testing.assert_allclose(gains[found.pixels[channel].photograph] * value, found.pixels[channel].data)


def test_columns_without_gains_are_orthogonal_to_what_gains_do():
    generator = np.random.default_rng(2)
    pictures = [picture(number) for number in range(3)]
    found = problem([2 * each.radiance for each in pictures], ["a", "b", 1.0])
    value = found.values([each.radiance for each in pictures], 1)
    weight = generator.uniform(0.5, 2, len(value))
    columns = generator.normal(size=(len(value), 2))
    reduced = found.without_gains(columns, value, weight, 1)
    for number in range(3):
        mine = found.pixels[1].photograph == number
        along = (weight * value)[mine] @ reduced[mine]
        if number < 2:
            np.testing.assert_allclose(along, 0, atol=1e-9)
        else:
            np.testing.assert_array_equal(reduced[mine], columns[mine])


def test_weights_hold_noise_and_the_error_of_the_prediction():
    pictures = [picture(0)]
    found = problem([2 * pictures[0].radiance], [1.0])
    noise, whole = found.variances(pictures, 0, 0.005)
    value = found.values([pictures[0].radiance], 0)
    np.testing.assert_allclose(noise, NOISE.read_out**2 + NOISE.shot * value)
    np.testing.assert_allclose(whole - noise, (0.02 * value) ** 2)


def test_gloss_and_outlines_do_not_count_unless_polarisers_took_gloss_away():
    values = [2 * picture(0).radiance]
    polarised, plain = (problem(values, [1.0], polarised, 0.05).counted[0] for polarised in (True, False))
    assert not plain[:12].any()
    assert (plain[12:] == polarised[12:]).all()
    covered = picture(0).alpha > 0
    assert polarised[..., 0].sum() < covered.sum()
    assert not polarised[~covered].any()


def test_gloss_everywhere_is_refused_with_what_helps():
    shiny = picture(0)
    shiny.gloss[:] = shiny.radiance
    fine = problem([2 * shiny.radiance], [1.0])
    with pytest.raises(InputError, match=r'photographs\[0\]: no pixel is left to fit.*"polarised": true'):
        Problem(dataclasses.replace(fine.capture, polarised=False), fine.measured, [shiny])


def test_a_channel_without_light_is_refused():
    dark = 2 * picture(0).radiance
    dark[..., 2] = 0
    with pytest.raises(InputError, match=r"photographs: blue has \d+ pixels that count and 0 above 0"):
        problem([dark], [1.0])


def test_hubers_cost_is_quadratic_and_then_linear():
    residual = np.linspace(-8, 8, 33)
    slope = np.gradient([huber_cost(np.array([each])) for each in residual], residual)[1:-1]
    np.testing.assert_allclose(slope, (2 * huber_weights(residual) * residual)[1:-1], atol=0.26)
    assert huber_weights(np.array([2.9]))[0] == 1
