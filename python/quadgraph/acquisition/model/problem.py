"""Photographs against predictions: weighted residuals, with unknown gains eliminated in closed form."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy import ndimage

from quadgraph.acquisition.capture.capture import Capture
from quadgraph.acquisition.capture.photographs import Measured
from quadgraph.acquisition.model.prediction import CHANNELS, Predicted
from quadgraph.base.errors import InputError

_COVERED = 0.999  # share of a pixel that the body has to cover
_AROUND = 0.8  # and of all pixels around it: by as much of a pixel the pose may be off
_GLOSS = 0.01  # over scattered light, from which on a pixel is left out
_DARK = 1e-4  # of the brightest pixel, below which a prediction is not held to anything
_HUBER = 3.0  # standard deviations, beyond which a residual counts linearly
BANDS = 3  # of brightness: in each, the engine's own error is taken to be the same wherever the lights are
LEAST_PIXELS = 16  # of a channel


@dataclass(eq=False)
class Pixels:
    """What counts of one channel of all photographs: data (n,); photograph (n,), which of them; at, indices into each
    picture's pixels, by photograph.
    """

    data: np.ndarray
    photograph: np.ndarray
    at: list[np.ndarray]

    def take(self, pictures: Sequence[np.ndarray], channel: int) -> np.ndarray:
        """(n,) of a value (h, w, 3) a photograph."""
        return np.concatenate([each[..., channel].ravel()[at] for each, at in zip(pictures, self.at, strict=True)])


class Problem:
    """The photographs of a capture, and which of their pixels count."""

    def __init__(self, capture: Capture, measured: list[Measured], pictures: list[Predicted]) -> None:
        """pictures: a first prediction, by which the pixels are chosen. Raises InputError where nothing is left."""
        self.capture, self.measured, self.first = capture, measured, pictures
        self.counted = [
            _counted(one, picture, capture.polarised) for one, picture in zip(measured, pictures, strict=True)
        ]
        for one, counted in zip(measured, self.counted, strict=True):
            if not counted.any():
                where = f"{capture.path}: {one.stated.path}"
                raise InputError(
                    f"{where}: no pixel is left to fit: what the body covers is masked, saturated, dark or has gloss; "
                    'check the mask, or photograph through crossed polarisers and state "polarised": true'
                )
        self.pixels = [self._pixels(channel) for channel in range(3)]
        known = [each.stated.gain for each in measured]
        self.groups = [name for name in dict.fromkeys(known) if isinstance(name, str)]
        self.factor = np.array([1.0 if isinstance(gain, str) else gain for gain in known])
        self.group = np.array([self.groups.index(gain) if isinstance(gain, str) else -1 for gain in known])
        self.exposure = np.array([each.stated.exposure for each in measured])
        lights = [each.stated.lights for each in measured]
        self.alike = np.array([lights.index(each) for each in lights])  # of each, the first under the same lights

    def _pixels(self, channel: int) -> Pixels:
        data, photograph, at = [], [], []
        for number, (one, counted) in enumerate(zip(self.measured, self.counted, strict=True)):
            index = np.flatnonzero(counted[..., channel])
            data.append(one.values[..., channel].ravel()[index])
            photograph.append(np.full(len(index), number))
            at.append(index)
        found = Pixels(np.concatenate(data), np.concatenate(photograph), at)
        if len(found.data) < LEAST_PIXELS or not (found.data > 0).any():
            raise InputError(
                f"{self.capture.path}: photographs: {CHANNELS[channel]} has {len(found.data)} pixels that count and "
                f"{int((found.data > 0).sum())} above 0, allowed are {LEAST_PIXELS} or more with light; light the body "
                "in all three channels, or write grey photographs, one channel in all three"
            )
        return found

    def blocks(self, pictures: Sequence[Predicted], channel: int) -> np.ndarray:
        """(n,) numbers of parts within which the engine's own error is alike: of the same lights and brightness."""
        pixels = self.pixels[channel]
        return pixels.take([each.band for each in pictures], channel) + BANDS * self.alike[pixels.photograph]

    def values(self, pictures: Sequence[np.ndarray], channel: int) -> np.ndarray:
        """(n,) what pixels would be with all unknown gains at 1, from radiances (h, w, 3) a photograph."""
        photograph = self.pixels[channel].photograph
        return self.pixels[channel].take(pictures, channel) * (self.exposure * self.factor)[photograph]

    def variances(self, pictures: Sequence[Predicted], channel: int, floor: float) -> tuple[np.ndarray, np.ndarray]:
        """(n,) variance of a pixel's noise, and of that with the engine's error; floor: least relative error."""
        radiances = [each.radiance for each in pictures]
        value = self.values(radiances, channel)
        gain = self.gains(value, self.pixels[channel].data, np.maximum(value, value.max() * _DARK) ** 2, channel)
        scale = (self.exposure * self.factor)[:, None, None, None] * gain[:, None, None, None]
        expected = [factor * radiance for factor, radiance in zip(scale, radiances, strict=True)]
        noise = self.pixels[channel].take(
            [one.variance_of(value) for one, value in zip(self.measured, expected, strict=True)], channel
        )
        error = np.maximum(self.pixels[channel].take([each.error for each in pictures], channel), floor)
        return noise, noise + (error * self.pixels[channel].take(expected, channel)) ** 2

    def gains(self, value: np.ndarray, data: np.ndarray, variance: np.ndarray, channel: int) -> np.ndarray:
        """(photographs,) best unknown gains, 1 where a gain is known."""
        photograph = self.pixels[channel].photograph
        group = self.group[photograph]
        unknown = group >= 0
        count = len(self.groups)
        above = np.bincount(group[unknown], (value * data / variance)[unknown], count)
        below = np.bincount(group[unknown], (value * value / variance)[unknown], count)
        found = np.where(below > 0, above / np.maximum(below, 1e-300), 1.0)
        return np.where(self.group >= 0, found[self.group] if count else 1.0, 1.0)

    def best_gains(self, pictures: Sequence[Predicted], floor: float) -> np.ndarray:
        """(photographs, 3) the gains that fit predictions best, with variances as `variances` has them."""
        result = np.empty((len(self.measured), 3))
        for channel in range(3):
            value = self.values([each.radiance for each in pictures], channel)
            _, variance = self.variances(pictures, channel, floor)
            result[:, channel] = self.gains(value, self.pixels[channel].data, variance, channel)
        return result

    def without_gains(self, columns: np.ndarray, value: np.ndarray, weight: np.ndarray, channel: int) -> np.ndarray:
        """Columns (n, k) less what unknown gains could do: orthogonal to `value` within each group, by weights."""
        group = self.group[self.pixels[channel].photograph]
        result = np.array(columns)
        for number in range(len(self.groups)):
            mine = group == number
            part, w = value[mine], weight[mine]
            norm = float((w * part * part).sum())
            if norm > 0:
                result[mine] -= np.outer(part, (w * part) @ columns[mine] / norm)
        return result


def _counted(one: Measured, picture: Predicted, polarised: bool) -> np.ndarray:
    """(h, w, 3) which pixels count: well within the body, lit, without gloss, neither masked nor saturated."""
    bright = picture.radiance > _DARK * picture.radiance.max(axis=(0, 1))
    return within(picture, polarised) & bright & one.usable


def within(picture: Predicted, polarised: bool) -> np.ndarray:
    """(h, w, 3) which pixels of a photograph are well within the body and without gloss."""
    around = ndimage.binary_erosion(picture.alpha > _AROUND, np.ones((3, 3)), border_value=1)
    inside = (picture.alpha > _COVERED) & around
    matt = np.ones(picture.radiance.shape, bool) if polarised else picture.gloss <= _GLOSS * picture.radiance
    return inside[..., None] & matt


def huber_weights(residual: np.ndarray, beyond: float = _HUBER) -> np.ndarray:
    """Weights of residuals, in standard deviations, that make least squares robust `beyond` some of them (Huber)."""
    return beyond / np.maximum(np.abs(residual), beyond)


def huber_cost(residual: np.ndarray) -> float:
    """Sum of squares, beyond the threshold linear."""
    return float(huber_costs(residual).sum())


def huber_costs(residual: np.ndarray) -> np.ndarray:
    """Squares of residuals, beyond the threshold linear."""
    size = np.abs(residual)
    return np.where(size <= _HUBER, size**2, _HUBER * (2 * size - _HUBER))
