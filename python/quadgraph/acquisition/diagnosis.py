"""What is most probably wrong with photographs that no coefficients explain."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from quadgraph.acquisition.fitting import Fit
from quadgraph.acquisition.problem import Problem

FAR = 4.0  # chi^2 per degree of freedom, from which on photographs and predictions disagree
_ENCODED = (0.3, 0.65)  # exponent of values against predictions where they are encoded for displays: 1 / 2.2
_BETTER = 0.15  # of correlation, by which another assumption has to win
_LIT = 0.05  # of the brightest, from which on a pixel is part of a silhouette
_OVERLAP = 0.8  # of two silhouettes, their intersection over their union
_FLIPS = {"left to right": np.s_[:, ::-1], "upside down": np.s_[::-1, :], "by half a turn": np.s_[::-1, ::-1]}


def findings(problem: Problem, found: Fit) -> list[str]:
    """Sentences, each with the path of what is probably wrong; none where photographs and predictions agree."""
    said = list(_disagreement(found))
    if not said:
        return list(_silhouettes(problem, found)) or said
    for number in range(len(problem.measured)):
        said += _of_photograph(problem, found, number)
    said += _encoding(problem, found)
    if len(said) == 1:
        said.append(
            "no single cause was found: check pose, units (mm), places of lights and cameras, eta, and whether the "
            "body is the same throughout (only homogeneous bodies are recovered)"
        )
    return said


def _disagreement(found: Fit) -> Iterator[str]:
    worst = float(found.chi_squared.max())
    if not worst <= FAR:
        yield (
            f"photographs and predictions disagree: chi^2 per degree of freedom is {worst:.3g}, 1 is expected; "
            "the coefficients are not to be trusted"
        )


def _of_photograph(problem: Problem, found: Fit, number: int) -> list[str]:
    """Findings on one photograph: its outline, its axes, and its lights."""
    if not np.nanmax(found.by_photograph[number]) > FAR:
        return []
    path = problem.measured[number].stated.path
    outline = _outline(problem, found, number)
    turned = _turned(problem, found, number)
    if turned:
        return [f"{path}.file: fits much better turned {turned}: an axis of the picture or of the camera is flipped"]
    other = _other_lights(problem, found, number)
    if other:
        names = " + ".join(other)
        return [f"{path}.lights: fits the picture of {names} much better than that of the stated: lights are swapped"]
    return [outline] if outline else []


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
    union = (photographed | predicted).sum()
    overlap = (photographed & predicted).sum() / union if union else 1.0
    if overlap >= _OVERLAP:
        return ""
    shift = _middle(photographed) - _middle(predicted)
    size = np.sqrt(photographed.sum() / max(predicted.sum(), 1))
    return (
        f"{one.stated.path}.camera: what is lit overlaps with the prediction by {overlap:.0%}; the photograph's is "
        f"{shift[1]:+.0f} pixels to the right, {shift[0]:+.0f} down and {size:.2f} times as large: pose, camera, "
        "unit or mask is wrong"
    )


def _middle(part: np.ndarray) -> np.ndarray:
    return np.argwhere(part).mean(axis=0) if part.any() else np.zeros(2)


def _turned(problem: Problem, found: Fit, number: int) -> str:
    """How a photograph is turned, if it matches its prediction much better then."""
    values, expected = _grey(problem.measured[number].values), _grey(found.pictures[number].radiance)
    straight = _alike(values, expected)
    scores = {name: _alike(values[turn], expected) for name, turn in _FLIPS.items()}
    best = max(scores, key=lambda name: scores[name])
    return best if scores[best] > straight + _BETTER else ""


def _other_lights(problem: Problem, found: Fit, number: int) -> tuple[str, ...]:
    """Lights of another photograph by the same camera, whose prediction this one matches much better."""
    one = problem.measured[number]
    values = _grey(one.values)
    stated = _alike(values, _grey(found.pictures[number].radiance))
    best = stated + _BETTER
    lights: tuple[str, ...] = ()
    for other, picture in zip(problem.measured, found.pictures, strict=True):
        if other.stated.camera == one.stated.camera and other.stated.lights != one.stated.lights:
            score = _alike(values, _grey(picture.radiance))
            if score > best:
                best, lights = score, other.stated.lights
    return lights


def _encoding(problem: Problem, found: Fit) -> list[str]:
    """Whether values go with a power of the predictions, as those do that are encoded for displays."""
    exponents = []
    for number, one in enumerate(problem.measured):
        counted = problem.counted[number]
        value, expected = one.values[counted], found.pictures[number].radiance[counted]
        lit = (value > 0.02 * value.max()) & (expected > 0)
        if lit.sum() > 16:
            x, y = np.log(expected[lit]), np.log(value[lit])
            exponents.append(np.std(y) / max(np.std(x), 1e-9) * np.sign(np.corrcoef(x, y)[0, 1]))
    middle = float(np.median(exponents)) if exponents else 1.0
    if not _ENCODED[0] < middle < _ENCODED[1]:
        return []
    return [
        f"photographs: values go with the power {middle:.2f} of what is predicted: they are probably encoded for "
        "displays (sRGB, a power of about 0.45); develop them linearly"
    ]


def _alike(one: np.ndarray, other: np.ndarray) -> float:
    """Correlation of two grey pictures in the square root, which weighs dim parts up."""
    x, y = np.sqrt(np.maximum(one, 0)).ravel(), np.sqrt(np.maximum(other, 0)).ravel()
    if x.std() == 0 or y.std() == 0:
        return 0.0
    return float(np.corrcoef(x, y)[0, 1])


def _grey(picture: np.ndarray) -> np.ndarray:
    return picture.mean(axis=2)
