"""Maps of the arithmetic: where iterations end, and what rounding the entries of the operator changes.

Truth is the same mesh's solution in double precision, of entries that are not rounded.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, replace
from functools import cache
from typing import Any

import numpy as np

from quadgraph.base.errors import QuadGraphError
from quadgraph_validation.stability import deformed_shapes
from quadgraph_validation.stability.error_classes import FACTOR, Errors, classify
from quadgraph_validation.stability.fine_truths import Truth
from quadgraph_validation.stability.judged_points import Case, errors, estimate, point, refusal, solve, words
from quadgraph_validation.stability.scaled_chains import Chain, Fine, Medium, even
from quadgraph_validation.stability.solids import ETA, JUMPS, SLANTED, ball, pillar, slanted_light
from quadgraph_validation.stability.stability_maps import Axis, CaseOf, Map, Setting
from quadgraph_validation.stability.stability_methods import MODELS, SOLVERS, Method
from quadgraph_validation.truth.schemes import Scheme

# What packed entries and single precision may change of the exitance unsaid (docs/layouts.md).
ROUNDING = 1e-4
TOLERANCES = (1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6)


# Scenes of the map of tolerances.
_SCENES = ("even", "pillar, kappa 1e4", "thin: 30 mean free paths", "needles 1:100", "slivers of 0.1 degrees")


def judge_iterations(case: Case, method: Method) -> dict[str, Any]:
    """The algebraic error alone, against its own estimate."""
    try:
        report = solve(case, method)
    except QuadGraphError as error:
        return refusal(error)
    truth = case.truth(Scheme(method.scheme.method, method.scheme.source, report["model"]))
    true, expected = errors(case, case.chain.exitance, truth.exitance), estimate(report["algebraic"])
    return point(classify(true, expected, words(report), small=ROUNDING), true, expected, report)


def judge_rounding(case: Case, method: Method) -> dict[str, Any]:
    """What rounded entries change, in double precision on the CPU, against the bound that is stated of it."""
    fine = Fine(case.chain.graphs[0], 0)
    exact, stored = (_on_cpu(fine, case.medium, method.scheme.model, rounded) for rounded in (False, True))
    change, bound = errors(case, stored, exact), Errors(ROUNDING / FACTOR)
    name = classify(change, bound, small=ROUNDING)
    return {"class": name, "true": asdict(change), "estimate": asdict(bound), "said": [], "entries": fine.entries}


def _on_cpu(fine: Fine, medium: Medium, model: str, rounded: bool) -> np.ndarray:
    return fine.exitance([medium], slanted_light, SLANTED, ETA, "buried", model, stored=rounded)[:, 0]


def _case(chain: Chain, medium: Medium, **options: Any) -> Case:
    fine = Fine(chain.rest[0], 0)

    @cache
    def exitance(model: str) -> np.ndarray:
        return _on_cpu(fine, medium, model, False)

    return Case(
        chain, medium, slanted_light, SLANTED, ETA, lambda scheme: Truth(exitance(scheme.model)), options=options
    )


def _by_tolerance(setting: Setting, tolerances: Sequence[float], scenes: Sequence[float]) -> CaseOf:
    round_body, device = ball(setting.device), setting.device
    made = {
        0: lambda: (round_body, even(0.95, 0.05)),
        1: lambda: (round_body, pillar(1e4, 1.0)),
        2: lambda: (round_body, even(0.03, 0.003)),
        3: lambda: (Chain(lambda: deformed_shapes.rod(100), device), even(0.95, 0.05)),
        4: lambda: (
            Chain(lambda: deformed_shapes.with_slivers(deformed_shapes.block(), 0.1), device),
            even(0.95, 0.05),
        ),
    }

    @cache
    def case(scene: float) -> Case:
        return _case(*made[int(scene)]())

    return lambda tolerance, scene: replace(case(scene), options={"tolerance": tolerance, "max_iterations": 2000})


def _by_format(setting: Setting, angles: Sequence[float], kappa_jumps: Sequence[float]) -> CaseOf:
    @cache
    def chain(angle: float) -> Chain:
        return Chain(lambda: deformed_shapes.with_slivers(deformed_shapes.block(), angle), setting.device)

    return lambda angle, jump: _case(chain(angle), pillar(jump, 1.0))


MAPS = (
    Map(
        "tolerance",
        "where iterations end, fem with every solver",
        "the same mesh in double precision",
        Axis("tolerance", "tolerance", TOLERANCES),
        Axis("scene", "scene", tuple(range(len(_SCENES))), _SCENES),
        _by_tolerance,
        SOLVERS,
        judge_iterations,
    ),
    Map(
        "entries",
        "what rounding the entries to 12 or 13 bits changes, cube with slivers inside and a pillar",
        "entries in double precision",
        Axis("dihedral", "smallest dihedral angle, degrees", (18, 10, 3, 1, 0.3, 0.1, 0.01)),
        Axis("fp16", "kappa around the pillar / kappa in it", JUMPS),
        _by_format,
        MODELS,
        judge_rounding,
    ),
)
