"""Random walks through an unseen case."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from quadgraph_validation.bodies.unseen_cases import UnseenCase
from quadgraph_validation.truth import kept_walks
from quadgraph_validation.truth.kept_walks import KeptWalks, WalkTask

_SEED = 17


def make(case: UnseenCase, walks: int, folder: Path, tell: Callable[[int], None]) -> KeptWalks:
    """As `kept_walks.make` has it, of a case."""
    return kept_walks.make(_task(case), walks, folder, tell)


def stored(case: UnseenCase, folder: Path) -> KeptWalks:
    """The walks of a case that there are. Raises InputError if they cannot be read."""
    return kept_walks.stored(_task(case), folder)


def _task(case: UnseenCase) -> WalkTask:
    told = {"seed": case.seed, "light": case.light.text}
    body = (case.surface, case.medium, case.light)
    return WalkTask(f"unseen-{case.seed}", told, *body, _SEED, case.inter_reflection)
