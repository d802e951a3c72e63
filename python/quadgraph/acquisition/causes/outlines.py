"""Where photographs are lit against where the body is."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from scipy import ndimage

from quadgraph.acquisition.capture.capture import Capture
from quadgraph.acquisition.capture.photographs import Measured
from quadgraph.acquisition.model.prediction import Predicted
from quadgraph.acquisition.model.problem import Problem
from quadgraph.base.errors import InputError

_LIT = 0.05  # of the brightest, from which on a pixel is part of a silhouette
_BESIDE = 0.03  # of what is lit, that has to lie beside the body to say that it is elsewhere
_CUT = 0.5  # of the body, or of what is beside it, that a mask leaves out which is cut out along the body
_WRONG = 0.1  # of what such a mask keeps, that may lie beside the body
_LOOSE = 2  # pixels, that such a mask may be too large


def grey(picture: np.ndarray) -> np.ndarray:
    """(h, w) mean of the channels."""
    return picture.mean(axis=2)


def lit(picture: np.ndarray) -> np.ndarray:
    """(h, w) which pixels of a grey picture are lit."""
    return picture > _LIT * np.quantile(picture, 0.99)


def displaced(seen: np.ndarray, predicted: np.ndarray) -> tuple[float, np.ndarray]:
    """How many times as large as predicted a part of a picture is, and by how much, (2,) down and right, it lies
    elsewhere.
    """
    return float(np.sqrt(seen.sum() / max(predicted.sum(), 1))), _middle(seen) - _middle(predicted)


def _middle(part: np.ndarray) -> np.ndarray:
    return np.argwhere(part).mean(axis=0) if part.any() else np.zeros(2)


def silhouettes(problem: Problem, pictures: list[Predicted]) -> Iterator[str]:
    """What the lit part of photographs says of body, pose and camera; nothing where it matches."""
    for one, picture in zip(problem.measured, pictures, strict=True):
        seen = grey(one.values)
        unmasked = one.usable.any(axis=2)
        photographed, predicted = lit(seen) & unmasked, lit(grey(picture.radiance)) & unmasked
        body = ndimage.binary_dilation(picture.alpha > 0, np.ones((3, 3)))
        beside = (photographed & ~body).sum() / max(photographed.sum(), 1)
        if beside < _BESIDE:
            continue
        size, shift = displaced(photographed, predicted)
        yield (
            f"{one.stated.path}.camera: {beside:.0%} of what is lit lies beside the body; what is lit is "
            f"{shift[1]:+.0f} pixels to the right of its prediction, {shift[0]:+.0f} down and {size:.2f} times as "
            "large: pose, camera, unit or mask is wrong"
        )


def check_masks(capture: Capture, measured: list[Measured], pictures: list[Predicted]) -> None:
    """Raise InputError for a mask that leaves out the body and keeps what lies beside it."""
    for one, picture in zip(measured, pictures, strict=True):
        if one.kept is None:
            continue
        inside, beside = _shares(one.kept, picture)
        if inside < 1 - _CUT and beside > _CUT:
            raise InputError(
                f"{capture.path}: {one.stated.path}.mask: it leaves out {1 - inside:.0%} of the body and keeps "
                f"{beside:.0%} of what lies beside it: it is inverted, or of another photograph; let what counts be "
                "white and all else black"
            )


def masks(problem: Problem, pictures: list[Predicted]) -> Iterator[str]:
    """Masks that are cut out around something else than the body."""
    for one, picture in zip(problem.measured, pictures, strict=True):
        if one.kept is None:
            continue
        inside, beside = _shares(one.kept, picture)
        wrong = (one.kept & ~_near(picture)).sum() / max(one.kept.sum(), 1)
        if beside < _CUT and wrong > _WRONG:
            yield (
                f"{one.stated.path}.mask: {wrong:.0%} of what it keeps lies beside the body, of which it keeps "
                f"{inside:.0%}: it is the mask of another photograph, or pose or camera is wrong; name the right one"
            )


def _shares(kept: np.ndarray, picture: Predicted) -> tuple[float, float]:
    """Which shares of the body, and of what lies beside it, a mask keeps."""
    body, beside = picture.alpha > 0, ~_near(picture)
    return float((kept & body).sum() / max(body.sum(), 1)), float((kept & beside).sum() / max(beside.sum(), 1))


def _near(picture: Predicted) -> np.ndarray:
    """The body and what is so near that a mask may keep it."""
    return ndimage.binary_dilation(picture.alpha > 0, iterations=_LOOSE)
