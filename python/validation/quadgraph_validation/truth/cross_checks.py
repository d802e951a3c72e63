"""Transport by several programs that share nothing: the same quantities beside each other, with standard errors."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from rich.console import Console

from quadgraph.base.errors import InputError
from quadgraph_validation.bodies import meshes, scene_meshes
from quadgraph_validation.bodies.media import media
from quadgraph_validation.bodies.scenes import SCENES
from quadgraph_validation.truth import monte_carlo, pmmc_walk, truth_run, walk_truth
from quadgraph_validation.truth.monte_carlo import Estimate
from quadgraph_validation.truth.slab_transport import discrete_ordinates

BODIES = ("sphere", "slab")
THICKNESS = 5.0  # mm
# Medium, channel and index of the slabs: pale, weak and dark, with and without reflection inside.
SLABS = (("marble", 0, 1.0), ("marble", 0, 1.3), ("skin1", 2, 1.0), ("ketchup", 0, 1.3))
_SEED = 5
_BEAMS = 32
_CUTS = 1  # of the ball's tets


@dataclass(frozen=True)
class CheckRow:
    """One quantity: ours, by random walks, and by whom else it is known, with a standard error of 0 where exact."""

    quantity: str
    ours: tuple[float, float]
    others: dict[str, tuple[float, float]]

    def deviations(self) -> dict[str, float]:
        """By name, (other - ours) over the standard error of the difference."""
        return {
            name: (mean - self.ours[0]) / float(np.hypot(error, self.ours[1]))
            for name, (mean, error) in self.others.items()
        }


def rows(
    chosen: Sequence[str], walks: int, folder: Path, pictures: Path, pmmc: bool, console: Console
) -> list[CheckRow]:
    """Those of BODIES that are chosen. pmmc: whether to ask it; the rest as `sphere` takes it."""
    found = []
    if "sphere" in chosen:
        found += sphere(walks, folder, pictures, console, sphere_by_pmmc(walks) if pmmc else None)
    if "slab" in chosen:
        found += [row for one in SLABS for row in slab(*one, *slab_walks(*one, walks, pmmc))]
    return found


def slab_walks(name: str, channel: int, eta: float, walks: int, pmmc: bool) -> list[Estimate]:
    """Reflected and transmitted by one of SLABS in collimated light: by our walks and, if asked for, pmmc's.

    Raises InputError as `pmmc_walk.load` does.
    """
    medium = media(name)[channel]
    ours = monte_carlo.slab(medium, THICKNESS, eta, False, walks, _SEED)
    return [ours, *([pmmc_walk.slab(medium, THICKNESS, eta, walks, _SEED)] if pmmc else [])]


def slab(name: str, channel: int, eta: float, ours: Estimate, theirs: Estimate | None = None) -> list[CheckRow]:
    """What `slab_walks` found, beside discrete ordinates."""
    exact = discrete_ordinates(media(name)[channel], THICKNESS, eta, False)
    rows = []
    for k, field in enumerate(("reflectance", "transmittance")):
        others = {"discrete ordinates": (getattr(exact, field), 0.0)}
        others |= {"pmmc": _at(theirs, k)} if theirs else {}
        rows.append(CheckRow(f"{title_of(name, channel, eta)}: {field}", _at(ours, k), others))
    return rows


def title_of(name: str, channel: int, eta: float) -> str:
    """One of SLABS in words."""
    return f"slab, {name} {'RGB'[channel]}, eta {eta:g}"


def sphere_by_pmmc(walks: int) -> Estimate:
    """The exitance of the scene `sphere` by zones. Raises InputError as `pmmc_walk.load` does."""
    scene = SCENES["sphere"]
    radius, medium = walk_truth.radius_of(scene), walk_truth.medium_of(scene)
    given = (scene.eta, walk_truth.ZONES, _BEAMS, walks, _SEED)
    return pmmc_walk.sphere(meshes.ball(radius, _CUTS), medium, *given)


def sphere(
    walks: int, folder: Path, pictures: Path, console: Console, theirs: Estimate | None = None
) -> list[CheckRow]:
    """The scene `sphere`: what leaves either half, beside pmmc, and what reaches the eyes, beside path tracing.

    folder: of our walks, which are gone on with; pictures: of the path-traced ones; theirs: the exitance of its zones
    by pmmc, if that was asked. Raises InputError if either is stale or a picture is not there.
    """
    scene, zones = SCENES["sphere"], walk_truth.ZONES
    found = walk_truth.make(scene, walks, folder, console)
    halves = {"dark half": slice(0, zones // 2), "lit half": slice(zones // 2, zones)}
    rows = [
        CheckRow(
            f"sphere: exitance of the {name}",
            _mean(found.exitance, part),
            {"pmmc": _mean(theirs, part)} if theirs else {},
        )
        for name, part in halves.items()
    ]
    subject = truth_run.subject(scene, scene_meshes.file(scene, Path()))
    for k, view in enumerate(scene.views):
        picture = walk_truth.seen(truth_run.stored(subject, pictures, view))
        seen = float(picture.mean), float(picture.error)
        rows.append(CheckRow(f"sphere: irradiance at eye {view}", _at(found.at_eyes, k), {"path tracing": seen}))
    return rows


def why_no_pmmc() -> str:
    """Why pmmc cannot be asked; empty if it can."""
    try:
        pmmc_walk.load()
    except InputError as error:
        return str(error)
    return ""


def _at(estimate: Estimate, index: int) -> tuple[float, float]:
    return float(estimate.mean[index]), float(estimate.error[index])


def _mean(estimate: Estimate, part: slice) -> tuple[float, float]:
    """Mean and standard error over zones of equal area."""
    errors = estimate.error[part]
    return float(estimate.mean[part].mean()), float(np.sqrt((errors**2).sum()) / len(errors))
