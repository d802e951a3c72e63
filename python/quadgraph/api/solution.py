"""What a solve did: its way, its error, and where the power went."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import Any, Self

import numpy as np

from quadgraph.api.reprs import channels, farthest, share
from quadgraph.api.solution_table import summary, table
from quadgraph.api.values import Doubles


@dataclass(frozen=True, eq=False, repr=False)
class Energy:
    """Power per channel, W, (3,) float64 each: what enters goes out again or is absorbed, by a conservative method.

    entered: of the lights; re_entered: of light that had left another part; scattered_out, absorbed, unscattered_out;
    balance: what is missing of that, as a share of what entered.
    """

    entered: Doubles
    re_entered: Doubles
    scattered_out: Doubles
    absorbed: Doubles
    unscattered_out: Doubles
    balance: Doubles

    @classmethod
    def from_report(cls, report: Mapping[str, Any]) -> Self:
        """Return it from the compiled engine's report."""
        return cls(**{name: np.array(power) for name, power in report.items()})

    def __repr__(self) -> str:
        """Return the powers in one line, and the balance in per cent."""
        names = ("entered", "re_entered", "scattered_out", "absorbed", "unscattered_out")
        powers = ", ".join(f"{name}={channels(getattr(self, name), 'W')}" for name in names)
        return f"Energy({powers}, balance={share(farthest(self.balance))})"


@dataclass(frozen=True)
class LevelReport:
    """One level's solve. level: 0 is the finest; unknowns: per channel; residual: relative, of the worst channel."""

    level: int
    unknowns: int
    iterations: int
    residual: float
    converged: bool


@dataclass(frozen=True, repr=False)
class ErrorEstimate:
    """Relative RMS error of the exitance, weighted by area: over the whole surface, over its unlit part, and over the
    third of it with the least exitance. A part is 0 where there is none or where it cannot be told.
    """

    whole: float
    unlit: float
    dimmest: float

    def __repr__(self) -> str:
        """Return its parts in per cent."""
        return f"ErrorEstimate(whole={share(self.whole)}, unlit={share(self.unlit)}, dimmest={share(self.dimmest)})"


@dataclass(frozen=True)
class CorrectedSweep:
    """What one sweep of the transport correction did to the exitance. change: against what it was before, without the
    noise of the sampling; noise: that in what it is now; points: at which the transport equation was evaluated.
    """

    change: ErrorEstimate
    noise: ErrorEstimate
    points: float


@dataclass(frozen=True)
class Correction:
    """What the transport correction did. sweeps: in their order; segments: tets that rays back from its points and from
    faces crossed.
    """

    sweeps: tuple[CorrectedSweep, ...]
    segments: float

    @classmethod
    def from_report(cls, report: Mapping[str, Any]) -> Self:
        """Return it from the compiled engine's report."""
        sweeps = [
            CorrectedSweep(ErrorEstimate(**sweep["change"]), ErrorEstimate(**sweep["noise"]), sweep["points"])
            for sweep in report["sweeps"]
        ]
        return cls(tuple(sweeps), report["segments"])


@dataclass(frozen=True)
class CertifiedPart:
    """What random walks measured of a part of the surface. power: of the exitance, how much more it is than that of the
    walks, relative; error: relative RMS over patches as of `ErrorEstimate`, without the noise of the walks; each with
    its standard error, power_noise and error_noise. All 0 where there is no such part, or too few walks came there.
    """

    power: float
    power_noise: float
    error: float
    error_noise: float


@dataclass(frozen=True)
class Certificate:
    """What random walks through the tets, which share nothing with the solver but these and their coefficients,
    measured of the exitance (docs/physics.md, "Certificate"). whole, unlit, dimmest: parts of the surface; walks: of
    one channel each; segments: tets that they crossed; given_up: share of the light in walks that were not followed to
    their end; seconds: that it took; guided: whether importance led them; disagreement: where the stated error is less
    than what was measured, in words, or "".
    """

    whole: CertifiedPart
    unlit: CertifiedPart
    dimmest: CertifiedPart
    walks: float
    segments: float
    given_up: float
    seconds: float
    guided: bool
    disagreement: str

    @classmethod
    def from_report(cls, report: Mapping[str, Any]) -> Self:
        """Return it from the compiled engine's report."""
        parts = {part: CertifiedPart(**report[part]) for part in ("whole", "unlit", "dimmest")}
        return cls(**(dict(report) | parts))


@dataclass(frozen=True)
class PathReport:
    """What shortest-path did. size: voxels along x, y, z; cell: mm, side of one; solid: voxels in the body; lit: of
    them, those that light enters; rounds: until no path had anything to gain.
    """

    cost: str
    solver: str
    cells: int
    size: tuple[int, int, int]
    cell: float
    solid: int
    lit: int
    rounds: int


@dataclass(frozen=True, eq=False, repr=False)
class Solution:
    """What a solve did.

    method, solver, source, model: those that were used; replaced: why it is another solver than the one asked for;
    cycles: that were asked for, 0 if none; levels: in the order solved, coarsest first; finest: the level solved last;
    work: products of all levels, in products of level 0; clipped: (3,) share of the exitance that was below zero and
    taken from the rest; error: estimate of the whole error, with algebraic, the solver's part, mesh_error, the mesh's,
    after a correction at rest with what a material costs that changes within tets, and model_error, the model's, of
    each what a correction leaves, light_error, that of shadows and of the sampling of lights and skies, after a
    correction at rest, and None where it cannot be told; phase_error, what scattering by angle changes besides, of a
    material that says its g; advice: of an error above 5%, where it comes from and what to do; inter_reflection:
    whether it was followed; bounces: (n, 3) W that each brought in; unmet: what was asked for and is not met, in words;
    missed: of that, the error; stopped: of that, how the solve did not converge; budget: what the bake of the file has
    to say of the error that was asked for; mesh_warning, model_warning, size_warning, phase_warning, index_warning,
    light_warning, deformed: what else is to be said against the answer; exchange_age: solves by which what some face
    sees is behind the shape; correction: what sweeps did, None without; certificate: what random walks measured, None
    without `certify`; carried: of a frame that carries a correction on as a factor the share of light and material that
    is as it was, else None; path: of the method shortest-path, which has no levels, energy balance and estimates. Texts
    are empty where there is nothing to say.
    """

    method: str
    solver: str
    source: str
    model: str
    replaced: str
    cycles: int
    levels: tuple[LevelReport, ...]
    finest: int
    work: float
    energy: Energy
    clipped: Doubles
    algebraic: ErrorEstimate | None
    mesh_error: ErrorEstimate | None
    model_error: ErrorEstimate | None
    carried: float | None
    light_error: ErrorEstimate | None
    phase_error: ErrorEstimate | None
    error: ErrorEstimate | None
    advice: str
    inter_reflection: bool
    bounces: Doubles
    unmet: tuple[str, ...]
    missed: str
    stopped: str
    budget: str
    mesh_warning: str
    model_warning: str
    size_warning: str
    phase_warning: str
    index_warning: str
    light_warning: str
    deformed: str
    exchange_age: int
    correction: Correction | None
    certificate: Certificate | None
    path: PathReport | None

    @classmethod
    def from_report(cls, report: Mapping[str, Any]) -> Self:
        """Return it from the compiled engine's report."""
        typed = {
            "levels": tuple(LevelReport(**level) for level in report["levels"]),
            "energy": Energy.from_report(report["energy"]),
            "clipped": np.array(report["clipped"]),
            "algebraic": report["algebraic"] and ErrorEstimate(**report["algebraic"]),
            "mesh_error": report["mesh_error"] and ErrorEstimate(**report["mesh_error"]),
            "model_error": report["model_error"] and ErrorEstimate(**report["model_error"]),
            "light_error": report["light_error"] and ErrorEstimate(**report["light_error"]),
            "phase_error": report["phase_error"] and ErrorEstimate(**report["phase_error"]),
            "error": report["error"] and ErrorEstimate(**report["error"]),
            "bounces": np.array(report["bounces"]).reshape(-1, 3),
            "unmet": tuple(report["unmet"]),
            "correction": report["correction"] and Correction.from_report(report["correction"]),
            "certificate": report["certificate"] and Certificate.from_report(report["certificate"]),
            "path": report["path"] and PathReport(**report["path"]),
        }
        return cls(**{each.name: typed.get(each.name, report[each.name]) for each in fields(cls)})

    @property
    def converged(self) -> bool:
        """Whether all that was asked for is met."""
        return not self.unmet

    def __repr__(self) -> str:
        """Return method, powers and error in one line."""
        return f"Solution({summary(self)})"

    def _repr_html_(self) -> str:
        """Show powers and errors in a notebook."""
        return table(self)
