"""What is most probably wrong with photographs that no coefficients explain."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from scipy import ndimage

from quadgraph.acquisition.fitting import Fit
from quadgraph.acquisition.problem import Problem
from quadgraph.acquisition.start import ENCODED, Ranking
from quadgraph.acquisition.volume_fit import VolumeFit

FAR = 4.0  # chi^2 per degree of freedom, from which on photographs and predictions disagree
_LESS = 0.75  # of the spread that linear values leave, which encoded ones have to leave at most
_BETTER = 0.15  # of correlation, by which another assumption has to win
_FREE = 0.15  # of correlation, that centring gains by itself
_LIT = 0.05  # of the brightest, from which on a pixel is part of a silhouette
_BESIDE = 0.03  # of what is lit, that has to lie beside the body to say that it is elsewhere
_FLIPS = {"left to right": np.s_[:, ::-1], "upside down": np.s_[::-1, :], "by half a turn": np.s_[::-1, ::-1]}


def findings(problem: Problem, found: Fit, ranking: Ranking) -> list[str]:
    """Sentences, each with the path of what is probably wrong; none where photographs and predictions agree."""
    said = list(_disagreement(found))
    if not said:
        return list(_silhouettes(problem, found))
    said += _encoding(ranking)
    for number in range(len(problem.measured)) if len(said) == 1 else ():
        said += _of_photograph(problem, found, number)
    if len(said) == 1:
        said.append(
            "no single cause was found: check pose, units (mm), places of lights and cameras, eta, and whether the "
            "body is the same throughout, or else state --volume"
        )
    return said


def of_volume(found: VolumeFit) -> list[str]:
    """The same of a volume, which may take much that is wrong with photographs into its coefficients."""
    worst = float(found.chi_squared.max())
    if worst <= FAR:
        return []
    return [
        f"photographs and predictions disagree: chi^2 per square is {worst:.3g}, 1 is expected; the coefficients are "
        "not to be trusted. Check pose, units (mm), places of lights and cameras, and eta: without --volume more is "
        "said of what is wrong"
    ]


def _disagreement(found: Fit) -> Iterator[str]:
    worst = float(found.chi_squared.max())
    if not worst <= FAR:
        yield (
            f"photographs and predictions disagree: chi^2 per degree of freedom is {worst:.3g}, 1 is expected; "
            "the coefficients are not to be trusted"
        )


def _of_photograph(problem: Problem, found: Fit, number: int) -> list[str]:
    """What explains one photograph much better than what the capture says of it: its place, its axes or its lights."""
    if not np.nanmax(found.by_photograph[number]) > FAR:
        return []
    one = problem.measured[number]
    # By the first predictions: a fit to what is wrong may have left every shape behind.
    values, expected = _grey(one.values), _grey(problem.first[number].radiance)
    outline = _outline(problem, found, number)
    path = one.stated.path
    scores = {
        f"{path}.file: fits much better turned {name}: an axis of the picture or of the camera is flipped": _alike(
            values[turn], expected
        )
        for name, turn in _FLIPS.items()
    }
    for other, picture in zip(problem.measured, problem.first, strict=True):
        if other.stated.camera == one.stated.camera and other.stated.lights != one.stated.lights:
            names = " + ".join(other.stated.lights)
            sentence = f"{path}.lights: fits the picture of {names} much better than its own: lights are swapped"
            scores[sentence] = _alike(values, _grey(picture.radiance))
    if outline:
        scores[outline] = _alike(_centred(values), _centred(expected)) - _FREE
    best = max(scores, key=lambda sentence: scores[sentence])
    if scores[best] > _alike(values, expected) + _BETTER:
        return [best]
    return [outline] if outline else []


def _centred(picture: np.ndarray) -> np.ndarray:
    """A grey picture with the middle of what is lit in the middle."""
    lit = picture > _LIT * np.quantile(picture, 0.99)
    shift = np.array(picture.shape) / 2 - _middle(lit)
    return np.roll(picture, np.round(shift).astype(int), axis=(0, 1))


def _silhouettes(problem: Problem, found: Fit) -> Iterator[str]:
    """Outlines that do not match although the pixels within do."""
    for number in range(len(problem.measured)):
        outline = _outline(problem, found, number)
        if outline:
            yield outline


def _outline(problem: Problem, found: Fit, number: int) -> str:
    """What the lit part of a photograph says of body, pose and camera; nothing where it matches."""
    one, picture = problem.measured[number], found.pictures[number]
    seen = _grey(one.values)
    expected = _grey(picture.radiance)
    unmasked = one.usable.any(axis=2)
    photographed = (seen > _LIT * np.quantile(seen, 0.99)) & unmasked
    predicted = (expected > _LIT * np.quantile(expected, 0.99)) & unmasked
    body = ndimage.binary_dilation(picture.alpha > 0, np.ones((3, 3)))
    beside = (photographed & ~body).sum() / max(photographed.sum(), 1)
    if beside < _BESIDE:
        return ""
    shift = _middle(photographed) - _middle(predicted)
    size = np.sqrt(photographed.sum() / max(predicted.sum(), 1))
    return (
        f"{one.stated.path}.camera: {beside:.0%} of what is lit lies beside the body; what is lit is {shift[1]:+.0f} "
        f"pixels to the right of its prediction, {shift[0]:+.0f} down and {size:.2f} times as large: pose, camera, "
        "unit or mask is wrong"
    )


def _middle(part: np.ndarray) -> np.ndarray:
    return np.argwhere(part).mean(axis=0) if part.any() else np.zeros(2)


def _encoding(ranking: Ranking) -> list[str]:
    """Whether values go with a power of the predictions, as those do that are encoded for displays."""
    linear, encoded = ranking.spreads
    if encoded > _LESS * linear:
        return []
    return [
        f"photographs: values go with the power {ENCODED:.2f} of what is predicted: they are probably encoded for "
        "displays (sRGB); develop them linearly"
    ]


def _alike(one: np.ndarray, other: np.ndarray) -> float:
    """Correlation of two grey pictures in the square root, which weighs dim parts up."""
    x, y = np.sqrt(np.maximum(one, 0)).ravel(), np.sqrt(np.maximum(other, 0)).ravel()
    if x.std() == 0 or y.std() == 0:
        return 0.0
    return float(np.corrcoef(x, y)[0, 1])


def _grey(picture: np.ndarray) -> np.ndarray:
    return picture.mean(axis=2)
