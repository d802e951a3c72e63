"""What a method is to the chart, and the registry that others plug into."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Protocol, runtime_checkable

import numpy as np

from quadgraph.base.errors import InputError
from quadgraph_validation.bodies.scene_bakes import Choice

if TYPE_CHECKING:
    from quadgraph_validation.chart.chart_body import ChartBody

SWING = (2, 1, 0)  # steps of the light: a method is settled at the first, frames follow it to the scene's own, step 0
CHAIN = "chain"  # `bake` of the chain that the PDE truth knows
POLYGRID = "polygrid"  # `bake` of a polygrid of the body
SETTLED = 1e-3  # algebraic error of the exitance to which solvers iterate, unless a number of cycles is given


def bake_settings(choice: Choice | None) -> dict[str, Any]:
    """What a method's settings say of how its body is baked; None: the chain that the PDE truth knows."""
    if choice is None:
        return {"bake": CHAIN, "K": None}
    if choice.cells is not None:
        return {"bake": POLYGRID, "K": None}
    return {"bake": "default" if choice.grading is None else "K", "K": choice.grading}


def pde_of(settings: Mapping[str, Any]) -> tuple[str, str] | None:
    """Model and source of the PDE whose truth can judge a method of these settings, None where there is none.

    A PDE truth knows no inter-reflection, no transport correction, and no surface but its own chain's.
    """
    if settings["inter_reflection"] or settings.get("sweeps") or settings["bake"] != CHAIN:
        return None
    return settings["model"], settings["source"]


def walks_judge(settings: Mapping[str, Any]) -> bool:
    """Whether random walks through the surface of the default bake can judge the exitance of a method: one on that
    surface, which follows light that left and enters again. A picture that is the mean of several solves has none.
    """
    return settings["bake"] == "default" and settings["inter_reflection"] and not settings.get("converge")


class ChartMethod(Protocol):
    """One way to answer a scene; one point of the chart.

    family: what it is a setting of, for colour and filter; settings: everything it depends on, ready for JSON, of which
    `model` and `source` name the PDE that it solves, `level` the level whose surface it answers on, `bake` of which
    chain, with `K` if it is the paper's, `inter_reflection` whether it computes inter-reflection, `radiance` how it
    leaves the surface, None of what makes no pictures, `runs_on` what its times are of, and `sweeps`, where there are
    any, how many of the transport equation correct it.
    """

    @property
    def name(self) -> str: ...

    @property
    def family(self) -> str: ...

    @property
    def settings(self) -> dict[str, Any]: ...

    def prepare(self, body: ChartBody) -> None:
        """Settle at the light of SWING[0]: whatever a running program would have done before. Not timed.

        Raises SolverError where the method cannot answer this body.
        """

    def frame(self, step: int) -> dict[str, float]:
        """Move the light to a step and do all that a live frame does, a picture included; ms by pass."""

    def exitance(self) -> np.ndarray:
        """Exitance of scattered light after the last frame per face of the level, (n_f, 3) W/mm^2; asked of those alone
        that a PDE truth or random walks can judge.
        """

    def picture(self, view: str) -> np.ndarray:
        """Radiance of light that was in the body, (PIXELS, PIXELS, 3) W/(mm^2 sr), after the last frame."""


@runtime_checkable
class ClockedMethod(ChartMethod, Protocol):
    """One whose frames are timed by the clock on the wall, which other programs slow down, and by the processor."""

    @property
    def processor_seconds(self) -> float:
        """That the last frame took of the processor, over all threads."""


@runtime_checkable
class StatingMethod(ChartMethod, Protocol):
    """One that says how far off its own pictures are."""

    def stated(self) -> dict[str, Any]:
        """Of all views that were shown since `prepare`, ready for JSON. whole: relative RMS error that it states of the
        pictures together; views: by name what else it says of each.
        """


@runtime_checkable
class MovingMethod(ChartMethod, Protocol):
    """One whose frames can be judged while camera and light move; steps of both, of MOTION_DEGREES, are counted down to
    0, where they have arrived. Pictures are as of `picture`.
    """

    @property
    def moves(self) -> bool:
        """Whether these settings are judged so."""

    @property
    def noisy(self) -> bool:
        """Whether pictures at rest are made by random numbers."""

    def begin(self, body: ChartBody, step: float) -> None:
        """Be where a program is that has drawn frames for a while, the last of them at that step."""

    def moving(self, step: float) -> np.ndarray:
        """Draw one more frame, with light and camera at a step."""

    def at_rest(self, light: float, views: Sequence[float], seed: int) -> list[np.ndarray]:
        """What it shows once nothing changes any more, with the light at one step, from the camera at each of some;
        another seed draws other random numbers, where there are any.
        """


@dataclass
class PreparedMethod:
    """What methods have in common that keep the body they were prepared for."""

    _given: ChartBody | None = field(default=None, repr=False, kw_only=True)

    @property
    def _body(self) -> ChartBody:
        assert self._given is not None, "`prepare` comes before all that needs a body"
        return self._given


@dataclass(frozen=True)
class MethodChain:
    """What default methods are chosen by: faces of each level, finest first, and the level whose faces know what they
    see of each other, None if there is none; others: further ways in which the body is baked; original: whether the
    scene's own mesh is there to be traced.
    """

    faces: tuple[int, ...]
    seen: int | None
    others: tuple[Choice, ...] = ()
    original: bool = False


Provider = Callable[[MethodChain], Iterable[ChartMethod]]
_PROVIDERS: list[Provider] = []


def register(provider: Provider) -> Provider:
    """Add a function that makes the methods for a chain; what it makes is in every chart from then on."""
    _PROVIDERS.append(provider)
    return provider


def methods(chain: MethodChain, wanted: Iterable[str] = ()) -> list[ChartMethod]:
    """All registered methods for a chain; with `wanted`, those whose names have any of these texts in them.

    Raises InputError for a text that no name has.
    """
    known = [method for provider in _PROVIDERS for method in provider(chain)]
    for text in wanted:
        if not any(text in method.name for method in known):
            raise InputError(f"method '{text}': in no name; they are {'; '.join(method.name for method in known)}")
    return [method for method in known if not wanted or any(text in method.name for text in wanted)]
