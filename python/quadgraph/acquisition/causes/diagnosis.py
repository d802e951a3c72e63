"""What is most probably wrong with photographs that no coefficients explain.

Each suspect is something that the capture may say wrongly. What would be left of the disagreement if it were otherwise
is found from interpolated predictions (bank.py), for all of them, from the cheapest to the dearest, until one explains
it; those that explain about as much are said with it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import numpy as np

from quadgraph.acquisition.causes import camera_suspects, outlines, scene_suspects, suspects
from quadgraph.acquisition.causes.bank import Bank
from quadgraph.acquisition.causes.suspects import Suspect
from quadgraph.acquisition.homogeneous.fitting import Fit
from quadgraph.acquisition.model.prediction import Predictor
from quadgraph.acquisition.model.problem import Problem
from quadgraph.acquisition.volume.volume_fit import VolumeFit
from quadgraph.base.progress import ProgressCallback

FAR = 4.0  # chi^2 per degree of freedom, from which on photographs and predictions disagree
_MOST = 12  # photographs that are looked into, the worst
_ENOUGH = 3.0  # cost per value, below which no dearer suspects are looked into
_LEFT = 0.6  # of the cost, that a cause leaves at most of the photographs that it is about
_AS_GOOD = 1.3  # times the least cost, up to which another cause is as probable
_SAID = 3  # causes
_DOUBTFUL = 2.0  # chi^2 per pixel of a photograph's channel, from which on a cause is looked for
_SURE = 0.5  # of the cost, that a cause leaves at most to be said where photographs and predictions do not disagree
_BETTER = (
    "photographs and predictions agree, but much better if something of the capture is otherwise; the coefficients are "
    "not to be trusted"
)
_OUTER = ("blurred", "raised", "size", "moved")  # kinds that only outlines may show

_STAGES: tuple[Callable[[Bank], Iterator[Suspect]], ...] = (
    suspects.suspects,
    camera_suspects.of_cameras,
    scene_suspects.of_rooms,
    scene_suspects.of_lights,
    scene_suspects.of_places,
    scene_suspects.of_bodies,
    scene_suspects.of_poses,
)
_CHEAP = 2  # stages that are always gone through


@dataclass(frozen=True, eq=False)
class _Tried:
    """A suspect and its cost."""

    suspect: Suspect
    cost: float


def findings(problem: Problem, found: Fit, predictor: Predictor, tell: ProgressCallback) -> list[str]:
    """Sentences, each with the path of what is probably wrong; none where photographs and predictions agree.

    tell: is told when a cause is looked for, which takes as long as the fit and longer. Raises InputError, SolverError.
    """
    said = list(_disagreement(found))
    outline = list(outlines.silhouettes(problem, found.pictures))
    masks = list(outlines.masks(problem, found.pictures))
    doubtful = float(np.nanmax(found.by_photograph)) > _DOUBTFUL
    if masks or not (said or outline or doubtful):
        return said + masks
    tell("looking for what may be wrong with the capture")
    causes = _causes(_worst(problem, found, predictor), bool(said), bool(outline))
    if causes:
        return [*(said or [_BETTER]), *causes]
    if not said:
        return outline
    return [
        *said,
        *(outline or ["no single cause was found"]),
        "check pose, units (mm), places of lights and cameras, eta, and whether the body is the same throughout, or "
        "else state --volume",
    ]


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


def _worst(problem: Problem, found: Fit, predictor: Predictor) -> Bank:
    """Predictions of those photographs that fit worst, for any coefficients."""
    chi = np.nan_to_num(found.by_photograph, nan=np.inf).max(axis=1)
    chosen = np.sort(np.argsort(-chi, kind="stable")[:_MOST])
    if len(chosen) < len(chi):
        photographs = tuple(problem.measured[number].stated for number in chosen)
        capture = replace(problem.capture, photographs=photographs)
        measured, first = ([each[number] for number in chosen] for each in (problem.measured, problem.first))
        problem, predictor = Problem(capture, measured, first), predictor.of(capture)
    return Bank(problem, predictor, problem.first)


def _causes(bank: Bank, disagree: bool, outline: bool) -> list[str]:
    """The most probable causes, those that explain about as much as the best; none where none explains much.

    disagree: whether something is certainly wrong; outline: whether outlines do not match.
    """
    tried = [_Tried(Suspect("", {}, 1.0, ""), bank.cost({}))]
    before = tried[0].cost
    for number, stage in enumerate(_STAGES if disagree else _STAGES[:_CHEAP]):
        if number >= _CHEAP and min(each.cost for each in tried) < _ENOUGH:
            break
        tried += [_Tried(each, each.handicap * bank.cost(each.otherwise)) for each in stage(bank)]
    best: dict[str, _Tried] = {}
    for each in sorted(tried, key=lambda each: each.cost):
        best.setdefault(each.suspect.kind, each)
    most = _AS_GOOD * next(iter(best.values())).cost
    chosen = [
        each.suspect
        for each in best.values()
        if each.cost < most
        and _left(bank, each.suspect) < _LEFT
        and (disagree or (outline and each.suspect.kind in _OUTER) or each.cost < _SURE * before)
    ]
    sentences = [each.sentence(bank.factors(each.otherwise)) for each in chosen[:_SAID]]
    return [("or " if number else "probably ") + each for number, each in enumerate(sentences)]


def _left(bank: Bank, suspect: Suspect) -> float:
    """Which share of the cost a suspect leaves of the photographs that it is about."""
    about = sorted(suspect.otherwise)
    if not about:
        return 1.0
    return bank.cost(suspect.otherwise, about) / max(bank.cost({}, about), 1e-300)
