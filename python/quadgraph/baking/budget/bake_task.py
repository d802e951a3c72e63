"""A bake as a task: plain arguments in, the report out."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from quadgraph.baking.budget.plan import bake_for
from quadgraph.baking.pipeline import BakeOptions, bake

FUNCTION = f"{__name__}:baked"


@dataclass(frozen=True)
class ErrorAsked:
    """error: relative, that a bake is to keep; material, lights: that it is for; device: that measures it."""

    error: float
    material: str
    lights: Sequence[str]
    device: str


def baked(mesh: str, output: str, options: Mapping[str, Any], asked: Mapping[str, Any] | None) -> dict[str, Any]:
    """Bake a mesh into a file, and report. options: members of BakeOptions; asked: of ErrorAsked, None: no error."""
    how = BakeOptions(**{**options, "for_materials": tuple(options["for_materials"])})
    if asked is None:
        return bake(Path(mesh), Path(output), how, _say_nothing).as_dict()
    wanted = ErrorAsked(**asked)
    error = (wanted.error, wanted.material, wanted.lights, wanted.device)
    return bake_for(Path(mesh), Path(output), how, *error, _say_nothing).as_dict()


def _say_nothing(text: str) -> None:
    """Nobody reads along where a task runs."""
