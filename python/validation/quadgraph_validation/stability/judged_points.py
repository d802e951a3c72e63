"""One point of the suite: a body, a medium and a light, solved by one method and held against the truth."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass, field
from typing import Any

import numpy as np

from quadgraph.baking.budget import surface_errors
from quadgraph.base.errors import QuadGraphError
from quadgraph.base.relative_error import relative_rms
from quadgraph_validation.bodies import meshes
from quadgraph_validation.stability.error_classes import REFUSED, Errors, classify
from quadgraph_validation.stability.fine_truths import TruthOf
from quadgraph_validation.stability.scaled_chains import Irradiance, Medium, ScaledChain, Shape
from quadgraph_validation.stability.stability_methods import StabilityMethod
from quadgraph_validation.truth.schemes import Scheme

DARK = 1e-4  # of the whole's exitance (RMS): an unlit part below it is black in any picture, and not judged


@dataclass(frozen=True, eq=False)
class StabilityCase:
    """A scene and its truth.

    shape: that the body takes, None: it is at rest; regions: from the chain to labels (n,) of the finest level's faces,
    whose means are compared, None: every face is; options: of the solve, beside method, source, model and solver.
    """

    chain: ScaledChain
    medium: Medium
    q: Irradiance
    direction: tuple[float, float, float] | None
    eta: float
    truth: TruthOf
    shape: Shape | None = None
    regions: Callable[[ScaledChain], np.ndarray] | None = None
    options: Mapping[str, Any] = field(default_factory=dict)


def judge(case: StabilityCase, method: StabilityMethod) -> dict[str, Any]:
    """Class, errors, estimate and words of a point, as the record has them."""
    try:
        report = solve(case, method)
    except QuadGraphError as error:
        return refusal(error)
    truth = case.truth(Scheme(method.scheme.method, method.scheme.source, report["model"]))
    true, expected = errors(case, case.chain.exitance, truth.exitance), estimate(report["error"])
    return point(classify(true, expected, words(report)), true, expected, report) | {"noise": truth.noise}


def solve(case: StabilityCase, method: StabilityMethod) -> dict[str, Any]:
    """The engine's report. Raises as it does."""
    if case.shape is not None:
        case.chain.take(case.shape)
    scheme = method.scheme
    names = {"method": scheme.method, "source": scheme.source, "model": scheme.model, "solver": method.solver}
    return case.chain.solve(case.medium, case.q, case.direction, case.eta, **names, **case.options)


def refusal(error: QuadGraphError) -> dict[str, Any]:
    """The point of a solve that was refused."""
    return {"class": REFUSED, "said": [str(error)]}


def point(name: str, true: Errors, expected: Errors | None, report: dict[str, Any]) -> dict[str, Any]:
    """What the record keeps of a solve of class `name`."""
    return {
        "class": name,
        "true": asdict(true),
        "estimate": None if expected is None else asdict(expected),
        "said": words(report),
        "model": report["model"],
        "replaced": report["replaced"],
    }


def estimate(part: dict[str, float] | None) -> Errors | None:
    """An estimate of a report, which has 0 for an unlit part that there is not."""
    return None if part is None else Errors(part["whole"], part["unlit"] or None)


def errors(case: StabilityCase, found: np.ndarray, truth: np.ndarray) -> Errors:
    """Relative RMS errors of exitances (n,) per outside face of the finest level."""
    if not np.isfinite(truth).all():
        raise ValueError("the truth is not finite")
    centre, normal, _ = meshes.face_frames(case.chain.graphs[0])
    area = case.chain.area
    unlit = surface_errors.weights(area, case.q(centre, normal)[:, None]).get("unlit")
    if case.regions is not None:
        labels = np.unique(case.regions(case.chain), return_inverse=True)[1]
        found, truth = (_means(values, area, labels) for values in (found, truth))
    difference = found - truth
    whole = _relative(area, difference, truth)
    if unlit is None or _rms(unlit, truth) <= DARK * _rms(area, truth):
        return Errors(whole)
    return Errors(whole, _relative(unlit, difference, truth))


def words(report: dict[str, Any]) -> list[str]:
    """What a report says against its own solution of the model's equations."""
    return report["unmet"] + ([report["mesh_warning"]] if report["mesh_warning"] else [])


def _means(values: np.ndarray, weight: np.ndarray, labels: np.ndarray) -> np.ndarray:
    """Each value replaced by the mean of its label."""
    whole = np.maximum(np.bincount(labels, weight), 1e-300)
    return (np.bincount(labels, weight * values) / whole)[labels]


def _rms(weight: np.ndarray, values: np.ndarray) -> float:
    return float(np.sqrt(weight @ values**2 / weight.sum()))


def _relative(weight: np.ndarray, difference: np.ndarray, truth: np.ndarray) -> float:
    return relative_rms(weight, difference[:, None], truth[:, None]) if _rms(weight, truth) > 0 else 0.0
